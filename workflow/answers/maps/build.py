"""Making a map: curves at held pressures, more of them where the force bends, and its error.

Every curve is a case like any other. A pressure is put between two where a curve solved there is
further from the map without it than the tolerance, at states that pull; so the grid is refined at
the pressure at which threads become taut. Contractions are halved all together in the same way.
The error is then measured at states off the grid.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from solver.load_path import LoadPath, PathKind
from solver.record import Solution
from solver.status import VALID, StateStatus
from workflow.answers.maps.table import FORCE, PARTS, VOLUME, Map
from workflow.answers.store import Store
from workflow.plan import model_choice
from workflow.study.contents import Study
from workflow.study.schema import MapEntry

Array = NDArray[np.float64]
CLOSEST, FINEST = 0.0025, 0.0025  # MPa and contraction, between neighbours of the grid
MOST = 200  # pressures
NEAR = 0.02  # MPa: what lies so close to the threshold is judged by another tolerance
OF_NEAR = 5.0  # times the tolerance
SHARE_NEAR = 1 / 3  # of the states at which the error is measured
DECIMALS = 6


@dataclass(frozen=True, eq=False)
class Checked:
    """A map, and its error at states off its grid.

    Attributes
    ----------
    states : one row per state: pressure, contraction, force by the map and by the solver [N],
        whether it is near the threshold
    error, error_near : largest error of the force [N], away from the threshold and near it
    error_inverse : largest error of the pressure for a force [MPa]
    solves : cases that had to be solved
    """

    map: Map
    states: Array
    error: float
    error_near: float
    error_inverse: float
    solves: int


class Builder:
    """The map of an entry of a study."""

    def __init__(self, study: Study, name: str, store: Store | None = None) -> None:
        self.entry: MapEntry = study.maps[name]
        self.study, self.studied = study, study.muscles[self.entry.muscle]
        self.variant = study.variants[self.entry.variant]
        self.store = store or Store(study)
        self.contraction = np.array(self.entry.contraction)
        self._curves: dict[float, Solution] = {}

    def built(self) -> Checked:
        """The map and its error."""
        for pressure in self.entry.pressure:
            self._solve(pressure)
        self._halve_contractions()
        intervals = list(pairwise(sorted(self._curves)))
        while intervals and len(self._curves) < MOST:
            low, high = intervals.pop()
            middle = round((low + high) / 2, DECIMALS)
            if high - low < 2 * CLOSEST:
                continue
            before = self.map()
            self._solve(middle)
            if self._off(before, middle) > self.entry.tolerance:
                intervals += [(low, middle), (middle, high)]
        return self._checked(self.map())

    def _halve_contractions(self) -> None:
        """Put contractions between those of the grid, as long as that changes what pulls."""
        while float(np.max(np.diff(self.contraction))) >= 2 * FINEST:
            before, coarse = self.map(), self.contraction
            middles = np.round((coarse[1:] + coarse[:-1]) / 2, DECIMALS)
            self.contraction = np.sort([*coarse, *middles])
            for pressure in self._curves:
                self._solve(pressure)
            if max(self._off(before, p) for p in self._curves) <= self.entry.tolerance:
                return

    def map(self) -> Map:
        """The map of the curves that there are."""
        pressures = np.array(sorted(self._curves))
        states = [self._curves[p].states for p in pressures]
        valid = np.array([self._valid(self._curves[p]) for p in pressures])
        length = self.studied.muscle.length

        def table(name: str) -> Array:
            return _filled(np.array([found[name][: self.contraction.size] for found in states]))

        by_pressure = table("force_by_pressure")
        tables = {
            FORCE: table("force"),
            f"{FORCE}_by_pressure": by_pressure,
            f"{FORCE}_by_contraction": -length * table("stiffness"),
            VOLUME: table("volume"),
            f"{VOLUME}_by_pressure": table("volume_by_pressure"),
            f"{VOLUME}_by_contraction": length * by_pressure,
        }
        for quantity in (FORCE, VOLUME):
            tables[quantity + PARTS[3]] = self._slopes(tables[f"{quantity}_by_pressure"])
        model = self.entry.model
        return Map(self.entry.muscle, model, length, pressures, self.contraction, tables, valid)

    def _slopes(self, rows: Array) -> Array:
        """Derivatives along the contraction, that do not overshoot where a row bends."""
        from scipy.interpolate import PchipInterpolator

        e = self.contraction
        return np.array([PchipInterpolator(e, row).derivative()(e) for row in rows])

    def _path(self, pressure: float, stops: tuple[float, ...]) -> LoadPath:
        return LoadPath(kind=PathKind.ISOBARIC, held=pressure, stops=stops)

    def _solution(self, path: LoadPath) -> Solution:
        effects = model_choice.readable(self.entry.model, self.variant.effects)
        case = self.studied.case(
            path, self.entry.model, effects=effects, numerics=self.variant.numerics
        )
        return self.store.solution(case)

    def _solve(self, pressure: float) -> None:
        """The curve at a pressure."""
        stops = tuple(map(float, self.contraction))
        self._curves[pressure] = self._solution(self._path(pressure, stops))

    def _valid(self, solution: Solution) -> NDArray[np.bool_]:
        status: list[StateStatus] = solution.state_status[: self.contraction.size]
        return np.array([each in VALID for each in status])

    def _off(self, before: Map, pressure: float) -> float:
        """By how much a map misses the states of a curve that pull [N].

        Near the threshold, where the force bends, ``OF_NEAR`` times as much counts as one.
        """
        found = self._curves[pressure]
        force, slope = (found.states[n] for n in ("force", "force_by_pressure"))
        pulls = self._valid(found) & (force > 0)
        off = np.abs(before(FORCE, pressure, self.contraction) - force)
        off = np.where(force < NEAR * slope, off / OF_NEAR, off)[pulls]
        return float(np.max(off[np.isfinite(off)], initial=0.0))

    def _checked(self, made: Map) -> Checked:
        """The error at random states between those of the grid, some near the threshold."""
        rng = np.random.default_rng(self.entry.seed)
        rows: list[tuple[float, ...]] = []
        inverse = [0.0]
        for number in range(self.entry.checks):
            near = number < SHARE_NEAR * self.entry.checks
            state = self._somewhere(made, rng, near)
            if state is None:
                continue
            pressure, contraction = state
            solution = self._solution(self._path(pressure, (contraction,)))
            force = float(solution.states["force"][0])
            if solution.state_status[0] not in VALID or not force > 0:
                continue
            by_map = float(made(FORCE, pressure, contraction))
            rows.append((pressure, contraction, by_map, force, float(near)))
            if not near:
                inverse.append(abs(made.pressure_for(force, contraction) - pressure))
        states = np.array(rows).reshape(-1, 5)
        off, close = np.abs(states[:, 2] - states[:, 3]), states[:, 4] > 0
        return Checked(
            made,
            states,
            float(np.max(off[~close], initial=0.0)),
            float(np.max(off[close], initial=0.0)),
            float(np.max(inverse)),
            sum(self.store.solves.values()),
        )

    def _somewhere(
        self, made: Map, rng: np.random.Generator, near: bool
    ) -> tuple[float, float] | None:
        """A random state that pulls; within ``NEAR`` of its threshold, or not."""
        for _ in range(1000):
            contraction = round(float(rng.uniform(*made.contraction[[0, -1]])), DECIMALS)
            threshold = made.pressure_for(1e-6, contraction)
            if near:
                if not np.isfinite(threshold):
                    continue
                pressure = round(threshold + float(rng.uniform(0, NEAR)), DECIMALS)
            else:
                pressure = round(float(rng.uniform(*made.pressure[[0, -1]])), DECIMALS)
                if np.isfinite(threshold) and pressure < threshold + NEAR:
                    continue
            if made.is_valid(pressure, contraction) and made(FORCE, pressure, contraction) > 0:
                return pressure, contraction
        return None


def _filled(table: Array) -> Array:
    """The table with the nearest value along the contraction where there is none: masked anyway."""
    found = table.copy()
    for row in found:
        known = np.flatnonzero(np.isfinite(row))
        if known.size:
            row[:] = np.interp(np.arange(row.size), known, row[known])
        else:
            row[:] = 0.0
    return found
