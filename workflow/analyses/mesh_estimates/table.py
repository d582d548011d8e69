"""The tables of reported errors: of every state, and how many cover the true one.

Shares of the largest value along the curve; of the threshold pressure of itself. ``estimated`` is
what a curve reports that is solved alone, ``measured`` what it reports with a mesh twice as fine;
``true`` is the difference from the finest mesh. States that the finest mesh has not, or the default
one, are left out and counted.
"""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from workflow.analyses.analysis import Solved
from workflow.analyses.mesh_estimates.cases import REFINEMENTS, TRUTH
from workflow.plan import mesh_error
from workflow.plan.judged import FOLLOWS, ZERO, is_valid, scale, variable_of
from workflow.study.contents import Study

REPORTED = ("estimated", "measured")
QUANTITIES = (FOLLOWS, "inner_diameter", "volume", ZERO)
ALL = "all"


def tables(study: Study, solved: Sequence[Solved]) -> dict[str, pd.DataFrame]:
    """Of states, and their summary."""
    by_curve: dict[float, dict[int, Solved]] = defaultdict(dict)
    for one in solved:
        tags = one.asked.tags
        by_curve[float(tags["curve"])][int(float(tags["refinement"]))] = one
    whole = [meshes for meshes in by_curve.values() if len(meshes) == len(REFINEMENTS)]
    states = pd.DataFrame([row for meshes in whole for row in of_curve(meshes)])
    return {"mesh_estimates": states, "mesh_estimates_summary": summary(states)}


def of_curve(meshes: Mapping[int, Solved]) -> Iterator[dict[str, Any]]:
    """One row for every quantity at every state; also for states that cannot be judged."""
    case, own = meshes[1].asked.case, meshes[1].solution
    finer, truth = meshes[2].solution, meshes[TRUTH].solution
    there = is_valid(own) & is_valid(truth)
    stops = len(case.path.stops)
    for quantity in QUANTITIES:
        name = variable_of(case, quantity)
        values = own.states[name]
        errors = {
            "estimated": mesh_error.error(case, own, name),
            "measured": np.where(is_valid(finer), mesh_error.error(case, own, name, finer), np.nan),
            "true": np.where(there, np.abs(values - truth.states[name]), np.nan),
        }
        numbers = range(stops, case.path.states) if quantity == ZERO else range(stops)
        for state in numbers:
            whole = abs(values[state]) if quantity == ZERO else scale(case, own, quantity)
            yield {
                "model": case.model,
                "curve": int(meshes[1].asked.tags["curve"]),
                "path": case.path.kind.value,
                "quantity": _called(quantity, name),
                "state": state,
                **{f"{each} [1]": found[state] / whole for each, found in errors.items()},
            }


def _called(quantity: str, variable: str) -> str:
    """In the tables; the pressure of no force is the threshold pressure."""
    return {FOLLOWS: variable, ZERO: "threshold_pressure"}.get(quantity, quantity)


def summary(states: pd.DataFrame) -> pd.DataFrame:
    """How many are covered and the median of reported by true, by model and quantity.

    First what follows from the controls: of force and contraction together.
    """
    follows = states["quantity"].isin(["force", "contraction"])
    parts: dict[tuple[str, str, str], pd.DataFrame] = {
        (ALL, "force and contraction", ALL): states[follows]
    }
    for model, of in states.groupby("model"):
        parts[str(model), "force and contraction", ALL] = of[follows[of.index]]
        for quantity, own in of.groupby("quantity", sort=False):
            paths = own.groupby("path") if quantity == "force" else []
            parts |= {(str(model), str(quantity), str(path)): part for path, part in paths}
            if quantity != "force":
                parts[str(model), str(quantity), ALL] = own
    return pd.DataFrame(
        [
            {"model": model, "quantity": quantity, "path": path, "reported": reported}
            | _covered(part, reported)
            for (model, quantity, path), part in parts.items()
            for reported in REPORTED
        ]
    )


def _covered(states: pd.DataFrame, reported: str) -> dict[str, float]:
    """Of states of which the true error is known, and the reported one."""
    judged = states[np.isfinite(states["true [1]"])]
    said, true = judged[f"{reported} [1]"], judged["true [1]"]
    known = np.isfinite(said)
    return {
        "curves": judged["curve"].nunique(),
        "states": len(judged),
        "not judged": len(states) - len(judged),
        "not known": int((~known).sum()),
        "covered [1]": float((said >= true)[known].mean()),
        "median overestimate [1]": float((said / true)[known].median()),
    }
