"""What leaving out an effect changes at single states: ``effect_states.csv`` beside this.

Of the isobaric curves of the analysis of effects, with the dimensionless groups of their muscles
(workflow/plan/likeness.py); made and committed with effect_costs.csv, which has the largest change
of a whole curve.
"""

import csv
from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import cache
from itertools import pairwise
from math import isclose
from pathlib import Path

from solver.case import Case
from workflow.plan import effect_costs, likeness
from workflow.plan.effect_costs import MeasuredEffects

FILE = Path(__file__).with_suffix(".csv")
DATA = ("workflow/plan/effect_states.csv",)
SHAPE = ("wall", "length", "angle", "gap", "sleeve", "softness")
COLUMNS = ("regime", "pressure", *SHAPE, "effect", "contraction", "force")
PATH = "isobaric"
SAME = 1e-2  # share by which groups of one muscle may differ
Known = dict[str, list[tuple[float, float]]]  # contractions and changes, by effect


def groups(case: Case) -> dict[str, float]:
    """Of a curve at constant pressure; ``softness`` is of the threads, D^2 G / (sum of n EA)."""
    found = likeness.groups(case)
    softness = found["strain"] / found["pressure"] if found["pressure"] else float("nan")
    return {name: found.get(name, softness) for name in ("pressure", *SHAPE)}


def at(
    case: Case, contraction: float, effects: Iterable[str], file: Path = FILE
) -> MeasuredEffects | None:
    """The measured effects with what some of them change at a state of an isobaric curve.

    None where one of these was not measured on this muscle around that pressure and contraction.
    The change is the largest of the measured states beside it: elsewhere it has another sign.
    """
    curves, found = _around(case, file), {}
    for effect in effects:
        changes = [_beside(known.get(effect, []), contraction) for known in curves]
        if not changes or None in changes:
            return None
        found[effect] = max(change for change in changes if change is not None)
    return {
        key: replace(effect, force=found.get(effect.effect, effect.force))
        if key[1] == PATH
        else effect
        for key, effect in effect_costs.load().items()
    }


def _around(case: Case, file: Path) -> list[Known]:
    """The measured curves of this muscle at its pressure, or at the next lower and higher one."""
    own = groups(case)
    curves = sorted(
        ((of["pressure"], known) for of, known in _curves(file) if _is_same(own, of)),
        key=lambda curve: curve[0],
    )
    for pressure, known in curves:
        if isclose(pressure, own["pressure"], rel_tol=SAME):
            return [known]
    for (low, below), (high, above) in pairwise(curves):
        if low < own["pressure"] < high:
            return [below, above]
    return []


def _is_same(one: dict[str, float], other: dict[str, float]) -> bool:
    return all(isclose(one[n], other[n], rel_tol=SAME, abs_tol=1e-9) for n in SHAPE)


def _beside(known: list[tuple[float, float]], contraction: float) -> float | None:
    """The larger change at the neighbours of a contraction; None beyond them."""
    for (low, here), (high, there) in pairwise(known):
        if low <= contraction <= high:
            return max(here, there)
    return None


@cache
def _curves(file: Path) -> list[tuple[dict[str, float], Known]]:
    """Groups of the measured curves, and what effects change along them."""
    return list(_read(file))


def _read(file: Path) -> Iterator[tuple[dict[str, float], Known]]:
    with file.open(newline="", encoding="utf-8") as stream:
        rows = list(csv.DictReader(line for line in stream if not line.startswith("#")))
    for regime in dict.fromkeys(row["regime"] for row in rows):
        of = [row for row in rows if row["regime"] == regime]
        known: Known = {}
        for row in of:
            state = float(row["contraction"]), float(row["force"])
            known.setdefault(row["effect"], []).append(state)
        yield {name: float(of[0][name]) for name in ("pressure", *SHAPE)}, known
