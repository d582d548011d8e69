"""Many cases in one job: what is imported is so once, and as many processes as cores do the cases.

A case belongs to a batch by its key alone, so one that is added touches one batch and moves no
other. Of a batch those cases are solved that have no right record: one that is whole and was solved
by the sources there are. Their meshes are made first, each once. Whatever happens to the process
that does a case, the others go on.

A curve whose model is not known before is a climb (workflow/run/climbs.py): one task, which solves
what it needs. The rungs that it has tried are records like others, which nobody asks for.

The log of a batch has a line when a case begins and one when it ends; workflow/run/progress.py
reads it while it grows.
"""

import hashlib
import json
import sys
import time
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from signal import Signals
from typing import Protocol

from geometry import attempt
from geometry.make import load, make
from geometry.seal import write_why_none
from solver import record, sources
from solver.case import Case, digest
from solver.freefem import Limits
from solver.job import Job, say
from solver.models import MODELS
from solver.record import Solution
from workflow.plan.plan import mesh_file
from workflow.plan.promise import Promise
from workflow.run import climbs, damage, made, pool
from workflow.run.pool import Task
from workflow.study.folders import CASES, COST, LOGS, MESHES

BEGINS, NOT_SOLVED, MESHED = "begins", "not_solved", "meshed"  # words of a log, beside a status
LISTED = 10  # cases in a message


class Planned(Protocol):
    """A case of the scenes or of an analysis."""

    @property
    def case(self) -> Case:
        """What is solved."""

    @property
    def label(self) -> str:
        """What people call it."""

    @property
    def key(self) -> str:
        """Of the case, or of the climb."""

    @property
    def mesh(self) -> str | None:
        """File name of its mesh."""

    @property
    def promise(self) -> Promise | None:
        """Of a climb, whose first case it is."""


@dataclass(frozen=True)
class _Tried:
    """A case of a climb."""

    case: Case
    label: str
    promise: None = None

    @property
    def key(self) -> str:
        return self.case.key

    @property
    def mesh(self) -> str | None:
        return mesh_file(self.case)


Cases = Mapping[str, Planned]  # by key


def numbers(cases: Iterable[str], batches: int) -> list[int]:
    """The batches that have cases."""
    return sorted({_number(key, batches) for key in cases})


def of_batch(cases: Cases, number: int, batches: int) -> dict[str, Planned]:
    """The cases of one batch."""
    return {key: asked for key, asked in cases.items() if _number(key, batches) == number}


def _number(key: str, batches: int) -> int:
    return int(key, 16) % batches


def wanted(cases: Cases) -> str:
    """Digest of what the records of some cases must be."""
    codes = {
        key: climbs.code(p) if (p := asked.promise) else _code(asked.case)
        for key, asked in cases.items()
    }
    return digest(repr(sorted(codes.items())))


def files_of(key: str, asked: Planned) -> list[Path]:
    """Record and mesh of a case; how a climb has ended, and the record of the rung that it took."""
    if asked.promise:
        taken = climbs.taken(asked.promise)
        return [climbs.path_of(key), *([_record(taken.key)] if taken else [])]
    return [_record(key), *([MESHES / asked.mesh] if asked.mesh else [])]


def why_solved(key: str, asked: Planned) -> str:
    """Why a case will be solved; empty if its record is right."""
    if asked.promise:
        return _why_climbed(asked.promise, asked.label)
    if wrong := damage.at_a_glance(_record(key)):
        return "no record" if wrong == "missing" else f"its record is {wrong}"
    try:
        code = record.code_of(_record(key))
    except record.NoRecord:
        return "no readable record"
    return made.why(code, _sources(asked.case))


def _why_climbed(promise: Promise, label: str) -> str:
    """Why a climb is done; empty if it has ended, and the record that it has come to is right."""
    if why := climbs.why(promise):
        return why
    taken = climbs.taken(promise)
    assert taken is not None  # else there is a reason
    return why_solved(taken.key, _Tried(taken, label))


