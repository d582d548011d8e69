"""Measured points of a calibration, as they were measured, and the forces of a model at them.

A model is solved along the curves that were set (workflow/data/bench.py), at the points themselves
or, of a time series, at some places among them, between which there are cubics by the recorded
derivatives. What a point is off its setting (0.3028 MPa of 0.3) is made up for by the other one.
"""

from collections.abc import Collection, Mapping, Sequence

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline

from solver.load_path import CONTRACTION_LIMITS, LoadPath, PathKind
from solver.numerics import Numerics
from workflow.analyses.calibration.forward_model import ForwardModel
from workflow.data import bench
from workflow.data.bench import SetCurve
from workflow.data.reference import SAME, ForceMap
from workflow.data.states import GOOD, STOP

MOST = 41  # places of a curve at which a model is solved
DECIMALS = 9  # of a place
LIMITS = {"contraction": CONTRACTION_LIMITS, "pressure": (0.0, np.inf)}
Array = NDArray[np.float64]


class Points:
    """The points of some curves.

    Attributes
    ----------
    table : one row per point: pressure [MPa], contraction [1], measured [N], set_at (MPa or 1)
    """

    def __init__(self, curves: Sequence[SetCurve]) -> None:
        self.curves = curves
        frames = [
            pd.DataFrame(curve.points, columns=["pressure", "contraction", "measured"]).assign(
                held=curve.kind.value, set_at=curve.at
            )
            for curve in curves
        ]
        self.table = pd.concat(frames, ignore_index=True)

    @classmethod
    def of(cls, found: ForceMap) -> "Points":
        """All points of a map or file."""
        return cls(bench.set_curves(found))

    def measured(self) -> Array:
        """Forces [N]."""
        return np.asarray(self.table["measured"])

    def near(self, pressures: Collection[float]) -> NDArray[np.bool_]:
        """Which points are of some pressures: of curves set at them, or measured there."""
        at = self.table["set_at"].where(
            self.table["held"] == PathKind.ISOBARIC.value, self.table["pressure"]
        )
        every = np.abs(at.to_numpy()[:, None] - np.array(list(pressures), ndmin=2)) <= SAME
        return np.asarray(every.any(axis=1))

    def computed(
        self,
        forward: ForwardModel,
        values: Mapping[str, float],
        model: str,
        numerics: Numerics | None = None,
    ) -> Array:
        """Forces of a model at the points [N]; NaN where it has no valid state."""
        return np.concatenate(
            [_along(curve, forward, values, model, numerics) for curve in self.curves]
        )


def _along(
    curve: SetCurve,
    forward: ForwardModel,
    values: Mapping[str, float],
    model: str,
    numerics: Numerics | None,
) -> Array:
    """Forces at the points of one curve."""
    pressure, contraction = curve.points[:, 0], curve.points[:, 1]
    length = forward.muscle.muscle.length
    of_pressure = curve.kind is PathKind.ISOBARIC
    along, across = (contraction, pressure) if of_pressure else (pressure, contraction)
    low, high = LIMITS[curve.kind.swept.key]
    places = np.unique(np.round(np.clip(along, low, high), DECIMALS))
    if places.size > MOST:
        places = np.round(np.linspace(places[0], places[-1], MOST), DECIMALS)
    set_at = max(curve.at, 0.0) if of_pressure else curve.at  # a gauge may show less than none
    path = LoadPath(kind=curve.kind, held=set_at, stops=tuple(places.tolist()))
    rows = forward.along(values, model, path, numerics)
    rows = rows[(rows["point"] == STOP) & (rows["status"] == GOOD)]
    if rows.empty:
        return np.full(along.size, np.nan)
    by_contraction = -length * rows["stiffness"].to_numpy()
    by_pressure = rows["force_by_pressure"].to_numpy()
    slope, other = (by_contraction, by_pressure) if of_pressure else (by_pressure, by_contraction)
    at, force = rows[curve.kind.swept.key].to_numpy(), rows["force"].to_numpy()
    known = np.isin(np.round(along, DECIMALS), np.round(at, DECIMALS))
    if at.size > 1:
        cubic = CubicHermiteSpline(at, force, slope)
        between = np.interp(along, places, np.isin(places, np.round(at, DECIMALS))) == 1
        known |= between & (along >= at[0]) & (along <= at[-1])
        found = cubic(along)
    else:
        found = np.full(along.size, force[0])
    found += np.interp(along, at, other) * (across - set_at)
    return np.asarray(np.where(known, found, np.nan))
