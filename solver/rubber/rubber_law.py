"""What the rest asks of a law of rubber: one dataclass each, in ``solver/rubber/<law>/law.py``.

Beside it stand the includes of the FreeFEM programs, one for each frame in which a wall is
described: ``biaxial.idp``, ``axisymmetric.idp``, ``periodic.idp``. A law that is a function of the
invariants I1 and I2 needs one include only, ``invariants.idp``; the frames of
``solver/rubber/by_invariants`` make the rest of it.
"""

import inspect
import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geometry.plain import plain
from geometry.refusal import is_number
from solver.material import MPA
from solver.refusal import UnsolvableCase

Array = NDArray[np.float64]
BY_INVARIANTS = Path(__file__).parent / "by_invariants"
LEAST_KAPPA = 50.0  # shear moduli


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """What is known of a parameter of a law beside its value.

    Attributes
    ----------
    symbol : as figures write it
    usual : values between which it lies in practice, widely
    bounds : between which a calibration may go; without them it is not fitted
    above, least : values that it must exceed, or not fall below
    most : how many numbers it may be a list of; 0 of a single number
    words : what it may be, if it is no number
    default : what it is where it is not given
    """

    name: str = ""
    unit: str = ""
    symbol: str = ""
    usual: tuple[float, float] = (0, math.inf)
    bounds: tuple[float, float] | None = None
    above: float = -math.inf
    least: float = -math.inf
    most: int = 0
    words: tuple[str, ...] = ()
    default: float | None = None

    @property
    def allowed(self) -> str:
        """Its range in words."""
        if self.words:
            return f"one of {', '.join(self.words)}"
        limit = f" > {self.above:g}" if self.above > -math.inf else ""
        limit += f" >= {self.least:g}" if self.least > -math.inf else ""
        unit = f" ({self.unit})" if self.unit not in ("", "1") else ""
        numbers = f"a list of 1 to {self.most} finite numbers" if self.most else "a finite number"
        return f"{numbers}{limit}{unit}"

    def allows(self, value: object) -> bool:
        """Whether a value is in its range."""
        if self.words:
            return value in self.words
        if not self.most:
            return self._is_in_range(value)
        several = isinstance(value, list | tuple) and 1 <= len(value) <= self.most
        return several and all(map(self._is_in_range, value))  # type: ignore[call-overload]

    def _is_in_range(self, value: object) -> bool:
        return is_number(value) and float(value) > self.above and float(value) >= self.least  # type: ignore[arg-type]


def parameter(**known: Any) -> Any:
    """A field for a parameter of a law, with what ``Parameter`` says of it."""
    found = Parameter(**known)
    metadata = {"unit": found.unit, "parameter": found}
    if found.default is None:
        return field(metadata=metadata)
    return field(default=found.default, metadata=metadata)


Values = dict[str, Any]


@dataclass(frozen=True, kw_only=True)
class Fitting:
    """How a law is fitted to tests: it is linear in moduli, at shapes that are searched for.

    Attributes
    ----------
    units : parameters with which each modulus is 1 and the others 0, at some shapes
    values : the parameters, at shapes and moduli
    starts : shapes to begin with; low and high are their bounds
    positive : whether no modulus may be negative
    wider : the entry of a law that allows what this one refuses; empty if there is none
    """

    units: Callable[[Sequence[float]], list[Values]]
    values: Callable[[Sequence[float], Sequence[float]], Values]
    starts: tuple[tuple[float, ...], ...] = ((),)
    low: tuple[float, ...] = ()
    high: tuple[float, ...] = ()
    positive: bool = False
    wider: Callable[[Values], Values] = lambda _values: {}


def linear(names: Sequence[str], wider: Callable[[Values], Values] = lambda _values: {}) -> Fitting:
    """How a law is fitted that is linear in some parameters, the others being 0."""
    return Fitting(
        units=lambda _shapes: [{own: float(own == name) for own in names} for name in names],
        values=lambda _shapes, moduli: dict(zip(names, map(float, moduli), strict=True)),
        wider=wider,
    )


def scaled(modulus: str, shape: str, starts: Sequence[float], low: float, high: float) -> Fitting:
    """How a law is fitted that has one modulus and one shape."""
    return Fitting(
        units=lambda shapes: [{modulus: 1.0, shape: float(shapes[0])}],
        values=lambda shapes, moduli: {modulus: float(moduli[0]), shape: float(shapes[0])},
        starts=tuple((start,) for start in starts),
        low=(low,),
        high=(high,),
    )


