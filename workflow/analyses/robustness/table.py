"""What becomes of hard cases: one row per case, and how far equal cases agree."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from solver.status import CaseStatus, StateStatus
from workflow.analyses.analysis import Solved
from workflow.study.contents import Study

VALID = (StateStatus.CONVERGED, StateStatus.UNSTABLE)
APART = 0.03  # share of the largest force from which a membrane is far from its solid
MESH_APART = {"named": 1e-3, "hypercube": 5e-3}  # the same of a mesh from a finer one
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
    for entry in solved:
        row = _row(entry) | _agreement(entry, finest[_group(entry)])
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


def _group(entry: Solved) -> tuple[str, str]:
    return str(entry.asked.tags["set"]), str(entry.asked.tags["name"])


def _finest(solved: Sequence[Solved]) -> dict[tuple[str, str], Solved]:
    """Of every named case and sample the solid on its finest mesh."""
    found: dict[tuple[str, str], Solved] = {}
    for entry in solved:
        if entry.asked.case.model != "solid":
            continue
        known = found.get(_group(entry))
        if known is None or float(known.asked.tags["mesh"]) < float(entry.asked.tags["mesh"]):
            found[_group(entry)] = entry
    return found


def _row(entry: Solved) -> dict[str, Any]:
    case, solution = entry.asked.case, entry.solution
    muscle, states = case.muscle, solution.states
    assert muscle.braid is not None
    assert case.thread is not None
    reached = np.isfinite(states["force"])
    count = max(int(reached.sum()), 1)
    modulus = case.rubber.load_scale
    pressure = max(case.path.stops) if case.path.kind != "isobaric" else case.path.held
    return {
        **entry.asked.tags,
        "model": case.model,
        "path": case.path.kind.value,
        "status": solution.status.value,
        "reason": solution.reason,
        "states": len(reached),
        "states reached": int(reached.sum()),
        "unstable states": sum(s is StateStatus.UNSTABLE for s in solution.state_status),
        "invalid states": sum(s is StateStatus.INVALID_STATE for s in solution.state_status),
        "smallest det F": _smallest(states["min_det_f"]),
        "smallest det F at nodes": _smallest(states["min_det_f_nodes"]),
        "iterations per state": float(np.nansum(states["iterations"])) / count,
        "cutbacks": int(np.nansum(states["cutbacks"])),
        "largest force [N]": _largest_force(entry),
        "pressure by modulus": pressure / modulus,
        # hoop strain of threads that carry all of the pressure, as in a thin tube
        "thread strain": pressure
        * muscle.inner_diameter**2
        / (muscle.braid.threads * case.thread.stiffness),
        "record": case.key,
    }


def _agreement(entry: Solved, reference: Solved) -> dict[str, Any]:
    if entry is reference:
        return {"against": "", "difference": np.nan, "difference at": np.nan}
    swept = "contraction" if entry.asked.case.path.kind == "isobaric" else "pressure"
    ours, theirs = _valid_forces(entry), _valid_forces(reference)
    common = sorted(ours.keys() & theirs.keys())
    if not common:
        return {"against": reference.asked.label, "difference": np.nan, "difference at": np.nan}
    gaps: NDArray[np.float64] = np.abs([ours[stop] - theirs[stop] for stop in common])
    worst = int(np.argmax(gaps))
    return {
        "against": reference.asked.label,
        "difference": float(gaps[worst]) / _largest_force(reference),
        "difference at": common[worst] if swept else np.nan,
    }


def _valid_forces(entry: Solved) -> dict[float, float]:
    """Force, or contraction in units of the force's scale on isotonic paths, by stop."""
    isotonic = entry.asked.case.path.kind == "isotonic"
    values = entry.solution.states["contraction" if isotonic else "force"]
    return {
        stop: float(value)
        for stop, value, status in zip(
            entry.asked.case.path.stops, values, entry.solution.state_status, strict=False
        )
        if status in VALID
    }


def _largest_force(entry: Solved) -> float:
    """What a difference is a share of; isotonic paths are compared by contraction, as it is."""
    if entry.asked.case.path.kind == "isotonic":
        return 1.0
    force = np.abs(entry.solution.states["force"])
    return float(np.nanmax(force)) if np.isfinite(force).any() else np.nan


def _smallest(values: NDArray[np.float64]) -> float:
    return float(np.nanmin(values)) if np.isfinite(values).any() else np.nan
