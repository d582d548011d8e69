"""Fits of a study, each from some pressures and judged at others.

A calibration fits its parameters to the forces of a map at its ``fit_pressure``, contractions 0 to
20 %: at the map's own points, or, if these are few, also at the states of
workflow/data/deviation.py between them (intervals are then on the small side, as these are no
measurements of their own). It is compared with the map at all its pressures by the rule there: by
the model of the fit, and by the
solid, which shows whether that model was good enough.
"""

import tempfile
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from geometry.muscle import Braid
from solver.numerics import Spread
from workflow.analyses.calibration.fit import Fitted, Parameter, fit
from workflow.analyses.calibration.forward_model import ForwardModel
from workflow.data import bench, deviation
from workflow.data.reference import CONTRACTIONS, ForceMap
from workflow.study.contents import StudiedMuscle, Study
from workflow.study.errors import StudyError
from workflow.study.fit import stiffness
from workflow.study.schema import CalibrationEntry

CHECK = "solid"


@dataclass(frozen=True)
class Calibration:
    """What a fit has given.

    Attributes
    ----------
    fitted : the values
    deviations : one row per pressure, model and state of the values (``before``, ``after``)
    states : the forces behind them, and the map's
    """

    name: str
    entry: CalibrationEntry
    fitted: list[Fitted]
    deviations: pd.DataFrame
    states: pd.DataFrame

    @property
    def values(self) -> dict[str, float]:
        """Fitted values by key of the study file, four digits."""
        return rounded((f.parameter.name, f.value) for f in self.fitted)


def rounded(values: Iterable[tuple[str, float]]) -> dict[str, float]:
    """Fitted values as they are used and written."""
    return {name: float(f"{value:.4g}") for name, value in values}


def calibrate(study: Study, name: str) -> Calibration:
    """One calibration of a study.

    Raises
    ------
    StudyError
        If there is no such map, or too little in it.
    """
    entry = study.calibration[name]
    muscle = study.muscles[entry.muscle]
    assert entry.reference is not None  # the study has named one
    found = bench.read(entry.reference, muscle.muscle.length)
    with tempfile.TemporaryDirectory() as folder:
        forward = ForwardModel(study, muscle, Path(folder))
        try:
            fitted = fit(_parameters(entry, muscle), _residuals(name, entry, found, forward))
        except ValueError as error:
            raise StudyError(f"calibration.{name}: {error}") from None
        result = Calibration(name, entry, fitted, pd.DataFrame(), pd.DataFrame())
        states = _states(result, found, forward)
    return Calibration(name, entry, fitted, _deviations(result, states), states)


def _parameters(entry: CalibrationEntry, muscle: StudiedMuscle) -> list[Parameter]:
    assert muscle.thread is not None  # the check of a study refuses a bare tube
    start = {"thread_stiffness": muscle.thread.stiffness} | muscle.rubber.values()
    units = {"thread_stiffness": "N"} | {p.name: p.unit for p in muscle.rubber.parameters()}
    return [
        Parameter(key, units[key], start[key], *getattr(entry.bounds, key)) for key in entry.fit
    ]


def _residuals(
    name: str, entry: CalibrationEntry, found: ForceMap, forward: ForwardModel
) -> Callable[[Mapping[str, float]], NDArray[np.float64]]:
    """Function of the values: forces minus those of the map, at the fitted pressures [N]."""
    wanted: dict[float, tuple[NDArray[np.float64], NDArray[np.float64]]] = {}
    for pressure in entry.fit_pressure:
        stops = bench.stops(found, pressure)
        if not stops.size:
            raise StudyError(
                f"calibration.{name}.fit_pressure: {entry.reference} has no force at "
                f"{pressure:g} MPa between 0 and {100 * bench.FURTHEST:g} %"
            )
        wanted[pressure] = stops, found.force(stops, pressure)

    def residuals(values: Mapping[str, float]) -> NDArray[np.float64]:
        parts = []
        for pressure, (stops, expected) in wanted.items():
            force = forward.forces(values, entry.model, pressure, stops)
            # where there is no state the residual is as large as the largest force
            parts.append(np.nan_to_num(force - expected, nan=float(np.max(np.abs(expected)))))
        return np.concatenate(parts)

    return residuals


def _states(result: Calibration, found: ForceMap, forward: ForwardModel) -> pd.DataFrame:
    """Forces before and after at the states of the rule, and those of the map."""
    entry, frames = result.entry, []
    pressures = sorted({*entry.fit_pressure, *entry.report_pressure})
    for when, values, model in (
        ("before", {}, entry.model),
        ("after", result.values, entry.model),
        ("after", result.values, CHECK),
    ):
        for pressure in pressures:
            computed = forward.states(values, model, pressure, CONTRACTIONS)
            rows = deviation.states(found, computed)
            role = "fit" if pressure in entry.fit_pressure else "report"
            frames.append(rows.assign(values=when, model=model, role=role))
    return pd.concat(frames, ignore_index=True).drop_duplicates(
        ["values", "model", "pressure", "contraction"]
    )


def _deviations(result: Calibration, states: pd.DataFrame) -> pd.DataFrame:
    keys = ["values", "model", "role", "pressure"]
    rows = [
        {"calibration": result.name, "reference": result.entry.reference}
        | dict(zip(keys, group, strict=True))
        | deviation.summary(found)
        for group, found in states.groupby(keys, sort=False)
    ]
    return pd.DataFrame(rows).rename(columns={"pressure": "pressure [MPa]"})


def values(result: Calibration, study: Study) -> pd.DataFrame:
    """The fitted values with their intervals, and what to think of them."""
    muscle = study.muscles[result.entry.muscle]
    return pd.DataFrame(
        {
            "calibration": result.name,
            "muscle": result.entry.muscle,
            "reference": result.entry.reference,
            "parameter": f.parameter.name,
            "unit": f.parameter.unit,
            "before": f.parameter.start,
            "fitted": f.value,
            "low_95": f.low,
            "high_95": f.high,
            "note": note(f, muscle),
        }
        for f in result.fitted
    )


def note(fitted: Fitted, muscle: StudiedMuscle) -> str:
    """What stands against taking a value for the property of a material."""
    said = []
    if fitted.at_bound:
        said.append("stopped by its bound, not by the data")
    if not fitted.low > 0 or fitted.high / fitted.low > 100:
        said.append("the data hardly says anything of it")
    braid = muscle.muscle.braid
    if fitted.parameter.name == "thread_stiffness" and isinstance(braid, Braid):
        limit = thickest(braid)
        if fitted.value > limit:
            said.append(
                f"above {limit:.0f} N, the thickest thread between the layers: an effective value"
            )
    return "; ".join(said)


def thickest(braid: Braid) -> float:
    """EA of a thread as thick as the layers are apart, by the paper's modulus [N]."""
    gap = (braid.layer_diameters[1] - braid.layer_diameters[0]) / 2
    return stiffness(Spread().modulus, gap)
