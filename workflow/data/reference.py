"""Force maps of real muscles, the manufacturer's and measured ones.

Sources: config/reference/SOURCES.md. A muscle of a study is compared with those that are its own,
which its key ``reference`` names.

Between its points a map is interpolated: by monotone cubics (PCHIP) in contraction at each
tabulated pressure, then linearly in pressure. Nothing is extrapolated:
outside its points a map is NaN.
"""

import csv
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from workflow.study.schema import FORCE_MAPS

FOLDER = Path(__file__).parents[2] / "config" / "reference"
DATA = ("config/reference/*.csv",)
SMALL = 0.1  # share of a curve's largest force below which a relative deviation means nothing
DENSE = np.linspace(0, 0.2, 201)  # contractions among which a map has its largest force
CONTRACTIONS = (0.0, 0.05, 0.1, 0.15, 0.2)  # at which curves are compared with a map
SAME = 1e-9  # two pressures [MPa] or contractions this close are one

Points = NDArray[np.float64]  # (point, 3): pressure [MPa], contraction [1], force [N]


@dataclass(frozen=True, eq=False)
class ForceMap:
    """Force against contraction and pressure.

    Attributes
    ----------
    name : as in the dataset
    label : as in figures
    points : what is interpolated: pressure [MPa], contraction [1], force [N]
    suspect : points of the source that are not used, same columns
    """

    name: str
    label: str
    points: Points
    suspect: Points

    @cached_property
    def pressures(self) -> NDArray[np.float64]:
        """Tabulated pressures, rising [MPa]."""
        return np.unique(self.points[:, 0])

    def contractions(self, pressure: float) -> NDArray[np.float64]:
        """Contractions tabulated at a pressure, or at both tabulated pressures around it."""
        around = self._around(pressure)
        if around is None:
            return np.array([])
        below, above, _ = around
        return np.intersect1d(self._curve_points(below)[0], self._curve_points(above)[0])

    def force(self, contraction: ArrayLike, pressure: float) -> NDArray[np.float64]:
        """Interpolated force [N]; NaN outside the map."""
        contraction = np.asarray(contraction, dtype=float)
        around = self._around(pressure)
        if around is None:
            return np.full(contraction.shape, np.nan)
        below, above, share = around
        low, high = self._known(below), self._known(above)
        return (1 - share) * low(contraction) + share * high(contraction)

    def inside(self, contraction: ArrayLike, pressure: float) -> NDArray[np.bool_]:
        """Which states the map says something of."""
        contraction = np.asarray(contraction, dtype=float)
        around = self._around(pressure)
        if around is None:
            return np.zeros(contraction.shape, dtype=bool)
        ends = [self._curve_points(p)[0][[0, -1]] for p in around[:2]]
        low, high = np.max(ends, axis=0)[0], np.min(ends, axis=0)[1]
        found: NDArray[np.bool_] = (contraction >= low) & (contraction <= high)
        return found

    def _around(self, pressure: float) -> tuple[float, float, float] | None:
        """The tabulated pressures below and above (one and the same on a tabulated one), share.

        None beyond the map.
        """
        near = np.abs(self.pressures - pressure) <= SAME
        if near.any():
            same = float(self.pressures[near][0])
            return same, same, 0.0
        place = int(np.searchsorted(self.pressures, pressure))
        if place in (0, self.pressures.size):
            return None
        below, above = map(float, self.pressures[place - 1 : place + 1])
        return below, above, (pressure - below) / (above - below)

    def _curve_points(self, pressure: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        points = self.points[self.points[:, 0] == pressure]
        points = points[np.argsort(points[:, 1])]
        return points[:, 1], points[:, 2]

    @cached_property
    def _curves(self) -> dict[float, Callable[[NDArray[np.float64]], NDArray[np.float64]]]:
        """Those that have been asked for, by tabulated pressure."""
        return {}

    def _known(self, pressure: float) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
        if pressure not in self._curves:
            self._curves[pressure] = self._curve(pressure)
        return self._curves[pressure]

    def _curve(self, pressure: float) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
        """Force against contraction at a tabulated pressure; a single point is no curve."""
        from scipy.interpolate import PchipInterpolator  # late: it takes a second to import

        contraction, force = self._curve_points(pressure)
        if contraction.size < 2:
            return lambda values: np.where(
                np.abs(values - contraction[0]) <= SAME, force[0], np.nan
            )
        curve: Callable[[Points], Points] = PchipInterpolator(contraction, force, extrapolate=False)
        return curve


def musclesim() -> ForceMap:
    """The manufacturer's map; the point marked suspect is not used."""
    rows = _rows("festo_musclesim_dmsp20.csv")
    points = {
        flag: [
            (float(row["pressure_MPa"]), float(row["contraction"]), float(row["force_N"]))
            for row in rows
            if row["suspect"] == flag
        ]
        for flag in ("0", "1")
    }
    return ForceMap(
        "festo_musclesim", "Festo MuscleSIM", _points(points["0"]), _points(points["1"])
    )


def martens2017() -> ForceMap:
    """The map that was measured on DMSP-20-300."""
    return _by_length("martens2017", "martens2017_dmsp20_300_measured.csv", 300.0)


def martens2017_dmsp10() -> ForceMap:
    """The map that was measured on DMSP-10-250."""
    return _by_length("martens2017_dmsp10", "martens2017_dmsp10_250_measured.csv", 250.0)


def _by_length(name: str, file: str, length: float) -> ForceMap:
    """A map of a muscle of a length [mm]; a force of 0 means that it was slack and is no force."""
    points = [
        (
            float(row["pressure_MPa"]),
            round(1 - float(row["length_mm"]) / length, 12),
            float(row["force_N"]),
        )
        for row in _rows(file)
        if float(row["force_N"]) != 0
    ]
    return ForceMap(name, "Martens & Boblan 2017", _points(points), _points([]))


def musclesim_dmsp40() -> ForceMap:
    """The manufacturer's map of DMSP-40."""
    return _plain("festo_musclesim_dmsp40", "Festo MuscleSIM", "festo_musclesim_dmsp40.csv")


def sarosi2012() -> ForceMap:
    """A function fitted to what was measured on DMSP-20-200."""
    return _plain("sarosi2012", "Sárosi 2012", "sarosi2012_dmsp20_200_fit.csv")


def _plain(name: str, label: str, file: str) -> ForceMap:
    points = [
        (float(row["pressure_MPa"]), float(row["contraction"]), float(row["force_N"]))
        for row in _rows(file)
    ]
    return ForceMap(name, label, _points(points), _points([]))


# How each is read, when it is asked for.
MAPS: dict[str, Callable[[], ForceMap]] = dict(
    zip(
        FORCE_MAPS,
        (musclesim_dmsp40, martens2017_dmsp10, sarosi2012, musclesim, martens2017),
        strict=True,
    )
)


def load(names: Iterable[str] = FORCE_MAPS) -> dict[str, ForceMap]:
    """Maps by name; all there are, if none is named."""
    return {name: _read(name) for name in names}


@cache
def _read(name: str) -> ForceMap:
    """A map, read once: many muscles may name it."""
    return MAPS[name]()


def relative_deviation(
    found: ForceMap, contraction: ArrayLike, pressure: float, force: ArrayLike
) -> NDArray[np.float64]:
    """(F - Fref) / |Fref| along a curve of constant pressure; NaN outside the map and if small."""
    expected = found.force(contraction, pressure)
    small = is_small(found, contraction, pressure)
    return (np.asarray(force, dtype=float) - expected) / np.where(small, np.nan, np.abs(expected))


def is_small(found: ForceMap, contraction: ArrayLike, pressure: float) -> NDArray[np.bool_]:
    """Where a map is at most a tenth of its largest force: a ratio to that says nothing."""
    return found.force(contraction, pressure) <= SMALL * largest_force(found, pressure)


def largest_force(found: ForceMap, pressure: float) -> float:
    """Largest force of a map at a pressure, contractions 0 to 20 %; NaN if it has none [N]."""
    force = found.force(DENSE, pressure)
    return float(np.nanmax(force)) if np.isfinite(force).any() else np.nan


def _rows(file: str) -> list[dict[str, str]]:
    with (FOLDER / file).open(newline="") as stream:
        return list(csv.DictReader(stream))


def _points(rows: list[tuple[float, float, float]]) -> Points:
    return np.array(rows, dtype=float).reshape(-1, 3)
