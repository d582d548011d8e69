"""A solved isobaric curve as functions of the contraction, by its recorded derivatives."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline
from scipy.optimize import brentq

from solver.case import Case
from solver.record import Solution
from solver.status import VALID

SAME = 1e-9  # two contractions this close are one
Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Curve:
    """Valid states of a curve at constant pressure, from its initial length on.

    Between states force, volume and energy are cubics with the derivatives dF/de, dV/de = L dF/dp
    and dU/de = -L (F - p dF/dp), which all come from the tangent; other variables are cubics
    through the states. Work counts from no contraction: a muscle that is drawn out is another
    matter.
    """

    case: Case
    solution: Solution

    @cached_property
    def _chosen(self) -> NDArray[np.intp]:
        """Numbers of the states, by contraction, each contraction once."""
        states, status = self.solution.states, self.solution.state_status
        valid = np.array([s in VALID for s in status])
        found = np.flatnonzero(valid & (states["contraction"] >= -SAME))
        found = found[np.argsort(states["contraction"][found], kind="stable")]
        apart = np.diff(states["contraction"][found], prepend=-np.inf) > SAME
        return np.asarray(found[apart])

    @property
    def pressure(self) -> float:
        """That is held [MPa]."""
        return self.case.path.held

    @property
    def length(self) -> float:
        """Initial length [mm]."""
        return self.case.muscle.length

    def values(self, name: str) -> Array:
        """A variable at the states."""
        return self.solution.states[name][self._chosen]

    @cached_property
    def contraction(self) -> Array:
        """Of the states."""
        return self.values("contraction")

    @cached_property
    def force(self) -> CubicHermiteSpline:
        """[N]."""
        slope = -self.length * self.values("stiffness")
        return CubicHermiteSpline(self.contraction, self.values("force"), slope)

    @cached_property
    def volume(self) -> CubicHermiteSpline:
        """Enclosed [mm3]; dV/dl = -dF/dp, both being the mixed derivative of U - p V."""
        slope = self.length * self.values("force_by_pressure")
        return CubicHermiteSpline(self.contraction, self.values("volume"), slope)

    @cached_property
    def energy(self) -> CubicHermiteSpline:
        """Strain energy [N mm]."""
        by_pressure = self.pressure * self.values("force_by_pressure")
        slope = -self.length * (self.values("force") - by_pressure)
        return CubicHermiteSpline(self.contraction, self.values("energy"), slope)

    def at(self, name: str, contraction: float) -> float:
        """Any variable, linear between states."""
        return float(np.interp(contraction, self.contraction, self.values(name)))

    def largest(self, name: str, contraction: float) -> float:
        """Largest value from no contraction to one."""
        inside = self.contraction <= contraction + SAME
        return max(float(np.max(self.values(name)[inside])), self.at(name, contraction))

    def contraction_of(self, force: float) -> float:
        """Where the force falls to a value; NaN if it does not."""
        off = self.values("force") - force
        below = np.flatnonzero((off[:-1] >= 0) & (off[1:] < 0))
        if not off.size or off[-1] == 0:
            return float(self.contraction[-1]) if off.size else np.nan
        if not below.size:
            near = np.flatnonzero(np.abs(off) <= 1e-6 * np.max(np.abs(self.values("force"))))
            return float(self.contraction[near[0]]) if near.size else np.nan
        k = int(below[0])
        ends = self.contraction[k], self.contraction[k + 1]
        return float(brentq(lambda e: float(self.force(e)) - force, *ends, xtol=1e-14))

    def work(self, contraction: float) -> float:
        """Integral of the force over the way [N mm]; NaN to where that is not known."""
        if not np.isfinite(contraction):
            return np.nan
        return self.length * float(self.force.integrate(0.0, contraction))

    def balance(self, contraction: float) -> float:
        """How far p dV = dU + L int F de is from closing, as a share of p dV."""
        put_in = self.pressure * float(self.volume(contraction) - self.volume(0.0))
        stored = float(self.energy(contraction) - self.energy(0.0))
        return (put_in - stored - self.work(contraction)) / put_in if put_in else np.nan
