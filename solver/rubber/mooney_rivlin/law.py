"""Mooney-Rivlin: W = C10 (I1 - 3) + C01 (I2 - 3)."""

from dataclasses import dataclass
from typing import Any

from solver.rubber.rubber_law import Fitting, InvariantLaw, linear, parameter


@dataclass(frozen=True, kw_only=True)
class MooneyRivlin(InvariantLaw):
    """The law of the paper, and of a rubber that names none."""

    c10: float = parameter(unit="MPa", symbol="C10", usual=(1e-3, 10), bounds=(0.01, 2.0), above=0)
    c01: float = parameter(unit="MPa", symbol="C01", usual=(0, 10), bounds=(0.001, 1.0), least=0)
    unnamed = True

    def by_invariants(self, i1: Any, i2: Any) -> tuple[Any, Any, Any]:
        """Energy and its derivatives W1, W2 by the invariants [MPa]."""
        return self.c10 * (i1 - 3) + self.c01 * (i2 - 3), self.c10, self.c01

    @property
    def branch(self) -> tuple[float, float]:
        """C10 and C01 of a branch with a memory: those of the law [MPa]."""
        return self.c10, self.c01

    @classmethod
    def fittings(cls) -> dict[str, Fitting]:
        """How it is fitted to tests; of another sign of C01 it is a polynomial."""
        return {cls.law(): linear(("c10", "c01"), lambda values: {"law": "rivlin"} | values)}


LAW = MooneyRivlin
