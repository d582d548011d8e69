"""The tables of promises: one row for every choice, and what they come to.

promise           of every curve and tolerance: the rung that was taken, what was promised, what is
                  true (share of the largest value, against what the solid converges to), what would
                  have been cheapest
promise_summary   misses, cost and overestimate together, by tolerance, and by what the dearest rung
                  of a curve is with hindsight

Seconds are of the processor, of FreeFEM and Python, without meshes (0.02 s each). Of a curve each
record that its four climbs have asked for counts once; so does each rung that is cheapest with
hindsight.
"""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from math import nan
from typing import Any

import numpy as np
import pandas as pd

from workflow.analyses.analysis import Solved
from workflow.analyses.ladder.cases import RUNGS
from workflow.analyses.ladder.table import limit
from workflow.data import settled
from workflow.plan.judged import FOLLOWS, difference
from workflow.run.climbs import seconds
from workflow.study.contents import Study

NONE = "none"  # rung, where none is exact enough


def tables(study: Study, solved: Sequence[Solved]) -> dict[str, pd.DataFrame]:
    """Choices, and their summary."""
    choices = rows(solved)
    return {"promise": choices, "promise_summary": summary(choices)}


def rows(solved: Sequence[Solved]) -> pd.DataFrame:
    """One row for every choice."""
    by_curve: dict[float, list[Solved]] = defaultdict(list)
    for one in solved:
        by_curve[float(one.asked.tags["curve"])].append(one)
    return pd.DataFrame([row for curve in by_curve.values() for row in _of_curve(curve)])


def _of_curve(solved: Sequence[Solved]) -> list[dict[str, Any]]:
    rungs = {str(s.asked.tags["setup"]): s for s in solved if s.asked.promise is None}
    climbs = [s for s in solved if s.asked.promise is not None]
    truth, case = limit(rungs), rungs["solid"].asked.case
    errors = {
        name: difference(rungs[name].asked.case, rungs[name].solution, truth, FOLLOWS)
        for name in RUNGS
    }
    costs = {name: seconds(rungs[name].asked.key) for name in RUNGS}
    found, asked_for, own, needed = [], dict[str, float](), 0.0, set[str]()
    for one in climbs:
        assert one.asked.promise is not None
        end, tolerance = settled.outcome(one.asked.promise.key), one.asked.promise.tolerance
        assert end is not None  # else it has no solution
        asked_for |= end["seconds"]
        own += end["own_seconds"]
        cheapest = _cheapest(errors, costs, tolerance)
        needed |= {cheapest} - {NONE}
        found.append(
            {
                "curve": int(one.asked.tags["curve"]),
                "path": case.path.kind.value,
                "law": case.rubber.law(),
                "tolerance [1]": tolerance,
                "rung": end["rung"],
                "promised": bool(end["holds"]),
                "by": end["by"],
                "promised_error [1]": end["error"],
                "true_error [1]": errors[end["rung"]],
                "hindsight": cheapest,
            }
        )
    dearest = max(needed, key=costs.__getitem__, default=NONE)
    cost: dict[str, Any] = {
        "dearest": dearest,
        "curve_seconds [s]": sum(asked_for.values()) + own,
        "hindsight_seconds [s]": sum(costs[name] for name in needed),
    }
    return [row | cost for row in found]


def _cheapest(errors: Mapping[str, float], costs: Mapping[str, float], tolerance: float) -> str:
    """The cheapest rung that is exact enough, with hindsight."""
    enough = [name for name in errors if errors[name] <= tolerance]
    return min(enough, key=costs.__getitem__, default=NONE)


def summary(choices: pd.DataFrame) -> pd.DataFrame:
    """Misses, cost and overestimate of some choices, together; cost of whole curves only."""
    solid = choices["dearest"].str.startswith("solid")
    of_curves = {
        "dearest with hindsight a solid": choices[solid],
        "dearest with hindsight another": choices[~solid & (choices["dearest"] != NONE)],
        "all": choices,
    }
    by_tolerance = choices.groupby("tolerance [1]", sort=True)
    rows = [{"choices": f"within {100 * t:g} %", **_kept(part)} for t, part in by_tolerance]
    rows += [{"choices": name, **_kept(p), **_cost(p)} for name, p in of_curves.items()]
    return pd.DataFrame(rows)


def _kept(part: pd.DataFrame) -> dict[str, float]:
    promised = part[part["promised"]]
    true, tolerance = promised["true_error [1]"], promised["tolerance [1]"]
    ratio = (promised["promised_error [1]"] / true)[np.isfinite(true)]
    return {
        "count": len(part),
        "not_promised": int((~part["promised"]).sum()),
        "missed": int((~(true <= tolerance)).sum()),
        "worst [1]": float((true / tolerance).max()) if len(true) else nan,
        "median_overestimate [1]": float(ratio.median()) if len(ratio) else nan,
    }


def _cost(part: pd.DataFrame) -> dict[str, float]:
    curves = part.drop_duplicates("curve")
    spent, least = curves["curve_seconds [s]"].sum(), curves["hindsight_seconds [s]"].sum()
    return {
        "curves": len(curves),
        "seconds [s]": float(spent),
        "hindsight_seconds [s]": float(least),
        "cost_ratio [1]": float(spent / least) if least else nan,
    }
