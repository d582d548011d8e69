"""Fits of a study: to all measured points, or at some pressures, and judged at others.

Without a ``fit_pressure`` what is fitted are the measured points, as they were measured, of all
pressures but those of ``report_pressure``; intervals include the error of the model itself, by the
fullest one on the ladder of the planner. Points at which there is no state are left out, and said.

With it the forces of a map at these pressures are fitted, contractions 0 to 20 %: at the map's own
points, or, if these are few, also at the states of workflow/data/deviation.py between them, and
between its pressures where it has none there. Intervals are then of the scatter alone and on the
small side, as what stands between points is no measurement of its own.

Either is compared with the map at all its pressures by the rule of deviation.py: by the model of
the fit, and by the solid, which shows whether that model was good enough.
"""

import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from geometry.muscle import Braid
from solver.numerics import Numerics, Spread
from workflow.analyses.calibration.fit import (
    Fitted,
    Forces,
    Parameter,
    fit,
    fit_by_imperfect_model,
)
from workflow.analyses.calibration.forward_model import ForwardModel, shape_of
from workflow.analyses.calibration.points import Points
from workflow.data import bench, deviation
from workflow.data.reference import CONTRACTIONS, SAME, ForceMap
from workflow.plan.effect_costs import MESHES
from workflow.plan.model_choice import RUNGS
from workflow.study.contents import StudiedMuscle, Study
from workflow.study.errors import StudyError
from workflow.study.fit import stiffness
from workflow.study.schema import SHAPES, CalibrationEntry

CHECK = "solid"
UNITS = {"angle": "degree", "wall_thickness": "mm", "layer_radius": "mm"}
COARSE = 0.01  # relative step of a size: a mesh may have another element for a smaller one
REPORTED = (0.2, 0.4, 0.6)  # MPa, beside a fit_pressure, where nobody says at which
NOT_ASKED = "not asked for"


@dataclass(frozen=True)
class Calibration:
    """What a fit has given.

    Attributes
    ----------
    fitted : the values
    deviations : one row per pressure, model and state of the values (``before``, ``after``)
    states : the forces behind them, and the map's
    residuals : one row per measured point, with the force of the fitted muscle
    """

    name: str
    entry: CalibrationEntry
    fitted: list[Fitted]
    deviations: pd.DataFrame
    states: pd.DataFrame
    residuals: pd.DataFrame

    @property
    def says_nothing(self) -> bool:
        """Whether one of its values is no answer: left open by the data, or stopped by a bound."""
        return any(f.at_bound or f.says_nothing for f in self.fitted)

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
    points = Points.of(found)
    with tempfile.TemporaryDirectory() as folder:
        forward = ForwardModel(study, muscle, Path(folder))
        parameters = _parameters(entry, muscle)
        try:
            if entry.fit_pressure is not None:
                fitted = fit(parameters, _residuals(name, entry, found, forward))
                at = points.table["contraction"].to_numpy()
                used = points.near(entry.fit_pressure) & (at >= 0) & (at <= bench.FURTHEST)
            else:
                used = _usable(name, entry, points, forward)
                of_points = _of_points(entry, points, used, forward)
                fitted = fit_by_imperfect_model(parameters, *of_points)
        except ValueError as error:
            raise StudyError(f"calibration.{name}: {error}") from None
        result = Calibration(name, entry, fitted, *[pd.DataFrame()] * 3)
        states = _states(result, found, forward)
        residuals = _at_points(result, points, used, forward)
    return replace(
        result, deviations=_deviations(result, states), states=states, residuals=residuals
    )


def _parameters(entry: CalibrationEntry, muscle: StudiedMuscle) -> list[Parameter]:
    assert muscle.thread is not None  # the check of a study refuses a bare tube
    start = {"thread_stiffness": muscle.thread.stiffness} | muscle.rubber.values()
    units = {"thread_stiffness": "N"} | {p.name: p.unit for p in muscle.rubber.parameters()}
    found = []
    for key in entry.fit:
        if key in SHAPES:
            at, off = shape_of(muscle.muscle)[key], getattr(entry.tolerance, key)
            found.append(Parameter(key, UNITS[key], at, at - off, at + off, off, COARSE))
        else:
            found.append(Parameter(key, units[key], start[key], *getattr(entry.bounds, key)))
    return found


def _usable(
    name: str, entry: CalibrationEntry, points: Points, forward: ForwardModel
) -> NDArray[np.bool_]:
    """Which points are fitted: all but those held out, where both models have a state."""
    used = ~points.near(entry.report_pressure or ())
    if not used.any():
        raise StudyError(
            f"calibration.{name}.report_pressure: no force of {entry.reference} is left to fit"
        )
    used &= np.isfinite(points.computed(forward, {}, entry.model))
    used &= np.isfinite(_by_fullest(points, forward, {}))
    if not used.any():
        raise StudyError(
            f"calibration.{name}: {entry.model} has no valid state at any force of "
            f"{entry.reference}"
        )
    return used


