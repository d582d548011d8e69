"""The state of zero force on a curve: where it is looked for, how, and what its absence means.

On the curve one control is held and another swept, x. g is the force with the sign that lets it
rise at the zero that is wanted: F over pressure (the threshold pressure, dF/dp > 0), -F over
contraction (the free contraction, dF/dl > 0). The zero lies in the lowest interval between states
of the curve in which g rises from below to above it; a state whose force is 1e-6 of the largest is
one. Where g has one sign at both ends of an interval and its slopes say that it turns towards zero
between them, its extremum is looked at; where all that finds none, the states of the curve are
joined by small steps. What the stops do not enclose is looked for beyond
them: pressures from none to ten times what the rubber alone can bear at its length (or the highest
stop), contractions within CONTRACTION_LIMITS, as far as there are states.

Without pressure a muscle rests at its own length, and a shortened one does not pull: if it does
so in the model, only the smoothing of the slack law does. Then the answer is none, and says so.
A wall that has crumpled under threads that push may pull there; that is no answer.

``find`` is for models in Python; solver/path/zero.idp is its twin.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from geometry.readable import plain
from solver.case import Case
from solver.effects import Rubber, ThreadLaw
from solver.load_path import CONTRACTION_LIMITS, Control
from solver.status import StateStatus

SHARE = 1e-6  # of the largest force: as good as none
CONTRACTION_STEP = 0.05
PRESSURES = 10.0  # times the limit pressure of the rubber: the highest that is tried
TRIALS = 100  # states at most
SAME = 1e-9  # difference of x, as a share of its size
ROUNDING = 1e-12  # the same of what is as good as zero
Position = TypeVar("Position")


@dataclass(frozen=True)
class Search:
    """Where to look: the controls of a curve, and the range of the one that is swept."""

    held: Control
    still: float
    swept: Control
    low: float
    high: float
    step: float  # the first from zero, of pressure; every one, of contraction
    threads_push: bool = False

    @classmethod
    def of(cls, case: Case) -> "Search":
        """For the curve of a case."""
        path = case.path
        held, swept = path.kind.held, path.kind.swept
        if swept is Control.CONTRACTION:
            return cls(held, path.held, swept, *CONTRACTION_LIMITS, CONTRACTION_STEP)
        limit = limit_pressure(case)
        high = max(PRESSURES * limit, path.stops[-1])
        pushing = case.effects.threads is ThreadLaw.TWO_WAY
        return cls(held, path.held, swept, 0.0, high, limit / PRESSURES, pushing)


def limit_pressure(case: Case) -> float:
    """What the rubber alone can bear at its initial length, mu0 ln(R_o / R_i) [MPa]."""
    muscle = case.muscle
    if case.effects.rubber is Rubber.NONE:
        return case.path.stops[-1]
    ratio = muscle.outer_radius / muscle.inner_radius
    return case.rubber.shear_modulus * math.log(ratio)


@dataclass(frozen=True)
class Point(Generic[Position]):
    """A state of the curve: x, g and its slope, and where that is in terms of the model."""

    x: float
    g: float
    slope: float
    unloaded: bool
    position: Position


class _Ended(Exception):
    """No state there, or no trial left."""


class Finder(Generic[Position]):
    """The search on one curve.

    ``walk`` goes from a state to x on its branch and gives the last state that there is on the
    way; ``polish`` solves for the zero from a state near it.
    """

    def __init__(
        self,
        search: Search,
        points: list[Point[Position]],
        walk: Callable[[Point[Position], float], Point[Position]],
        polish: Callable[[Point[Position]], Point[Position] | None],
    ) -> None:
        self.search = search
        self.points = sorted(points, key=lambda point: point.x)
        self.known = list(self.points)
        self._walk, self._polish = walk, polish
        self._over_pressure = search.swept is Control.PRESSURE
        self._size = max(abs(search.high), abs(search.low))

    @property
    def range(self) -> tuple[float, float]:
        """Between which ends the search has been."""
        every = [point.x for point in self.known]
        return min(every), max(every)

    def find(self) -> Point[Position] | None:
        """The state of zero force, if there is one."""
        if not self.points:
            return None
        for point in self.points:
            if point.unloaded and point.slope > 0:
                return point
        bottom, top = self.points[0], self.points[-1]
        found = None
        if bottom.g > 0 or bottom.slope < 0:
            found = self._beyond(bottom, self.search.low)
        slackens = not self.search.threads_push
        if found is None and slackens and self._over_pressure and self.search.still >= 0:
            slack = (p for p in self.known if self._is_at(p, 0.0) and p.g > 0)
            found = next(slack, None)
        for lower, upper in zip(self.points, self.points[1:], strict=False):
            found = found or self._between(lower, upper)
        if found is None and self._over_pressure and bottom.g <= 0 <= bottom.slope:
            found = self._beyond(bottom, self.search.low)
        every = sorted((p for p in self.known if p.x <= top.x), key=lambda point: point.x)
        for lower, upper in pairwise(every):
            found = found or self._throughout(lower, upper)
        if found is None and top.g < 0:
            found = self._beyond(top, self.search.high)
        return found

    def _is_at(self, point: Point[Position], x: float) -> bool:
        return abs(point.x - x) < SAME * self._size

    def _go(self, start: Point[Position], x: float) -> Point[Position]:
        if len(self.known) > len(self.points) + TRIALS:
            raise _Ended
        point = self._walk(start, x)
        self.known.append(point)
        return point

    def _is_zero(self, point: Point[Position]) -> bool:
        largest = max(abs(other.g) for other in self.known)
        return abs(point.g) <= SHARE * largest and point.slope > 0

    def _beyond(self, at: Point[Position], end: float) -> Point[Position] | None:
        """Steps from a state to an end of the range; of pressure, by factors.

        None goes far beyond where the slope promises the zero: the muscle may not bear that.
        """
        up = end > at.x
        while not self._is_at(at, end):
            if not self._over_pressure:
                x = at.x + (self.search.step if up else -self.search.step)
            elif up:
                x = max(1.5 * at.x, self.search.step)
            else:
                x = at.x / 2 if at.x > 2 * self.search.step else end
            x = min(x, end) if up else max(x, end)
            if at.slope > 0 and up == (at.g < 0):
                x = at.x + (x - at.x) * min(1.0, max(0.1, -1.1 * at.g / at.slope / (x - at.x)))
            try:
                there = self._go(at, x)
            except _Ended:
                return None
            found = self._between(at, there) if up else self._between(there, at)
            if found is not None or not self._is_at(there, x):
                return found
            at = there
        return None

    def _between(self, lower: Point[Position], upper: Point[Position]) -> Point[Position] | None:
        """The zero between two states."""
        try:
            for point in (lower, upper):
                if self._is_zero(point):
                    return point
            while not lower.g < 0 < upper.g:
                alike = lower.g * upper.g > 0
                if not (alike and lower.g * lower.slope < 0 and upper.g * upper.slope > 0):
                    return None
                share = lower.slope / (lower.slope - upper.slope)
                x = lower.x + min(max(share, 0.1), 0.9) * (upper.x - lower.x)
                trial = self._go(lower, x)
                if not self._is_at(trial, x) or upper.x - lower.x < 1e-3 * self._size:
                    return None
                if trial.g * lower.g < 0:
                    lower, upper = (lower, trial) if lower.g < 0 else (trial, upper)
                elif trial.slope * lower.slope > 0:
                    lower = trial
                else:
                    upper = trial
            return self._enclose(lower, upper)
        except _Ended:
            return None

    def _throughout(self, lower: Point[Position], upper: Point[Position]) -> Point[Position] | None:
        """By steps: where force waves, its slopes at the ends say nothing."""
        width = upper.x - lower.x
        steps = math.ceil(width / self.search.step / (2.5 if self._over_pressure else 0.5))
        at = lower
        for k in range(1, steps):
            x = lower.x + k * width / steps
            try:
                there = self._go(at, x)
            except _Ended:
                return None
            found = self._between(at, there)
            if found is not None or not self._is_at(there, x):
                return found
            at = there
        return self._between(at, upper)

    def _enclose(self, lower: Point[Position], upper: Point[Position]) -> Point[Position] | None:
        """By false position (Illinois), from the side on which the muscle pulls."""
        low_g, high_g, large, side = lower.g, upper.g, min(-lower.g, upper.g), 0
        while upper.x - lower.x > 10 * SAME * self._size:
            x = (lower.x * high_g - upper.x * low_g) / (high_g - low_g)
            sides = (upper, lower) if self._over_pressure else (lower, upper)
            trial = self._go(sides[0], x)
            if not self._is_at(trial, x):
                trial = self._go(sides[1], x)
            if not self._is_at(trial, x):
                return None
            if abs(trial.g) < large / 10 and trial.slope > 0:
                found, reach = self._polish(trial), -trial.g / trial.slope
                if (
                    found is not None
                    and lower.x <= found.x <= upper.x
                    and abs(found.x - trial.x - reach) <= abs(reach) / 2
                    and found.slope > 0
                ):
                    return found
            if trial.g < 0:
                lower, low_g = trial, trial.g
                high_g, side = (high_g / 2 if side < 0 else high_g), -1
            else:
                upper, high_g = trial, trial.g
                low_g, side = (low_g / 2 if side > 0 else low_g), 1
        return None


def judge(
    case: Case,
    states: dict[str, NDArray[np.float64]],
    status: StateStatus,
    searched: tuple[float, float] | None,
) -> tuple[StateStatus, str]:
    """Status and note of the state of zero force; ``searched`` says between which ends.

    A control that is zero but for rounding becomes zero.
    """
    force = states["force"]
    if np.isnan(force[-1]):
        if searched is None:
            return StateStatus.NOT_REACHED, "the curve on which to look for it was not reached"
        contraction = case.path.kind.swept is Control.CONTRACTION
        ends = [0.0 if abs(x) < 1e-12 else x for x in searched]
        low, high = ((f"{100 * x:.6g} %" if contraction else f"{x:.6g}") for x in ends)
        unit = "contraction" if contraction else "MPa"
        return StateStatus.NO_ROOT, f"no change of sign from {low} to {high} {unit}"
    for name, size in (("pressure", limit_pressure(case)), ("contraction", 1.0)):
        if abs(states[name][-1]) < ROUNDING * size:  # a pressure of -1e-17 MPa is none
            states[name][-1] = 0.0
    if states["pressure"][-1] == 0 and abs(force[-1]) > 10 * SHARE * np.nanmax(np.abs(force)):
        return status, (
            f"its force of {plain(force[-1], 3)} N is what the smoothing of the slack law adds to "
            "a muscle without pressure"
        )
    return status, ""
