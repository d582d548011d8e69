"""What becomes of the analysis of effects: one row for every effect, regime and path."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from solver.load_path import PathKind
from workflow.analyses.analysis import Solved
from workflow.data.states import SHOWN
from workflow.plan import effect_states
from workflow.plan.model_choice import RUNGS
from workflow.study.contents import Study

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
    return pd.DataFrame(
        [
            {"regime": regime, "path": path, "effect": effect} | row(setups, *pair)
            for (regime, path), setups in _curves(solved).items()
            for effect, pair in SWITCHES.items()
            if setups.keys() >= set(pair)
        ]
    )


def states(solved: Sequence[Solved]) -> pd.DataFrame:
    """Of isobaric curves what every effect changes of the force at every state.

    A share of the largest force of the curve, as in ``table``; of the effects that the models of
    the ladder leave out one by one.
    """
    steps, found = {rung.step for rung in RUNGS.values()}, []
    for (regime, path), setups in _curves(solved).items():
        for effect, (with_it, without) in SWITCHES.items():
            if path != PathKind.ISOBARIC or effect not in steps or without not in setups:
                continue
            on, off = setups[with_it].at_stops, setups[without].at_stops
            valid = on["status"].isin(SHOWN) & off["status"].isin(SHOWN)
            changes = (off["force"] - on["force"]).abs() / on["force"][valid].abs().max()
            groups = effect_states.groups(setups[with_it].asked.case)
            of = {"regime": regime} | {k: float(f"{v:.6g}") for k, v in groups.items()}
            found += [
                of | {"effect": effect, "contraction": e, "force": float(f"{f:.4g}")}
                for e, f in zip(on["contraction"][valid], changes[valid], strict=True)
            ]
    return pd.DataFrame(found, columns=list(effect_states.COLUMNS))


def _curves(solved: Sequence[Solved]) -> dict[tuple[str, str], dict[str, Solved]]:
    """Curves by their setups, by regime and path."""
    found: dict[tuple[str, str], dict[str, Solved]] = {}
    for one in solved:
        tags = one.asked.tags
        curve = str(tags["regime"]), str(tags["path"])
        found.setdefault(curve, {})[str(tags["setup"])] = one
    return found


def row(setups: Mapping[str, Solved], with_it: str, without: str) -> dict[str, Any]:
    """What leaving out one effect changes and saves."""
    on, off = setups[with_it], setups[without]
    path, force = on.asked.case.path, on.asked.case.path.kind.follows == "force"
    valid, also = (solved.at_stops["status"].isin(SHOWN) for solved in (on, off))
    both = on.at_stops[valid & also], off.at_stops[valid & also]
    known = on.at_stops.loc[valid, path.kind.follows]
    changes = {
        "force": _change(*both, "force") if force else np.nan,
        "contraction": np.nan if force else _change(*both, "contraction"),
        "diameter": _change(*both, "inner_diameter_inflated"),
        "threshold": _threshold(on, off) if path.kind is PathKind.ISOMETRIC else np.nan,
    }
    return {
        "with": with_it,
        "without": without,
        **{name: float(f"{value:.4g}") for name, value in changes.items()},
        "held": float(path.held),
        "largest": float(f"{known.abs().max():.4g}"),
        "states": int(valid.sum()),
        "missing": int((valid & ~also).sum()),
        "unknowns_with": on.solution.unknowns,
        "unknowns_without": off.solution.unknowns,
        "work_with": _work(on),
        "work_without": _work(off),
    }


def _change(on: pd.DataFrame, off: pd.DataFrame, name: str) -> float:
    """The largest change at common states, as a share of the largest value."""
    return float((off[name] - on[name]).abs().max() / on[name].abs().max())


def _threshold(on: Solved, off: Solved) -> float:
    """Change of the state of zero force, the last of an isometric path."""
    if not off.asked.case.path.zero_force:
        return np.nan
    with_it, without = (solved.states["pressure"].iloc[-1] for solved in (on, off))
    return float(abs(without - with_it) / with_it)


def _work(solved: Solved) -> int:
    """Unknowns times iterations; where no iterations are counted, states."""
    iterations = solved.states["iterations"].sum()
    return int(max(iterations * solved.solution.unknowns, len(solved.states)))
