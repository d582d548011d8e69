"""The table of effects on like muscles: one row for every curve and effect."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from workflow.analyses.analysis import Solved
from workflow.analyses.like_effects.cases import PAIRS
from workflow.plan import likeness
from workflow.plan.judged import QUANTITIES, is_valid
from workflow.study.contents import Study


def tables(study: Study, solved: Sequence[Solved]) -> dict[str, pd.DataFrame]:
    """The one table."""
    by_curve: dict[float, dict[str, Solved]] = defaultdict(dict)
    for one in solved:
        by_curve[float(one.asked.tags["curve"])][str(one.asked.tags["setup"])] = one
    return {"like_effects": pd.DataFrame([row for each in by_curve.values() for row in rows(each)])}


def rows(setups: Mapping[str, Solved]) -> list[dict[str, Any]]:
    """Of every effect the largest change along a curve, at states that both have.

    A share of the largest value along the curve with the effect; ``lost`` are states that only the
    curve with it has.
    """
    found = []
    for effect, (on, off) in PAIRS.items():
        if not {on, off} <= setups.keys():
            continue
        case, with_it, without = setups[on].asked.case, setups[on].solution, setups[off].solution
        found.append(
            {
                "curve": int(setups[on].asked.tags["curve"]),
                "path": case.path.kind.value,
                "law": case.rubber.law(),
                **likeness.groups(case),
                "effect": effect,
                **{
                    quantity: _largest(likeness.share(case, without, with_it, quantity))
                    for quantity in (likeness.FOLLOWS, *QUANTITIES)
                },
                "lost": int((is_valid(with_it) & ~is_valid(without)).sum()),
                "states": int(is_valid(with_it).sum()),
            }
        )
    return found


def _largest(shares: np.ndarray) -> float:
    """NaN where no state has both."""
    return float(np.nanmax(shares)) if np.isfinite(shares).any() else float("nan")
