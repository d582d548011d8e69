"""First guesses of what leaving out an effect changes, on muscles that are like one.

``like_effects.csv`` beside this module has the changes on random muscles of all kinds, with the
dimensionless groups of these (workflow/plan/likeness.py), by the analysis of that name:

    snakemake --cores 2 like_effects && muscle likeness --effects

A law of groups with its spread, as of the errors of rungs (workflow/plan/like_muscles.py): said is
what half of like muscles have at most, and COVERAGE of them.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from math import isfinite, nan
from pathlib import Path

import numpy as np

from solver.case import Case
from workflow.plan import like_muscles, likeness
from workflow.plan.judged import FOLLOWS
from workflow.plan.like_muscles import COVERAGE, Law, curve_features, groups_of, is_like

FILE = Path(__file__).with_suffix(".csv")
DATA = ("workflow/plan/like_effects.csv",)
FEWEST = 50  # muscles: of fewer no law is fitted; of a braid in the wall there are 57


@dataclass(frozen=True)
class Guess:
    """Of the largest change along a curve, as a share of the largest value along it.

    Attributes
    ----------
    median, high : half of like muscles have at most this, and COVERAGE of them
    count : of muscles that it is from
    """

    median: float
    high: float
    count: int


def guess(case: Case, effect: str, quantities: Sequence[str] = (FOLLOWS,)) -> Guess | None:
    """Of leaving out an effect on a curve, of the quantity that it changes most.

    None if no muscles are like it, or what the effect changes on such was not solved.
    """
    return like_muscles.worst([_guess(case, effect, quantity) for quantity in quantities])


def _guess(case: Case, effect: str, quantity: str) -> Guess | None:
    law, kind = _law(effect, quantity), str(case.path.kind)
    if law is None or kind not in law.classes or not is_like(case):
        return None
    value, wider = law.at(curve_features(likeness.groups(case), kind)[None], kind)
    if np.isnan(value[0]):
        return None
    median, high = (law.most(value[0], wider[0], share) for share in (0.5, COVERAGE))
    return Guess(median, high, len(law.spread))


def origin() -> str:
    """When and with which code the table was made."""
    return like_muscles.origin(FILE)


@cache
def _law(effect: str, quantity: str) -> Law | None:
    """Of the muscles on which the effect changes anything."""
    rows = [
        row for row in _table().get(effect, ()) if isfinite(v := _value(row, quantity)) and v > 0
    ]
    if len(rows) < FEWEST:
        return None
    groups = np.array([curve_features(groups_of(row), row["path"]) for row in rows])
    changes = np.array([_value(row, quantity) for row in rows])
    blocks, kinds = (np.array([row[name] for row in rows]) for name in ("curve", "path"))
    return Law.fit(groups, changes, blocks, kinds)


def _value(row: dict[str, str], quantity: str) -> float:
    return float(row.get(quantity) or nan)


@cache
def _table() -> dict[str, list[dict[str, str]]]:
    """Rows by effect."""
    return like_muscles.read(FILE, "effect")
