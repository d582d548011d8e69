"""Arruda-Boyce: W = mu sum of ci lm^(2 - 2 i) (I1^i - 3^i), the series of five terms."""

from dataclasses import dataclass
from typing import Any

from solver.rubber.rubber_law import Fitting, InvariantLaw, parameter, scaled

SERIES = (1 / 2, 1 / 20, 11 / 1050, 19 / 7000, 519 / 673750)


@dataclass(frozen=True, kw_only=True)
class ArrudaBoyce(InvariantLaw):
    """Eight chains in a cube. ``mu`` is not the initial shear modulus, which is a little larger."""

    mu: float = parameter(unit="MPa", symbol="mu", usual=(0, 20), bounds=(0.02, 4.0), above=0)
    lambda_m: float = parameter(
        unit="1", symbol="lambda_m", usual=(1.1, 50), bounds=(1.1, 50.0), above=1
    )

    def by_invariants(self, i1: Any, i2: Any) -> tuple[Any, Any, Any]:
        """Energy and its derivatives W1, W2 by the invariants [MPa]."""
        terms = [(i, self.mu * c * self.lambda_m ** (2 - 2 * i)) for i, c in enumerate(SERIES, 1)]
        energy = sum(c * (i1**i - 3.0**i) for i, c in terms)
        return energy, sum(i * c * i1 ** (i - 1) for i, c in terms), 0.0

    @classmethod
    def fittings(cls) -> dict[str, Fitting]:
        """How it is fitted to tests."""
        return {cls.law(): scaled("mu", "lambda_m", (1.2, 2.0, 4.0, 8.0), 1.01, 100.0)}


LAW = ArrudaBoyce
