"""Ogden: W = sum of mu_i / al_i (l1^al_i + l2^al_i + l3^al_i - 3), by principal stretches.

Abaqus and others write 2 mu / al^2 before the same powers, so that the same numbers are another
rubber: ``convention`` says which is meant and has no default. What is computed is in the first.

Two stretches of a surface are given by q = l1^2 + l2^2 and D = l1 l2, and no eigenvalue is needed:

    l1^al + l2^al = 2 D^v T(q / (2 D)),  v = al / 2,  T(x) = cosh(v arcosh x)

which has no trouble where the two are equal: near x = 1 it is a series in x - 1.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from geometry.refusal import is_number
from solver.refusal import UnsolvableCase
from solver.rubber.rubber_law import Array, Fitting, RubberLaw, Values, parameter

TEXTBOOK, ABAQUS = "textbook", "abaqus"
MOST = 4
POWERS = (-6.0, -2.0, -0.5, 0.7, 1.5, 2.5, 5.0, 9.0)  # to start a fit from
LEAST_POWER, LARGEST_POWER = 1e-3, 20.0
NEAR, TERMS = 0.05, 10  # x - 1 up to which the series is taken, and its terms: exact to rounding


@dataclass(frozen=True, kw_only=True)
class Ogden(RubberLaw):
    """A rubber by powers of its principal stretches."""

    convention: str = parameter(words=(TEXTBOOK, ABAQUS))
    mu: tuple[float, ...] = parameter(unit="MPa", symbol="mu", usual=(0, 20), most=MOST)
    alpha: tuple[float, ...] = parameter(unit="1", symbol="alpha", usual=(0, 50), most=MOST)

    def __post_init__(self) -> None:
        for name in ("mu", "alpha"):  # one number is a list of one
            if is_number(getattr(self, name)):
                object.__setattr__(self, name, (getattr(self, name),))
        for refusal in self.out_of_range(vars(self)):
            raise refusal
        if len(self.mu) != len(self.alpha):
            allowed = f"as many numbers as mu has, {len(self.mu)}"
            raise UnsolvableCase("alpha", list(self.alpha), allowed)
        if 0 in self.alpha:
            raise UnsolvableCase("alpha", list(self.alpha), "powers that are not 0")
        super().__post_init__()

    @classmethod
    def fittings(cls) -> dict[str, Fitting]:
        """How it is fitted to tests, with some terms; the modulus of each is half its mu al.

        None may be negative: with other signs a law is of no rubber outside of its tests.
        """

        def units(powers: Sequence[float]) -> list[Values]:
            alpha = [power if abs(power) > LEAST_POWER else LEAST_POWER for power in powers]
            return [{"convention": TEXTBOOK, "mu": (2 / a,), "alpha": (a,)} for a in alpha]

        def values(powers: Sequence[float], moduli: Sequence[float]) -> Values:
            terms = [(2 * m / a, a) for m, a in zip(moduli, powers, strict=True) if m > 0]
            terms.sort(key=lambda term: -abs(term[0]))
            mu, alpha = zip(*terms, strict=True) if terms else ((), ())
            return {"convention": TEXTBOOK, "mu": [*map(float, mu)], "alpha": [*map(float, alpha)]}

        return {
            f"{cls.law()}{count}": Fitting(
                units=units,
                values=values,
                starts=tuple(combinations(POWERS, count)),
                low=(-LARGEST_POWER,) * count,
                high=(LARGEST_POWER,) * count,
                positive=True,
            )
            for count in range(1, MOST + 1)
        }

    @property
    def terms(self) -> list[tuple[float, float]]:
        """Pairs of mu [MPa] and al, one a term, as textbooks write them."""
        by_alpha = self.convention == ABAQUS
        return [(2 * m / a if by_alpha else m, a) for m, a in zip(self.mu, self.alpha, strict=True)]

    def own_flags(self) -> dict[str, float]:
        """Every term, in the convention of textbooks; those that are left out have no stiffness."""
        terms = [*self.terms, *[(0.0, 1.0)] * (MOST - len(self.mu))]
        named = enumerate(terms, 1)
        return {
            f"{n}{k}": v for k, term in named for n, v in zip(("mu", "alpha"), term, strict=True)
        }

    @property
    def shear_modulus(self) -> float:
        """Half the sum of mu al [MPa]."""
        return sum(m * a for m, a in self.terms) / 2

    @property
    def initial_slope(self) -> float:
        """Sum of mu [MPa]."""
        return sum(m for m, _ in self.terms)

    def energy(self, a: Array, b: float, shear: Array) -> Array:
        """Energy per reference volume [MPa]."""
        d, x = _of_surface(a, b, shear)
        total = 0 * d
        for m, al in self.terms:
            total += m / al * (2 * d ** (al / 2) * _powers(al / 2, x)[0] + d**-al - 3)
        return total

    def slopes(self, a: Array, b: float, shear: Array) -> tuple[Array, Array, Array]:
        """Derivatives of the energy by A, B and s [MPa]."""
        d, x = _of_surface(a, b, shear)
        by_q, by_d = 0 * d, 0 * d
        for m, al in self.terms:
            v = al / 2
            t, t_x = _powers(v, x)
            by_q += m / al * d ** (v - 1) * t_x
            by_d += m * (d ** (v - 1) * (t - x * t_x / v) - d ** (-al - 1))
        return by_q * (1 + shear) + by_d * d / (2 * a), by_q + by_d * d / (2 * b), by_q * a


def _of_surface(a: Array, b: float, shear: Array) -> tuple[Array, Array]:
    """D and x of a surface."""
    d = np.sqrt(a * b)
    return d, (a * (1 + shear) + b) / (2 * d)


def _powers(v: float, x: Array) -> tuple[Array, Array]:
    """T and its derivative by x."""
    d = np.clip(x - 1, None, NEAR)
    t, t_x, c = 0 * d, 0 * d, 1.0
    for k in range(TERMS + 1):
        t += c * d**k
        c *= (v**2 - k**2) / ((2 * k + 1) * (k + 1))
        t_x += (k + 1) * c * d**k
    y = np.arccosh(np.maximum(x, 1 + NEAR))
    far = x > 1 + NEAR
    return (
        np.where(far, np.cosh(v * y), t),
        np.where(far, v * np.sinh(v * y) / np.sinh(y), t_x),
    )


LAW = Ogden
