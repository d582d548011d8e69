"""The crossings of the sleeves of a cylinder, and by which angle they have slipped.

The twin is solver/threads/friction.idp. All numbers are of a reference length: forces in N/mm,
moments in N, energy in N.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from geometry.braid import Kind, Layer
from solver.friction import Friction

Array = NDArray[np.float64]


class SleeveFriction:
    """Sleeves as groups of families of one shape, each with its crossings."""

    def __init__(self, friction: Friction, layers: Sequence[Layer]) -> None:
        shapes: dict[tuple[float, float], list[int]] = {}
        for number, layer in enumerate(layers):
            if layer.kind is Kind.SLEEVE:
                shapes.setdefault((layer.radius, layer.lead), []).append(number)
        self.families = list(shapes.values())
        self.first = np.array([numbers[0] for numbers in self.families])
        firsts = [layers[number] for number in self.first]
        self.tangents = np.array([layer.tangent for layer in firsts])
        self.radii = np.array([layer.radius for layer in firsts])
        self.lever = friction.lever
        self.stiffness = np.array([friction.stiffness(layer.carrier) for layer in firsts])
        self.slipped = self.limit = np.zeros(len(firsts))
        self.lost = 0.0  # in the last step

    def add(self, a: Array, b: float, by_a: Array, by_b: Array) -> None:
        """Add the moments to the derivatives of the energy by A and B of every layer."""
        angle, limit, turn = self._crossings(a, b, by_a)
        moment = self._moment(angle, limit)
        by_a[self.first] += moment * turn / a[self.first]
        by_b[self.first] -= moment * turn / b

    def rest(self, a: Array, b: float, by_a: Array) -> None:
        """The crossings bear nothing here."""
        self.slipped, self.limit, _ = self._crossings(a, b, by_a)

    def advance(self, a: Array, b: float, by_a: Array) -> None:
        """End a step here; ``by_a`` is of the threads alone."""
        angle, limit, _ = self._crossings(a, b, by_a)
        slipped = angle - self._moment(angle, limit) / self.stiffness
        self.lost = float(np.sum((self.limit + limit) / 2 * np.abs(slipped - self.slipped)))
        self.slipped, self.limit, self.angle = slipped, limit, angle

    @property
    def stored(self) -> float:
        """Elastic energy of the crossings."""
        moment = self._moment(self.angle, self.limit)
        return float(np.sum(moment**2 / self.stiffness) / 2)

    def _moment(self, angle: Array, limit: Array) -> Array:
        return np.clip(self.stiffness * (angle - self.slipped), -limit, limit)

    def _crossings(self, a: Array, b: float, by_a: Array) -> tuple[Array, Array, Array]:
        """Angles between the families, the largest moments, and sin cos of half the angles."""
        tangent = self.tangents * np.sqrt(a[self.first] / b)
        pressing = np.array([np.sum(by_a[numbers]) for numbers in self.families])
        pressing = 2 * np.sqrt(a[self.first]) / self.radii * np.maximum(pressing, 0)
        return 2 * np.arctan(tangent), self.lever * pressing, tangent / (1 + tangent**2)
