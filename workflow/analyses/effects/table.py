"""What becomes of the analysis of effects: one row for every effect, regime and path."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from solver.record import Solution
from solver.status import StateStatus
from workflow.analyses.analysis import Solved
from workflow.study.contents import Study

VALID = (StateStatus.CONVERGED, StateStatus.UNSTABLE)
SWITCHES = {  # what is left out: (setup with it, setup without); see cases.py
    "mesh of solid": ("solid, finer", "solid"),
    "coarse mesh of solid": ("solid, finer", "solid, coarser"),
    "compressibility": ("solid", "solid, incompressible"),
    "slackening": ("solid", "solid, two-way"),
    "cap_geometry": ("solid", "membrane"),
    "mesh of membrane": ("membrane, finer", "membrane"),
    "end_caps": ("membrane", "cylinder"),
    "wall_thickness": ("membrane", "membrane, one radius"),
    "twist": ("cylinder, twisting", "cylinder"),
    "thread_stretch": ("cylinder", "cylinder, rigid"),
    "rubber": ("cylinder", "cylinder, no rubber"),
    "discrete_threads": ("cell", "cell, smeared"),
    "all but pressure on the net": ("cylinder", "geometric"),
}


def tables(study: Study, solved: Sequence[Solved]) -> dict[str, pd.DataFrame]:
    """Changes and savings."""
    return {"effects": table(solved)}


def table(solved: Sequence[Solved]) -> pd.DataFrame:
    """Changes and savings.

    ``force``, ``diameter``, ``contraction`` are the largest change along the path, as a share of
    the largest value along it with the effect on (contraction under a load only, force not there).
    ``threshold`` is the change of the threshold pressure, as a share of it. ``missing`` counts
    states that exist with the effect and not without. ``held`` is what the path holds, ``largest``
    the force or contraction that changes are a share of. ``work`` is unknowns times iterations; 1 a
    state where a model solves by itself.
    """
    found: dict[tuple[str, str], dict[str, Solved]] = {}
    for entry in solved:
        tags = entry.asked.tags
        place = str(tags["regime"]), str(tags["path"])
        found.setdefault(place, {})[str(tags["setup"])] = entry
    return pd.DataFrame(
        [
            {"regime": regime, "path": path, "effect": effect} | row(setups, *pair)
            for (regime, path), setups in found.items()
            for effect, pair in SWITCHES.items()
            if setups.keys() >= set(pair)
        ]
    )


def row(setups: Mapping[str, Solved], with_it: str, without: str) -> dict[str, Any]:
    """What leaving out one effect changes and saves."""
    on, off = setups[with_it], setups[without]
    path = on.asked.case.path
    valid = _valid(on.solution), _valid(off.solution)
    stops = slice(0, len(path.stops))
    both = np.logical_and(valid[0][stops], valid[1][stops])
    changes = {
        "force": _change(on, off, "force", both, path.kind != "isotonic"),
        "contraction": _change(on, off, "contraction", both, path.kind == "isotonic"),
        "diameter": _change(on, off, "inner_diameter_inflated", both, True),
        "threshold": _threshold(on, off) if path.kind == "isometric" else np.nan,
    }
    return {
        "with": with_it,
        "without": without,
        **{name: float(f"{value:.4g}") for name, value in changes.items()},
        "held": float(path.held),
        "largest": float(f"{_largest(on, valid[0][stops]):.4g}"),
        "states": int(valid[0][stops].sum()),
        "missing": int((valid[0][stops] & ~valid[1][stops]).sum()),
        "unknowns_with": on.solution.unknowns,
        "unknowns_without": off.solution.unknowns,
        "work_with": _work(on.solution),
        "work_without": _work(off.solution),
    }


def _valid(solution: Solution) -> NDArray[np.bool_]:
    return np.array([status in VALID for status in solution.state_status])


def _change(on: Solved, off: Solved, name: str, both: NDArray[np.bool_], asked: bool) -> float:
    """The largest change at common states, as a share of the largest value; NaN if not asked."""
    if not asked or not both.any():
        return np.nan
    with_it, without = (s.solution.states[name][: len(both)][both] for s in (on, off))
    return float(np.abs(without - with_it).max() / np.abs(with_it).max())


def _largest(on: Solved, valid: NDArray[np.bool_]) -> float:
    """The largest force, or contraction under a load, with the effect on."""
    name = "contraction" if on.asked.case.path.kind == "isotonic" else "force"
    values = on.solution.states[name][: len(valid)][valid]
    return float(np.abs(values).max()) if valid.any() else np.nan


def _threshold(on: Solved, off: Solved) -> float:
    """Change of the state of zero force, the last of an isometric path."""
    if not off.asked.case.path.zero_force:
        return np.nan
    with_it, without = (s.solution.states["pressure"][-1] for s in (on, off))
    return float(abs(without - with_it) / with_it)


def _work(solution: Solution) -> int:
    """Unknowns times iterations; where no iterations are counted, states."""
    iterations = np.nansum(solution.states["iterations"])
    return int(max(iterations * solution.unknowns, len(solution.state_status)))
