"""Tables of time: one row per case; the last loops; answers to small vibrations."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from solver import balance
from solver.case import DYNAMIC
from workflow.analyses.analysis import Solved
from workflow.analyses.time.cases import (
    AT,
    FURTHEST,
    MUSCLE,
    PRESSURE,
    RATES,
    SAMPLES,
)
from workflow.analyses.time.three_elements import ThreeElements
from workflow.study.contents import Study

Array = NDArray[np.float64]


def tables(study: Study, solved: Sequence[Solved]) -> dict[str, pd.DataFrame]:
    """By name."""
    elements = three_elements(study, solved)
    rows = [_row(study, one, elements) for one in solved if one.asked.case.path.history]
    found = [_curve(one) for one in solved if one.asked.case.path.history]
    answers = [
        {"label": one.asked.label, "pressure [MPa]": one.asked.tags["pressure"]}
        | {"frequency [Hz]": frequency, "storage [N/mm]": storage, "loss [N/mm]": loss}
        | {"loss factor [1]": loss / storage}
        for one in solved
        if one.asked.tags["set"] == "vibration"
        for frequency, storage, loss in one.solution.fields.get(0, {}).get(DYNAMIC, ())
    ]
    columns = ["label", "pressure [MPa]", "frequency [Hz]", "storage [N/mm]", "loss [N/mm]"]
    return {
        "time": pd.DataFrame(rows),
        "time_curves": pd.concat(found, ignore_index=True),
        "time_vibrations": pd.DataFrame(answers, columns=[*columns, "loss factor [1]"]),
    }


def three_elements(study: Study, solved: Sequence[Solved]) -> ThreeElements:
    """Fitted to the loop of the middle rate."""
    tags = {"set": "rate", "rate": RATES[1]}
    one = next(s for s in solved if tags.items() <= s.asked.tags.items())
    states = {name: values[-SAMPLES - 1 :] for name, values in one.solution.states.items()}
    contraction, force = states["contraction"], states["force"]
    known = np.isfinite(force)
    if not known.any():
        return ThreeElements(study.muscles[MUSCLE].muscle, np.nan, np.nan, np.nan)
    half = SAMPLES // 2
    rate = np.where(np.arange(SAMPLES + 1) <= half, 1.0, -1.0) * RATES[1]
    rate[[0, half, -1]] = 0.0  # it turns
    given = [values[known] for values in (np.full(SAMPLES + 1, PRESSURE), contraction, rate, force)]
    return ThreeElements.fitted(study.muscles[MUSCLE].muscle, *given)


def branches(one: Solved, of: str, along: str, at: float) -> tuple[float, float]:
    """A quantity of the last loop on the way there and back, straight between states."""
    x, y = (one.solution.states[name][-SAMPLES - 1 :] for name in (along, of))
    there, back = slice(SAMPLES // 2 + 1), slice(SAMPLES // 2, None)
    ends = [(x[there], y[there]), (x[back][::-1], y[back][::-1])]
    return tuple(float(np.interp(at, a, b)) for a, b in ends)  # type: ignore[return-value]


def _row(study: Study, one: Solved, elements: ThreeElements) -> dict[str, Any]:
    tags, case, states = one.asked.tags, one.asked.case, one.solution.states
    row: dict[str, Any] = {"set": tags["set"], "label": one.asked.label, "model": case.model}
    row |= {"pressure [MPa]": tags["pressure"], "rate [1/s]": tags.get("rate", np.nan)}
    row |= {"frequency [Hz]": tags.get("frequency", np.nan), "width": np.nan, "unit": ""}
    row |= {"mean": np.nan, "dissipated [N mm]": np.nan, "unbalanced [1]": np.nan}
    row |= {"contact [mm]": tags.get("contact", np.nan), "three elements, width [N]": np.nan}
    row |= {"status": one.solution.status.value}
    if tags["set"] in ("rate", "pressure", "wall", "sleeve"):
        there, back = branches(one, "force", "contraction", AT)
        row |= {"width": back - there, "mean": (there + back) / 2, "unit": "N"}
    if tags["set"] in ("rate", "pressure"):
        row["three elements, width [N]"] = elements.width(float(tags["rate"]))
    if tags["set"] == "frequency":
        there, back = branches(one, "contraction", "pressure", PRESSURE)
        row |= {"width": back - there, "mean": (there + back) / 2, "unit": "1"}
    if tags["set"] == "step":
        row |= {"mean": float(np.nanmax(states["contraction"], initial=-1)), "unit": "1"}
    else:
        off, lost = balance.errors(case, states)[-1]
        first, last = states["dissipated"][[-SAMPLES - 1, -1]]
        row |= {"dissipated [N mm]": last - first, "unbalanced [1]": abs(off) / lost}
    return row


def _curve(one: Solved) -> pd.DataFrame:
    """The last loop, or the whole history."""
    states, tags = one.solution.states, one.asked.tags
    part = slice(None) if tags["set"] == "step" else slice(-SAMPLES - 1, None)
    names = {"time": "s", "contraction": "1", "pressure": "MPa", "force": "N"}
    found = pd.DataFrame({f"{name} [{unit}]": states[name][part] for name, unit in names.items()})
    found.insert(0, "label", one.asked.label)
    found.insert(0, "set", tags["set"])
    return found


def widths(curve: pd.DataFrame, count: int = 19) -> tuple[Array, Array]:
    """Contractions, and the width of a loop of force there."""
    e, f = (curve[name].to_numpy() for name in ("contraction [1]", "force [N]"))
    at = np.linspace(0.05, 0.95, count) * FURTHEST
    there, back = slice(SAMPLES // 2 + 1), slice(SAMPLES // 2, None)
    return at, np.interp(at, e[back][::-1], f[back][::-1]) - np.interp(at, e[there], f[there])
