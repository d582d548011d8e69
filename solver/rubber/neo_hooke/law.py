"""Neo-Hooke: W = C10 (I1 - 3)."""

from dataclasses import dataclass
from typing import Any

from solver.rubber.rubber_law import InvariantLaw, parameter


@dataclass(frozen=True, kw_only=True)
class NeoHooke(InvariantLaw):
    """The law of a network of Gaussian chains."""

    c10: float = parameter(unit="MPa", symbol="C10", usual=(1e-3, 10), bounds=(0.01, 2.0), above=0)

    def by_invariants(self, i1: Any, i2: Any) -> tuple[Any, Any, Any]:
        """Energy and its derivatives W1, W2 by the invariants [MPa]."""
        return self.c10 * (i1 - 3), self.c10, 0.0


LAW = NeoHooke