def why_meshed(asked: Planned) -> str:
    """Why the mesh of a case will be made; empty if it is right or there is none."""
    if asked.mesh is None:
        return ""
    path = MESHES / asked.mesh
    if wrong := damage.at_a_glance(path):
        return "no mesh" if wrong == "missing" else f"its mesh is {wrong}"
    return made.why(made.known(path)[0], _mesh_sources(asked.case))


def to_solve(cases: Cases) -> dict[str, str]:
    """Which cases will be solved, and why."""
    found = {key: why_solved(key, asked) for key, asked in cases.items()}
    return {key: why for key, why in found.items() if why}


def described(cases: Cases) -> str:
    """How many of some cases will be solved, which, and why, as a message."""
    solved = [f"{cases[key].label} ({why})" for key, why in to_solve(cases).items()]
    meshes = {asked.mesh: (asked.label, why_meshed(asked)) for asked in cases.values()}
    meshed = [f"the mesh of {label} ({why})" for label, why in meshes.values() if why]
    named = [*solved, *meshed]
    more = [f"{len(named) - LISTED} more"] if len(named) > LISTED else []
    return "; ".join([f"{len(solved)} of {len(cases)} cases", *named[:LISTED], *more])


def solve(cases: Cases, cores: int, limits: Limits, log: Path) -> int:
    """Solve those cases that have no right record; how many have none in the end.

    ``limits`` are those of every case.
    """
    tasks = _tasks(cases, limits)
    for asked in cases.values():
        for case in asked.promise.rungs.values() if asked.promise else [asked.case]:
            made.keep(_sources(case))
    if any(task.name not in cases or cases[task.name].promise for task in tasks):
        with suppress(ImportError, OSError):  # the mesher says so
            import gmsh  # noqa: F401  once, for all processes
        kinds = {MODELS[asked.case.model].mesh for asked in cases.values()} - {None}
        for kind in kinds:
            load(kind)
    for folder in (log.parent, MESHES):
        folder.mkdir(parents=True, exist_ok=True)
    lost = 0
    with log.open("w", encoding="utf-8") as stream:

        def tell(word: str, task: Task, more: str = "") -> None:
            now = time.strftime("%H:%M:%S")
            stream.write(f"{now} {word} {task.name} {task.label}{more}\n")
            stream.flush()

        for ended in pool.run(tasks, cores, partial(tell, BEGINS)):
            lost += bool(ended.status) and ended.task.name in cases
            if ended.status < 0:  # else it has said why
                by = Signals(-ended.status).name
                say(f"its process was ended by {by} ({ended.task.label})")
            tell(_outcome(ended), ended.task, f"; {ended.seconds:.2f} s")
    return lost


def stamp(cases: Cases) -> str:
    """What a batch leaves: digest of its records, so that only other records mean other work."""
    found, count = hashlib.sha256(), 0
    for key in sorted(cases):
        files = [p for p in files_of(key, cases[key]) if p.parent != MESHES]
        if all(path.is_file() for path in files):
            found.update(key.encode() + b"".join(path.read_bytes() for path in files))
            count += 1
    return f"{count} of {len(cases)} cases have a record; digest {found.hexdigest()}\n"


def _tasks(cases: Cases, limits: Limits) -> list[Task]:
    """Meshes and cases, longest first: so no core has to wait for one that begins late."""
    tasks: list[Task] = []
    solved, meshed = to_solve(cases), set[str]()

    def length(key: str) -> tuple[int, int]:
        case = cases[key].case
        return MODELS[case.model].rank, case.path.states

    curves: dict[str, str] = {}  # the last climb on each, by the best case of it
    for key in sorted(cases, key=length, reverse=True):
        asked = cases[key]
        if asked.promise is not None:
            continue
        if asked.mesh and asked.mesh not in meshed and why_meshed(asked):
            meshed.add(asked.mesh)
            label = f"the mesh of {asked.label}"
            tasks.append(Task(name=asked.mesh, label=label, do=partial(_mesh, asked, limits)))
        if key in solved:
            do = partial(_solve, key, asked, limits)
            tasks.append(Task(name=key, label=asked.label, do=do, after=asked.mesh))
    # After what they may find solved; of those on one curve the loosest first, one after the other.
    climbed = {key: p for key in solved if (p := cases[key].promise)}
    for key, promise in sorted(climbed.items(), key=lambda each: (-each[1].tolerance, each[0])):
        _ = promise.guesses  # once, for all processes: they are made of the same laws
        do, label = partial(_climb, key, cases[key], limits), cases[key].label
        curve = next(reversed(promise.rungs.values())).key
        tasks.append(Task(name=key, label=label, do=do, after=curves.get(curve)))
        curves[curve] = key
    return tasks