@dataclass(frozen=True, kw_only=True)
class RubberLaw(ABC):
    """A rubber, nearly incompressible where a model resolves that.

    Squared stretches of a surface in the wall are A (hoop) and B (axial), the shear is
    s = (R tau)^2, and the stretch through the wall follows from incompressibility.

    Raises
    ------
    UnsolvableCase
        If a parameter is out of its range, the initial shear modulus not positive, or the bulk
        modulus too small for what is nearly incompressible.
    """

    kappa: float = field(default=1000.0, metadata=MPA)  # bulk modulus
    unnamed = False  # True: of a rubber that names no law

    def __post_init__(self) -> None:
        for refusal in self.out_of_range(vars(self)):
            raise refusal
        if not self.shear_modulus > 0:
            last = self.parameters()[-1].name
            allowed = f"parameters whose initial shear modulus, {self.shear_modulus:g} MPa, is > 0"
            raise UnsolvableCase(last, getattr(self, last), allowed)
        if not (is_number(self.kappa) and self.kappa >= LEAST_KAPPA * self.shear_modulus):
            raise UnsolvableCase(
                "kappa",
                self.kappa,
                f"at least {LEAST_KAPPA:g} shear moduli, {LEAST_KAPPA * self.shear_modulus:g} MPa: "
                "rubber is nearly incompressible, and the other models take it as incompressible",
            )

    @classmethod
    def law(cls) -> str:
        """Name of the law: that of its folder."""
        return cls.__module__.split(".")[-2]

    @classmethod
    def parameters(cls) -> list[Parameter]:
        """All that it has beside the bulk modulus."""
        own = (f for f in fields(cls) if "parameter" in f.metadata)
        return [replace(f.metadata["parameter"], name=f.name) for f in own]

    @classmethod
    def out_of_range(cls, values: Mapping[str, Any]) -> Iterator[UnsolvableCase]:
        """Parameters that are out of their range, each by itself."""
        for each in cls.parameters():
            if not each.allows(values[each.name]):
                yield UnsolvableCase(each.name, values[each.name], each.allowed)

    @classmethod
    def fittings(cls) -> dict[str, Fitting]:
        """How it is fitted to tests, by names that begin with its own."""
        return {cls.law(): linear([each.name for each in cls.parameters()])}

    @classmethod
    def unchecked(cls, **values: Any) -> "RubberLaw":
        """With parameters of no rubber too, for the trials of a fit."""
        made = object.__new__(cls)
        known = {each.name: each.default or 0.0 for each in cls.parameters()}
        for name, value in (known | values).items():
            object.__setattr__(made, name, value)
        return made

    @classmethod
    def includes(cls) -> list[Path]:
        """Folders with the includes of the frames; what the law has itself goes first."""
        return [Path(inspect.getfile(cls)).parent, BY_INVARIANTS]

    @classmethod
    @cache
    def has_frame(cls, name: str) -> bool:
        """Whether there is an include of that frame."""
        own, shared = cls.includes()
        by_invariants = (own / "invariants.idp").is_file() and (shared / f"{name}.idp").is_file()
        return by_invariants or (own / f"{name}.idp").is_file()

    def values(self) -> dict[str, Any]:
        """Its parameters by name."""
        return {each.name: getattr(self, each.name) for each in self.parameters()}

    def flags(self) -> dict[str, float]:
        """What the programs are told of it."""
        known = {"shear_modulus": self.shear_modulus, "initial_slope": self.initial_slope}
        return known | self.own_flags()

    def own_flags(self) -> dict[str, float]:
        """What the includes of the law are told."""
        return self.values()

    def as_dict(self) -> dict[str, Any]:
        """Plain values; without the name of the law if that is understood."""
        named = {} if self.unnamed else {"law": self.law()}
        return named | plain(self)

    @property
    @abstractmethod
    def shear_modulus(self) -> float:
        """Of small strains, mu0 [MPa]."""

    @property
    def load_scale(self) -> float:
        """Half the shear modulus, against which pressures are judged [MPa]."""
        return self.shear_modulus / 2

    @property
    def branch(self) -> tuple[float, float]:
        """C10 and C01 of a branch with a memory whose share is 1 [MPa]: neo-Hookean."""
        return self.shear_modulus / 2, 0.0

    @property
    @abstractmethod
    def initial_slope(self) -> float:
        """Of the energy by each principal stretch at rest; - this ln J takes it off [MPa]."""

    @abstractmethod
    def energy(self, a: Array, b: float, shear: Array) -> Array:
        """Energy per reference volume [MPa]."""

    @abstractmethod
    def slopes(self, a: Array, b: float, shear: Array) -> tuple[Array, Array, Array]:
        """Derivatives of the energy by A, B and s [MPa]."""

    def margin(self, a: Array, b: float, shear: Array) -> float:
        """How far the law reaches yet, 1 at rest and 0 at its end; it has none if it never ends."""
        return math.inf


@dataclass(frozen=True, kw_only=True)
class InvariantLaw(RubberLaw):
    """A law W(I1, I2)."""

    @abstractmethod
    def by_invariants(self, i1: Any, i2: Any) -> tuple[Any, Any, Any]:
        """Energy and its derivatives W1, W2 by the invariants [MPa]."""

    @property
    def shear_modulus(self) -> float:
        """2 (W1 + W2) at rest [MPa]."""
        _, w1, w2 = self.by_invariants(3.0, 3.0)
        return 2 * (float(w1) + float(w2))

    @property
    def initial_slope(self) -> float:
        """2 W1 + 4 W2 at rest [MPa]."""
        _, w1, w2 = self.by_invariants(3.0, 3.0)
        return 2 * float(w1) + 4 * float(w2)

    def energy(self, a: Array, b: float, shear: Array) -> Array:
        """Energy per reference volume [MPa]."""
        return np.asarray(self.by_invariants(*_invariants(a, b, shear))[0])

    def slopes(self, a: Array, b: float, shear: Array) -> tuple[Array, Array, Array]:
        """Derivatives of the energy by A, B and s [MPa]."""
        _, w1, w2 = self.by_invariants(*_invariants(a, b, shear))
        by_a = w1 * (1 - 1 / (a**2 * b) + shear) + w2 * (b - 1 / a**2)
        by_b = w1 * (1 - 1 / (a * b**2)) + w2 * (a - (1 + shear) / b**2)
        return by_a, by_b, w1 * a + w2 / b


def _invariants(a: Array, b: float, shear: Array) -> tuple[Array, Array]:
    i1 = a + b + 1 / (a * b) + a * shear
    i2 = 1 / a + 1 / b + a * b + shear / b
    return i1, i2
