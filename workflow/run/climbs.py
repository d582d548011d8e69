"""Climbs inside a batch: how each has ended, and whether that is still right.

results/promises/<key>.json   ``Outcome`` (workflow/plan/promise.py), ``seconds`` of the
                              processor that each record took which it has asked for, and
                              ``whole``: rungs of which it had all states
results/cost/<key>.json       what the climb itself took, with the status of the rung it came to

It is done again where the sources of a rung, or what guesses are made of, have changed.
"""

import json
import time
from functools import cache
from math import nan
from pathlib import Path
from typing import Any

from geometry.files import atomic_write
from solver import sources
from solver.case import Case
from solver.record import Solution
from workflow.plan import promise as plan_promise
from workflow.plan.promise import Known, Promise, Solve
from workflow.run import damage, made
from workflow.study.folders import COST, PROMISES


class Unsolved(Exception):
    """A case has no record, for a reason outside of it."""


def path_of(key: str) -> Path:
    """How a climb has ended."""
    return PROMISES / f"{key}.json"


def taken(promise: Promise) -> Case | None:
    """The case that a climb has come to; None if it has not ended."""
    return promise.rungs.get((_read(promise.key) or {}).get("rung", ""))


def why(promise: Promise) -> str:
    """Why it is done; empty if it has ended, by the sources there are."""
    path = path_of(promise.key)
    if wrong := damage.at_a_glance(path):
        return "no climb yet" if wrong == "missing" else f"how its climb ended is {wrong}"
    if taken(promise) is None:
        return "how its climb ended cannot be read"
    return made.why(made.known(path)[0], _sources(promise))


def code(promise: Promise) -> str:
    """Digest of its sources."""
    return sources.digest(_sources(promise))


def may_know(promise: Promise, case: Case) -> bool:
    """Whether a climb may look at the record of a case, if that is there."""
    if promise.after is None:
        return True
    return any(case.key in (_read(key) or {"seconds": ()})["seconds"] for key in promise.after)


def climb(promise: Promise, solve: Solve, known: Known) -> int:
    """Do it, and write how it has ended; 1 if a case has no record, for a reason outside of it."""
    start, used, path = time.monotonic(), time.process_time(), path_of(promise.key)
    damage.remove(path)
    asked: dict[str, str] = {}  # status by record
    there: set[str] = set()
    solving = 0.0

    def looked_at(case: Case) -> Solution | None:
        found = known(case)
        if found is not None:
            there.add(case.key)
        return found

    def counted(case: Case) -> Solution:
        nonlocal solving
        before = time.process_time()
        found = solve(case)
        solving += time.process_time() - before
        asked[case.key] = found.status.value
        return found

    try:
        end = plan_promise.climb(promise, counted, looked_at)
        case = promise.rungs[end.rung]
        status = asked.get(case.key) or counted(case).status.value
    except Unsolved:
        return 1
    own = time.process_time() - used - solving
    found = end.as_dict() | {"record": case.key, "tolerance": promise.tolerance}
    found |= {"seconds": {key: seconds(key) for key in asked}, "own_seconds": own}
    had = there | asked.keys()
    found["whole"] = [name for name, each in promise.rungs.items() if each.key in had]
    with atomic_write(path) as beside:
        beside.write_text(json.dumps(found, sort_keys=True) + "\n")
    made.note(path, made.keep(_sources(promise)))
    cost = {"total_seconds": time.monotonic() - start, "python_cpu_seconds": own, "status": status}
    with atomic_write(COST / f"{promise.key}.json", sealed=False) as beside:
        beside.write_text(json.dumps(cost, sort_keys=True) + "\n")
    return 0


def seconds(key: str) -> float:
    """Of the processor, by FreeFEM and Python, that the record of a case has taken.

    NaN where that is not known: a job that is killed may leave a record without its cost.
    """
    try:
        cost = json.loads((COST / f"{key}.json").read_text())
    except (OSError, ValueError):
        return nan
    parts = ("python_cpu_seconds", "solve_cpu_seconds", "freefem_cpu_seconds")
    return float(sum(cost.get(part, 0.0) for part in parts))


def _read(key: str) -> dict[str, Any] | None:
    """How a climb has ended; None if it has not, or that cannot be read."""
    try:
        return dict(json.loads(path_of(key).read_text()))
    except (OSError, ValueError):
        return None


def _sources(promise: Promise) -> tuple[str, ...]:
    models = tuple(dict.fromkeys(case.model for case in promise.rungs.values()))
    law = next(iter(promise.rungs.values())).rubber.law()
    return _of(models, law)


@cache
def _of(models: tuple[str, ...], law: str) -> tuple[str, ...]:
    """Files that decide how a climb by some models ends."""
    files = set(sources.sources("workflow.plan.promise"))
    for model in models:
        files.update(sources.of_solve(model, law))
    return tuple(sorted(files))