def _climb(key: str, asked: Planned, limits: Limits) -> int:
    """Keep a promise, and write how."""
    promise = asked.promise
    assert promise is not None

    def known(case: Case) -> Solution | None:
        tried = _Tried(case, asked.label)
        if not climbs.may_know(promise, case):
            return None
        return None if why_solved(case.key, tried) else record.read(_record(case.key))[1]

    def solve(case: Case) -> Solution:
        tried = _Tried(case, asked.label)
        if not why_solved(case.key, tried):
            return record.read(_record(case.key))[1]
        if tried.mesh and why_meshed(tried) and _mesh(tried, limits):
            raise climbs.Unsolved
        if _solve(case.key, tried, limits):
            raise climbs.Unsolved
        return record.read(_record(case.key))[1]

    return climbs.climb(promise, solve, known)


def _mesh(asked: Planned, limits: Limits) -> int:
    """Make a mesh, or write why there can be none.

    Another job of a cluster may make the same one: neither takes it away from under the other.
    """
    if not why_meshed(asked):
        return 0
    spec = asked.case.mesh_spec()
    assert asked.mesh is not None
    assert spec is not None
    path = MESHES / asked.mesh
    damage.make_room(path)
    try:
        why = attempt.why_not(lambda: make(json.loads(spec), path), limits.wall_time, limits.memory)
        if why:
            write_why_none(path, why)
        made.note(path, made.keep(_mesh_sources(asked.case)))
    except (attempt.Failed, OSError) as error:
        sys.stderr.write(f"not built, to be tried again: {error} (the mesh of {asked.label})\n")
        return 1
    return 0


def _solve(key: str, asked: Planned, limits: Limits) -> int:
    """Solve a case and write its record."""
    start, used = time.monotonic(), time.process_time()
    damage.make_room(_record(key))
    mesh = MESHES / asked.mesh if asked.mesh else None
    job = Job(
        case=Case.from_json(asked.case.canonical()),  # without what its model does not read
        mesh=mesh,
        record=_record(key),
        cost=COST / f"{key}.json",
        log=LOGS / f"{key}.log",
        limits=limits,
        code=_code(asked.case),
    )
    if why := "there is no mesh" if why_meshed(asked) else job.run(start, used):
        say(f"{why} ({asked.label})")
        if why_solved(key, asked):  # else another job has solved it
            damage.remove(_record(key))
    return 1 if why else 0


def _outcome(ended: pool.Ended) -> str:
    """A word for how a task has ended: of a case that is solved, its status."""
    if ended.status:
        return NOT_SOLVED
    cost = COST / f"{ended.task.name}.json"
    return str(json.loads(cost.read_text())["status"]) if cost.is_file() else MESHED


def _record(key: str) -> Path:
    return CASES / f"{key}.h5"


def _sources(case: Case) -> tuple[str, ...]:
    """Files that decide the result of a case."""
    return sources.of_solve(case.model, case.rubber.law())


def _code(case: Case) -> str:
    return record.code_digest(case.model, law=case.rubber.law())


def _mesh_sources(case: Case) -> tuple[str, ...]:
    kind = MODELS[case.model].mesh
    assert kind is not None
    return sources.of_mesh(kind)
