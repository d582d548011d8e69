"""Rivlin: W = sum of Cij x^i y^j with x = I1 - 3, y = I2 - 3, to third order."""

from dataclasses import dataclass
from typing import Any

from solver.rubber.rubber_law import Fitting, InvariantLaw, linear, parameter

ORDERS = ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3))


def _constant(symbol: str) -> Any:
    return parameter(unit="MPa", symbol=symbol, usual=(0, 10), default=0.0)


@dataclass(frozen=True, kw_only=True)
class Rivlin(InvariantLaw):
    """The general polynomial of the invariants; of no sign by itself."""

    c10: float = parameter(unit="MPa", symbol="C10", usual=(1e-3, 10), bounds=(0.01, 2.0))
    c01: float = _constant("C01")
    c20: float = _constant("C20")
    c11: float = _constant("C11")
    c02: float = _constant("C02")
    c30: float = _constant("C30")
    c21: float = _constant("C21")
    c12: float = _constant("C12")
    c03: float = _constant("C03")

    def by_invariants(self, i1: Any, i2: Any) -> tuple[Any, Any, Any]:
        """Energy and its derivatives W1, W2 by the invariants [MPa]."""
        x, y = i1 - 3, i2 - 3
        energy, w1, w2 = 0.0 * x, 0.0 * x, 0.0 * x
        for i, j in ORDERS:
            c = getattr(self, f"c{i}{j}")
            energy = energy + c * x**i * y**j
            w1 = w1 + (i * c * x ** (i - 1) * y**j if i else 0.0)
            w2 = w2 + (j * c * x**i * y ** (j - 1) if j else 0.0)
        return energy, w1, w2

    @classmethod
    def fittings(cls) -> dict[str, Fitting]:
        """How it is fitted to tests: with all constants up to an order."""
        return {
            f"{cls.law()}{order}": linear([f"c{i}{j}" for i, j in ORDERS if i + j <= order])
            for order in (2, 3)
        }


LAW = Rivlin
