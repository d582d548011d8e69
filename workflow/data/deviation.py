"""How far computed curves are from the reference maps: ``results/tables/deviation.csv``.

The rule, for every model, pressure and map: contractions of 0 to 20 % in steps of 5 % as far as the
map goes, its suspect point dropped and its slack zeros left out (config/reference/SOURCES.md). Two
measures, because near the free contraction the reference is a small force: (F - Fref) / |Fref|
where Fref is more than a tenth of its curve's largest, and (F - Fref) / Fmax everywhere, Fmax the
largest Fref of the curve. Between its points a map has to be interpolated; three other reasonable
ways show how much a mean depends on that.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from solver.load_path import PathKind
from solver.models import MODELS
from workflow.data.reference import (
    CONTRACTIONS,
    ForceMap,
    is_small,
    largest_force,
    relative_deviation,
)
from workflow.data.states import GOOD, STOP, Table

RULE = "pchip"  # the interpolation of the rule
ALL = "all"  # in place of a pressure: the mean over all states of all pressures
RELATIVE, SHARE = "(F - Fref) / |Fref|", "(F - Fref) / Fmax"


@dataclass(frozen=True, eq=False)
class _Akima(ForceMap):
    """Akima's splines in contraction instead of monotone cubics."""

    def _curve(self, pressure: float) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
        from scipy.interpolate import Akima1DInterpolator

        contraction, force = self._curve_points(pressure)
        if contraction.size < 3:
            return super()._curve(pressure)
        curve: Callable[[NDArray[np.float64]], NDArray[np.float64]] = Akima1DInterpolator(
            contraction, force, method="makima", extrapolate=False
        )
        return curve


@dataclass(frozen=True, eq=False)
class _Linear(ForceMap):
    """Straight lines in contraction."""

    def _curve(self, pressure: float) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
        contraction, force = self._curve_points(pressure)
        return lambda values: np.interp(values, contraction, force, left=np.nan, right=np.nan)


@dataclass(frozen=True, eq=False)
class _Surface(ForceMap):
    """A smooth surface: the polynomial p^i e^j, i <= 1, j <= 4, that fits all points best.

    Linear in pressure as Eq. (1) is. It evens out the errors of single points, and whatever of a
    curve is no polynomial. Points of no pressure or of an extended muscle are not fitted.
    """

    def force(self, contraction: ArrayLike, pressure: float) -> NDArray[np.float64]:
        """Force of the surface [N]; NaN where the map itself has none."""
        contraction = np.asarray(contraction, dtype=float)
        smooth = _terms(np.full(contraction.shape, pressure), contraction) @ self._fitted
        return np.where(np.isfinite(super().force(contraction, pressure)), smooth, np.nan)

    @cached_property
    def _fitted(self) -> NDArray[np.float64]:
        p, e, force = self.points[(self.points[:, 0] > 0) & (self.points[:, 1] >= 0)].T
        return np.asarray(np.linalg.lstsq(_terms(p, e), force, rcond=None)[0])


def _terms(p: NDArray[np.float64], e: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.stack([p**i * e**j for i in range(2) for j in range(5)], axis=-1)


INTERPOLATIONS: dict[str, type[ForceMap]] = {
    RULE: ForceMap,
    "linear": _Linear,
    "akima": _Akima,
    "surface": _Surface,
}


def interpolated(found: ForceMap, how: str) -> ForceMap:
    """A map that is interpolated in another way."""
    return INTERPOLATIONS[how](found.name, found.label, found.points, found.suspect)


def states(found: ForceMap, rows: pd.DataFrame) -> pd.DataFrame:
    """All states of the rule of some isobaric curves, one for each pressure.

    ``rows`` are theirs in the table of states. Columns: pressure, contraction, force, reference,
    both deviations; NaN where there is none, and ``left_out`` says why.
    """
    frames = []
    rows = rows[rows["point"] == STOP]
    for pressure, curve in rows.groupby("pressure"):
        expected = found.force(CONTRACTIONS, float(pressure))
        good = curve[curve["status"] == GOOD].set_index("contraction")
        value = good["force"].reindex(CONTRACTIONS).to_numpy()
        small = is_small(found, CONTRACTIONS, float(pressure))
        why = np.where(small, "small reference", "")
        why = np.where(np.isfinite(value), why, "not solved")
        why = np.where(np.isfinite(expected), why, "outside the map")
        columns = {
            "pressure": pressure,
            "contraction": CONTRACTIONS,
            "force": value,
            "reference": expected,
            RELATIVE: relative_deviation(found, CONTRACTIONS, float(pressure), value),
            SHARE: (value - expected) / largest_force(found, float(pressure)),
            "left_out": why,
        }
        frames.append(pd.DataFrame(columns))
    return pd.concat(frames, ignore_index=True)


def summary(rows: pd.DataFrame) -> dict[str, float]:
    """Means, largest (signed) deviations, and what was left out of some states."""
    relative, share = rows[RELATIVE].dropna(), rows[SHARE].dropna()
    return {
        "mean_relative [1]": relative.mean(),
        "largest_relative [1]": _largest(relative),
        "states_relative": len(relative),
        "mean_of_largest_force [1]": share.mean(),
        "largest_of_largest_force [1]": _largest(share),
        "mean_absolute_of_largest_force [1]": share.abs().mean(),
        "states": len(share),
        "left_out_outside_the_map": int((rows["left_out"] == "outside the map").sum()),
        "left_out_small_reference": int((rows["left_out"] == "small reference").sum()),
        "left_out_not_solved": int((rows["left_out"] == "not solved").sum()),
    }


def _largest(values: pd.Series) -> float:
    return float(values.loc[values.abs().idxmax()]) if len(values) else np.nan


def table(found: Table, maps: Mapping[str, Mapping[str, ForceMap]]) -> pd.DataFrame:
    """Deviations of all isobaric curves of the muscles that have ``maps`` of their own.

    At each pressure and over all of them.
    """
    curves = found.curves
    compared = found.part((curves["path"] == PathKind.ISOBARIC) & curves["muscle"].isin(maps))
    ways = {
        muscle: [
            (name, how, interpolated(reference, how))
            for name, reference in its.items()
            for how in INTERPOLATIONS
        ]
        for muscle, its in maps.items()
    }
    rows = [
        {"model": model, "muscle": muscle, "variant": variant, "reference": name}
        | {"interpolation": how, "pressure [MPa]": pressure, **values}
        for (muscle, model, variant), of_curves in sorted(
            compared.joined().groupby(["muscle", "model", "variant"]), key=_order
        )
        for name, how, reference in ways[muscle]
        for pressure, values in _by_pressure(states(reference, of_curves))
    ]
    return pd.DataFrame(rows)


def _order(group: tuple[Any, pd.DataFrame]) -> tuple[Any, ...]:
    """By muscle, model and variant, the default first."""
    muscle, model, variant = group[0]
    return muscle, MODELS[model].rank, variant != "default", variant


def _by_pressure(rows: pd.DataFrame) -> Iterator[tuple[float | str, dict[str, float]]]:
    for pressure, found in rows.groupby("pressure"):
        yield float(str(pressure)), summary(found)
    yield ALL, summary(rows)