def _by_fullest(
    points: Points, forward: ForwardModel, values: Mapping[str, float]
) -> NDArray[np.float64]:
    """Forces by the top of the planner's ladder of models, on its mesh."""
    top = next(rung for rung in RUNGS.values() if rung.above is None)
    numerics: Numerics = replace(forward.variant.numerics, **MESHES[top.mesh])
    return points.computed(forward, values, top.model, numerics)


def _of_points(
    entry: CalibrationEntry, points: Points, used: NDArray[np.bool_], forward: ForwardModel
) -> tuple[Forces, Forces]:
    """Functions of the values at the points that are fitted: residuals, and the model's error."""
    measured = points.measured()[used]
    large = float(np.max(np.abs(measured)))

    def residuals(values: Mapping[str, float]) -> NDArray[np.float64]:
        force = points.computed(forward, values, entry.model)[used]
        # where there is no state any more the residual is as large as the largest force
        return np.nan_to_num(force - measured, nan=large)

    def errors(values: Mapping[str, float]) -> NDArray[np.float64]:
        force = points.computed(forward, values, entry.model)[used]
        return np.nan_to_num(_by_fullest(points, forward, values)[used] - force)

    return residuals, errors


def _residuals(
    name: str, entry: CalibrationEntry, found: ForceMap, forward: ForwardModel
) -> Forces:
    """Function of the values: forces minus those of the map, at the fitted pressures [N]."""
    wanted: dict[float, tuple[NDArray[np.float64], NDArray[np.float64]]] = {}
    for pressure in entry.fit_pressure or ():
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


def _at_points(
    result: Calibration, points: Points, used: NDArray[np.bool_], forward: ForwardModel
) -> pd.DataFrame:
    """Every measured point with the force of the fitted muscle, and why it was not fitted."""
    entry = result.entry
    force = points.computed(forward, result.values, entry.model)
    chosen = entry.fit_pressure is not None
    held_out = ~used if chosen else points.near(entry.report_pressure or ())
    why = np.where(used, "", np.where(held_out, NOT_ASKED, f"no valid state by {entry.model}"))
    return points.table.assign(force=force, fitted=used.astype(int), why=why).assign(
        residual=lambda rows: rows["force"] - rows["measured"]
    )


def _states(result: Calibration, found: ForceMap, forward: ForwardModel) -> pd.DataFrame:
    """Forces before and after at the states of the rule, and those of the map."""
    entry, frames = result.entry, []
    fitted, reported = _pressures(entry, found)
    for when, values, model in (
        ("before", {}, entry.model),
        ("after", result.values, entry.model),
        ("after", result.values, CHECK),
    ):
        for pressure in sorted({*fitted, *reported}):
            computed = forward.states(values, model, pressure, CONTRACTIONS)
            rows = deviation.states(found, computed)
            role = "fit" if pressure in fitted else "report"
            frames.append(rows.assign(values=when, model=model, role=role))
    return pd.concat(frames, ignore_index=True).drop_duplicates(
        ["values", "model", "pressure", "contraction"]
    )


def _pressures(
    entry: CalibrationEntry, found: ForceMap
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Pressures at which a map is compared [MPa]: of the fit, and others."""
    if entry.fit_pressure is not None:
        reported = REPORTED if entry.report_pressure is None else entry.report_pressure
        return entry.fit_pressure, reported
    reported = entry.report_pressure or ()
    own = [float(p) for p in found.pressures if p > 0]
    return tuple(p for p in own if all(abs(p - r) > SAME for r in reported)), reported


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
    entry = result.entry
    muscle = study.muscles[entry.muscle]
    of_fit = of_points(result, study)
    return pd.DataFrame(
        {
            "calibration": result.name,
            "muscle": entry.muscle,
            "reference": entry.reference,
            "parameter": f.parameter.name,
            "unit": f.parameter.unit,
            "before": f.parameter.start,
            "fitted": f.value,
            "low_95": f.low,
            "high_95": f.high,
            "note": "; ".join(filter(None, [note(f, muscle), of_fit])),
            "usable": int(not result.says_nothing),
        }
        for f in result.fitted
    )


def of_points(result: Calibration, study: Study) -> str:
    """What to know of the forces that were fitted: which are left out, and which were made."""
    entry, said = result.entry, []
    assert entry.reference is not None
    found = bench.read(entry.reference, study.muscles[entry.muscle].muscle.length)
    for pressure in entry.fit_pressure or ():
        if np.min(np.abs(found.pressures - pressure)) > SAME:
            said.append(f"at {pressure:g} MPa between the pressures of {entry.reference}")
    if entry.fit_pressure is None:
        left = result.residuals.loc[result.residuals["fitted"] == 0, "why"]
        said += [
            f"{count} of {len(result.residuals)} measured points not fitted: {why}"
            for why, count in left.value_counts(sort=False).items()
        ]
    return "; ".join(said)


def note(fitted: Fitted, muscle: StudiedMuscle) -> str:
    """What stands against taking a value for the property of a material."""
    said = []
    if fitted.at_bound:
        by = "its tolerance" if fitted.parameter.tolerance else "its bound"
        said.append(f"stopped by {by}, not by the data")
    if fitted.says_nothing:
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
