"""Gent: W = - mu Jm / 2 ln(1 - x / Jm) with x = I1 - 3, which ends at x = Jm."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from solver.rubber.rubber_law import Array, Fitting, InvariantLaw, parameter, scaled


@dataclass(frozen=True, kw_only=True)
class Gent(InvariantLaw):
    """A network whose chains cannot be longer than a limit."""

    mu: float = parameter(unit="MPa", symbol="mu", usual=(0, 20), bounds=(0.02, 4.0), above=0)
    jm: float = parameter(unit="1", symbol="Jm", usual=(1, 1000), bounds=(1.0, 1000.0), above=0)

    def by_invariants(self, i1: Any, i2: Any) -> tuple[Any, Any, Any]:
        """Energy and its derivatives W1, W2 by the invariants [MPa]; NaN beyond the end."""
        left = 1 - (i1 - 3) / self.jm
        left = np.where(left > 0, left, np.nan)
        return -self.mu * self.jm / 2 * np.log(left), self.mu / 2 / left, 0.0

    @classmethod
    def fittings(cls) -> dict[str, Fitting]:
        """How it is fitted to tests."""
        return {cls.law(): scaled("mu", "jm", (3.0, 10.0, 30.0, 100.0, 300.0), 1e-2, 1e6)}

    def margin(self, a: Array, b: float, shear: Array) -> float:
        """1 - x / Jm, the smallest."""
        return float(np.min(1 - (a * (1 + shear) + b + 1 / (a * b) - 3) / self.jm))


LAW = Gent
