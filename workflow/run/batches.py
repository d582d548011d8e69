"""Many cases in one job: what is imported is so once, and as many processes as cores do the cases.

A case belongs to a batch by its key alone, so one that is added touches one batch and moves no
other. Of a batch those cases are solved that have no right record: one that is whole and was solved
by the sources there are. Their meshes are made first, each once. Whatever happens to the process
that does a case, the others go on.

The log of a batch has a line when a case begins and one when it ends; workflow/run/progress.py
reads it while it grows.
"""

import hashlib
import json
import sys
import time
from collections.abc import Iterable, Mapping
from contextlib import suppress
from functools import partial
from pathlib import Path
from signal import Signals
from typing import Protocol

from geometry import attempt
from geometry.make import make
from geometry.seal import write_why_none
from solver import record, sources
from solver.case import Case, digest
from solver.freefem import Limits
from solver.job import Job, say
from solver.models import MODELS
from workflow.run import damage, made, pool
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
    def mesh(self) -> str | None:
        """File name of its mesh."""


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
    return digest(repr(sorted((key, _code(asked.case)) for key, asked in cases.items())))


def files_of(key: str, asked: Planned) -> list[Path]:
    """Record and mesh of a case."""
    return [_record(key), *([MESHES / asked.mesh] if asked.mesh else [])]


def why_solved(key: str, asked: Planned) -> str:
    """Why a case will be solved; empty if its record is right."""
    if wrong := damage.at_a_glance(_record(key)):
        return "no record" if wrong == "missing" else f"its record is {wrong}"
    try:
        code = record.code_of(_record(key))
    except record.NoRecord:
        return "no readable record"
    return made.why(code, _sources(asked.case))


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
        made.keep(_sources(asked.case))
    if any(task.name not in cases for task in tasks):
        with suppress(ImportError, OSError):  # the mesher says so
            import gmsh  # noqa: F401  once, for all processes
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
        if _record(key).is_file():
            found.update(key.encode() + _record(key).read_bytes())
            count += 1
    return f"{count} of {len(cases)} cases have a record; digest {found.hexdigest()}\n"


def _tasks(cases: Cases, limits: Limits) -> list[Task]:
    """Meshes and cases, longest first: so no core has to wait for one that begins late."""
    tasks: list[Task] = []
    solved, meshed = to_solve(cases), set[str]()

    def length(key: str) -> tuple[int, int]:
        case = cases[key].case
        return MODELS[case.model].rank, case.path.states

    for key in sorted(cases, key=length, reverse=True):
        asked = cases[key]
        if asked.mesh and asked.mesh not in meshed and why_meshed(asked):
            meshed.add(asked.mesh)
            label = f"the mesh of {asked.label}"
            tasks.append(Task(name=asked.mesh, label=label, do=partial(_mesh, asked, limits)))
        if key in solved:
            do = partial(_solve, key, asked, limits)
            tasks.append(Task(name=key, label=asked.label, do=do, after=asked.mesh))
    return tasks


def _mesh(asked: Planned, limits: Limits) -> int:
    """Make a mesh, or write why there can be none."""
    spec = asked.case.mesh_spec()
    assert asked.mesh is not None
    assert spec is not None
    path = MESHES / asked.mesh
    damage.remove(path)  # whatever comes, it is not right
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
    damage.remove(_record(key))  # whatever comes, it is not right
    mesh = MESHES / asked.mesh if asked.mesh else None
    if mesh and not mesh.is_file():
        say(f"there is no mesh ({asked.label})")
        return 1
    job = Job(
        case=Case.from_json(asked.case.canonical()),  # without what its model does not read
        mesh=mesh,
        record=_record(key),
        cost=COST / f"{key}.json",
        log=LOGS / f"{key}.log",
        limits=limits,
        code=_code(asked.case),
    )
    if why := job.run(start, used):
        say(f"{why} ({asked.label})")
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
