"""The usual analytical dynamic model: contractile element, spring and damper side by side.

F = F1(p, e) - f0 - k e - b de/dt, with F1 of Eq. (1) of the paper. Its three constants are fitted
to a loop of the finite elements by least squares, so that one sees what it can carry: a mean curve
near that pressure, a loss at that rate.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geometry.muscle import Muscle
from solver import net

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ThreeElements:
    """The fitted model: f0 [N], k [N], b [N s], by contraction and its rate."""

    muscle: Muscle
    offset: float
    spring: float
    damper: float

    @classmethod
    def fitted(
        cls, muscle: Muscle, pressure: Array, contraction: Array, rate: Array, force: Array
    ) -> "ThreeElements":
        """To states of a loop."""
        rows = np.column_stack([np.ones_like(contraction), contraction, rate])
        taken = net.force(muscle, pressure, contraction) - force
        found = np.linalg.lstsq(rows, taken, rcond=None)[0]
        return cls(muscle, *map(float, found))

    def force(self, pressure: Array, contraction: Array, rate: Array) -> Array:
        """[N]."""
        inner = self.offset + self.spring * contraction + self.damper * rate
        return net.force(self.muscle, pressure, contraction) - inner

    def width(self, rate: float) -> float:
        """Of a loop between a rate and its opposite [N]."""
        return 2 * self.damper * rate
