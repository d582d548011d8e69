"""What becomes of hard cases: one row per case, and how far equal cases agree."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from geometry.braid import Kind
from geometry.muscle import Muscle
from solver.load_path import Control
from solver.status import CaseStatus, StateStatus
from workflow.analyses.analysis import Solved
from workflow.analyses.robustness.cases import ANY
from workflow.data.states import SHOWN
from workflow.study.contents import Study

APART = 0.03  # share of the largest force from which a membrane is far from its solid
MESH_APART = {"named": 1e-3, "hypercube": 5e-3, ANY: 5e-3}  # the same of a mesh from a finer one
NOTE_COLUMNS = [
    "set",
    "name",
    "model",
    "mesh",
    "path",
    "status",
    "reason",
    "invalid states",
    "difference",
    "difference at",
    "against",
    "cause",
]


def tables(study: Study, solved: Sequence[Solved]) -> dict[str, pd.DataFrame]:
    """Every case, and those that a reader must know."""
    rows = table(solved)
    return {"robustness": rows, "robustness_notes": notes(rows)}


def table(solved: Sequence[Solved]) -> pd.DataFrame:
    """Status, smallest det F, iterations and agreement of every case.

    ``difference`` is the largest difference of force from the case named in ``against`` (the finest
    mesh of the same model, or the solid on its finest mesh for a membrane), at states that both
    have, as a share of the largest force of that case. ``cause`` says why a membrane is far from
    its solid (docs/decisions/0005 has the evidence).
    """
    finest = _finest(solved)
    rows = []
    for one in solved:
        row = _row(one) | _agreement(one, finest.get(_muscle(one), one))  # cycles have no solid
        rows.append(row | {"cause": _cause(row)})
    return pd.DataFrame(rows)


def notes(rows: pd.DataFrame) -> pd.DataFrame:
    """What a reader must know: solids that ended early, meshes and models that are far apart."""
    solid = rows["model"] == "solid"
    ended = solid & (rows["status"] != CaseStatus.CONVERGED)
    meshes = solid & (rows["difference"] > rows["set"].map(MESH_APART))
    chosen = rows[ended | meshes | (rows["cause"] != "")]
    return chosen.sort_values(
        ["model", "set", "name", "mesh"], ascending=[False, False, True, True]
    )[NOTE_COLUMNS]


def _cause(row: Mapping[str, Any]) -> str:
    """Why a membrane is far from its solid, at the state where it is farthest."""
    if row["model"] != "membrane" or not row["difference"] > APART:
        return ""
    if row["path"] == "isobaric" and row["difference at"] < 0:
        return "drawn out: threads slip in the fitting of the solid, the membrane's end is rigid"
    if row["status"] == CaseStatus.LIMIT_POINT:
        return "ends bend, the membrane's wall cannot: near the state where it ends"
    return "ends bend, the membrane's wall cannot"


def _muscle(one: Solved) -> tuple[str, str]:
    """What cases have in common that differ in mesh and model only."""
    return str(one.asked.tags["set"]), str(one.asked.tags["name"])


def _finest(solved: Sequence[Solved]) -> dict[tuple[str, str], Solved]:
    """Of every named case and sample the solid on its finest mesh."""
    found: dict[tuple[str, str], Solved] = {}
    solids = [one for one in solved if one.asked.case.model == "solid"]
    for one in sorted(solids, key=lambda one: float(one.asked.tags["mesh"])):
        found[_muscle(one)] = one
    return found


def _row(one: Solved) -> dict[str, Any]:
    case, states, path = one.asked.case, one.states, one.asked.case.path
    muscle = case.muscle
    assert muscle.braid is not None
    assert case.thread is not None
    reached = int(states["force"].notna().sum())
    pressure = path.held if path.kind.held is Control.PRESSURE else max(path.stops)
    return {
        **one.asked.tags,
        "model": case.model,
        "path": path.kind.value,
        "rubber": case.rubber.law(),
        "gap": _gap(muscle),
        "status": one.solution.status.value,
        "reason": one.solution.reason,
        "states": len(states),
        "states reached": reached,
        "unstable states": int((states["status"] == StateStatus.UNSTABLE).sum()),
        "invalid states": int((states["status"] == StateStatus.INVALID_STATE).sum()),
        "smallest det F": states["min_det_f"].min(),
        "smallest det F at nodes": states["min_det_f_nodes"].min(),
        "iterations per state": states["iterations"].sum() / max(reached, 1),
        "cutbacks": int(states["cutbacks"].sum()),
        "largest force [N]": _largest_force(one),
        "pressure by modulus": pressure / case.rubber.load_scale,
        # hoop strain of threads that carry all of the pressure, as in a thin tube
        "thread strain": pressure
        * muscle.inner_diameter**2
        / (muscle.braid.threads_each * case.thread.stiffness),
        "record": case.key,
    }


def _gap(muscle: Muscle) -> float:
    """Of the widest sleeve, as a share of the tube's outer radius; NaN without one."""
    sleeves = [layer.radius for layer in muscle.layers if layer.kind is Kind.SLEEVE]
    return max(sleeves) / muscle.outer_radius - 1 if sleeves else np.nan


def _agreement(one: Solved, reference: Solved) -> dict[str, Any]:
    """How far a case is from its reference, at stops that both have."""
    if one is reference:
        return {"against": "", "difference": np.nan, "difference at": np.nan}
    gaps = (_valid(one) - _valid(reference)).abs().dropna()
    return {
        "against": reference.asked.label,
        "difference": gaps.max() / _largest_force(reference),
        "difference at": gaps.idxmax() if len(gaps) else np.nan,
    }


def _valid(one: Solved) -> pd.Series:
    """Force by stop; under a load contraction, which is a share already."""
    kind, rows = one.asked.case.path.kind, one.at_stops
    valid = rows.loc[rows["status"].isin(SHOWN), [kind.swept.key, kind.follows]]
    return valid.set_index(kind.swept.key)[kind.follows]


def _largest_force(one: Solved) -> float:
    """What a difference is a share of; of contractions 1."""
    if one.asked.case.path.kind.follows != "force":
        return 1.0
    return float(one.states["force"].abs().max())
