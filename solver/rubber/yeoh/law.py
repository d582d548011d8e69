"""Yeoh: W = C1 x + C2 x^2 + C3 x^3 with x = I1 - 3."""

from dataclasses import dataclass
from typing import Any

from solver.rubber.rubber_law import Fitting, InvariantLaw, Values, linear, parameter


@dataclass(frozen=True, kw_only=True)
class Yeoh(InvariantLaw):
    """A rubber that stiffens at large strains; C2 is mostly negative."""

    c1: float = parameter(unit="MPa", symbol="C1", usual=(1e-3, 10), bounds=(0.01, 2.0), above=0)
    c2: float = parameter(unit="MPa", symbol="C2", usual=(0, 10))
    c3: float = parameter(unit="MPa", symbol="C3", usual=(0, 10), least=0)

    def by_invariants(self, i1: Any, i2: Any) -> tuple[Any, Any, Any]:
        """Energy and its derivatives W1, W2 by the invariants [MPa]."""
        x = i1 - 3
        energy = x * (self.c1 + x * (self.c2 + x * self.c3))
        return energy, self.c1 + x * (2 * self.c2 + 3 * x * self.c3), 0.0

    @classmethod
    def fittings(cls) -> dict[str, Fitting]:
        """How it is fitted to tests; of another sign of C3 it is a polynomial."""

        def wider(values: Values) -> Values:
            c1, c2, c3 = values.values()
            return {"law": "rivlin", "c10": c1, "c20": c2, "c30": c3}

        return {cls.law(): linear(("c1", "c2", "c3"), wider)}


LAW = Yeoh
