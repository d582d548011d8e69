"""The tables of reported errors: of every state, and how many cover the true one.

Shares of the largest value along the curve. ``estimated`` is what a curve reports that is solved
alone, ``measured`` what it reports with a mesh twice as fine; ``true`` is the difference from the
finest mesh. States that the finest mesh has not, or the default one, are left out and counted.
"""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from workflow.analyses.analysis import Solved
from workflow.analyses.mesh_estimates.cases import REFINEMENTS, TRUTH
from workflow.plan import mesh_error
from workflow.plan.judged import FOLLOWS, is_valid, scale
from workflow.study.contents import Study

REPORTED = ("estimated", "measured")


def tables(study: Study, solved: Sequence[Solved]) -> dict[str, pd.DataFrame]:
    """Of states, and their summary."""
    by_curve: dict[float, dict[int, Solved]] = defaultdict(dict)
    for one in solved:
        tags = one.asked.tags
        by_curve[float(tags["curve"])][int(float(tags["refinement"]))] = one
    whole = [meshes for meshes in by_curve.values() if len(meshes) == len(REFINEMENTS)]
    states = pd.DataFrame([row for meshes in whole for row in of_curve(meshes)])
    return {"mesh_estimates": states, "mesh_estimates_summary": summary(states)}


def of_curve(meshes: Mapping[int, Solved]) -> list[dict[str, Any]]:
    """One row for every state."""
    case, own = meshes[1].asked.case, meshes[1].solution
    finer, truth = meshes[2].solution, meshes[TRUTH].solution
    name, whole = case.path.kind.follows, scale(case, own, FOLLOWS)
    there = is_valid(own) & is_valid(truth)
    errors = {
        "estimated": mesh_error.error(case, own, name),
        "measured": np.where(is_valid(finer), mesh_error.error(case, own, name, finer), np.nan),
        "true": np.abs(own.states[name] - truth.states[name]),
    }
    return [
        {
            "curve": int(meshes[1].asked.tags["curve"]),
            "path": case.path.kind.value,
            "state": state,
            **{f"{each} [1]": values[state] / whole for each, values in errors.items()},
        }
        for state in np.flatnonzero(there)
    ]


def summary(states: pd.DataFrame) -> pd.DataFrame:
    """How many are covered and the median of reported by true, of all and of every kind of path."""
    parts = {"all": states} | {str(kind): part for kind, part in states.groupby("path")}
    return pd.DataFrame(
        [
            {"path": name, "reported": reported, **_covered(part, reported)}
            for name, part in parts.items()
            for reported in REPORTED
        ]
    )


def _covered(states: pd.DataFrame, reported: str) -> dict[str, float]:
    said, true = states[f"{reported} [1]"], states["true [1]"]
    known = np.isfinite(said)
    return {
        "curves": states["curve"].nunique(),
        "states": len(states),
        "not known": int((~known).sum()),
        "covered [1]": float((said >= true)[known].mean()),
        "median overestimate [1]": float((said / true)[known].median()),
    }
