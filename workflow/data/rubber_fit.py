"""A law of rubber fitted to tests: least squares of nominal stress, and whether it is stable.

All laws are linear in their moduli. Powers and limits, which are not, are searched for; for each
trial of these the moduli follow from linear least squares, for some laws with none below 0. What
is linear in a law, and where a search begins, the law says itself (solver/rubber).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares, nnls

from solver import rubber
from solver.refusal import UnsolvableCase
from solver.rubber import LAWS
from solver.rubber.rubber_law import Fitting, RubberLaw, Values
from workflow.data.rubber_tests import KINDS, RubberTest, squares, stress
from workflow.study.errors import StudyError, choices

Array = NDArray[np.float64]
BEST = 5  # starts that are followed to their end
LEAST_MODULUS = 1e-10  # MPa, of a term that may not be negative
UNSTABLE = 1e-6  # of a determinant: how far below 0 is below rounding
STIFF = 1e9  # MPa: any rubber is nearly incompressible by it
DIGITS = 6  # of what is written
CHECKED = 200  # stretches at which stability is looked at
STEP = 1e-5  # of logarithms of stretches, in differences


@dataclass(frozen=True)
class Form:
    """A law and how it is fitted."""

    law: type[RubberLaw]
    fitting: Fitting

    def columns(self, shapes: Sequence[float], kind: str, stretch: Array) -> Array:
        """Stress by every modulus, at some shapes."""
        with np.errstate(all="ignore"):
            units = self.fitting.units(shapes)
            found = [stress(self.law.unchecked(**unit), kind, stretch) for unit in units]
        return np.array(found).T


@dataclass(frozen=True)
class Fit:
    """A fitted law.

    Attributes
    ----------
    values : parameters by name
    shapes, moduli : as they were found
    residuals : stress less the measured one, by test [MPa]
    material : the rubber; None if there is none with such parameters
    unstable : by test the stretch next to 1 beyond which it is no rubber; none where it is one
    """

    form: Form
    tests: tuple[RubberTest, ...]
    values: dict[str, object]
    shapes: tuple[float, ...]
    moduli: Array
    residuals: dict[str, Array]
    material: RubberLaw | None
    unstable: dict[str, float]

    @property
    def squares(self) -> float:
        """Sum of squares [MPa2]."""
        return float(sum(np.sum(r**2) for r in self.residuals.values()))

    @property
    def span(self) -> tuple[float, float]:
        """Stretches of the tests."""
        all_of = np.concatenate([test.stretch for test in self.tests])
        return float(all_of.min()), float(all_of.max())

    def stress(self, kind: str, stretch: Array) -> Array:
        """Nominal stress in a test [MPa]."""
        columns = self.form.columns(self.shapes, kind, stretch)
        return np.asarray(columns @ self.moduli)


@cache
def forms() -> dict[str, Form]:
    """Laws that can be fitted, by name."""
    return {
        name: Form(law, fitting)
        for law in LAWS.values()
        for name, fitting in law.fittings().items()
    }


def fit(law: str, tests: Sequence[RubberTest], largest: float = np.inf) -> Fit:
    """The law that has the least squares of nominal stress, up to some stretch.

    Raises
    ------
    StudyError
        If there is no such law, or fewer points than parameters.
    """
    known = forms()
    if law not in known:
        raise StudyError(f"--law {law} is refused\n  allowed: {choices(law, known)}")
    form = known[law]
    used = [_up_to(test, largest) for test in tests]
    used = [test for test in used if test.stretch.size]
    count = sum(test.stretch.size for test in used)
    start = form.fitting.starts[0]
    size = len(start) + len(form.fitting.units(start))
    if count <= size:
        raise StudyError(f"{law} has {size} parameters, and there are {count} points")
    shapes, moduli = _solved(form, used)
    values = form.fitting.values(shapes, moduli.tolist())
    residuals = {
        test.kind: form.columns(shapes, test.kind, test.stretch) @ moduli - test.stress
        for test in used
    }
    material = _material(form, values)
    unstable = {} if material is None else dict(_unstable(material, used))
    return Fit(form, tuple(used), values, shapes, moduli, residuals, material, unstable)


def _up_to(test: RubberTest, largest: float) -> RubberTest:
    own = test.stretch <= largest
    return RubberTest(test.kind, test.stretch[own], test.stress[own])


def _solved(form: Form, tests: Sequence[RubberTest]) -> tuple[tuple[float, ...], Array]:
    """Shapes and moduli of the least squares."""
    expected = np.concatenate([test.stress for test in tests])

    def moduli(shapes: Sequence[float]) -> tuple[Array, Array]:
        columns = np.concatenate([form.columns(shapes, test.kind, test.stretch) for test in tests])
        if not np.isfinite(columns).all():
            return np.zeros(columns.shape[1]), 1e3 * (1 + np.abs(expected))
        scale = np.linalg.norm(columns, axis=0)
        scale[scale == 0] = 1
        if form.fitting.positive:
            found = nnls(columns / scale, expected)[0] / scale
            kept = found > LEAST_MODULUS  # less can be written in no study file
            if not kept.all():
                found = np.zeros(len(kept))
                found[kept] = nnls((columns / scale)[:, kept], expected)[0] / scale[kept]
        else:
            found = np.linalg.lstsq(columns / scale, expected, rcond=None)[0] / scale
        return found, columns @ found - expected

    if not form.fitting.low:
        return (), moduli(())[0]

    def residuals(shapes: Array) -> Array:
        return moduli(shapes.tolist())[1]

    starts = sorted(
        form.fitting.starts, key=lambda start: float(np.sum(residuals(np.array(start)) ** 2))
    )
    bounds = np.array(form.fitting.low), np.array(form.fitting.high)
    ends = [
        least_squares(
            residuals,
            start,
            bounds=bounds,
            x_scale=np.maximum(np.abs(start), 1.0),
            xtol=1e-12,
            ftol=1e-14,
            gtol=1e-14,
            max_nfev=300,
        )
        for start in starts[:BEST]
    ]
    shapes = tuple(map(float, min(ends, key=lambda end: end.cost).x))
    return shapes, moduli(shapes)[0]


def entry(found: Fit) -> dict[str, object]:
    """The material as it stands in a study file, with some digits; empty if there is none."""
    if found.material is None:
        return {}
    values = {k: v for k, v in found.material.as_dict().items() if k != "kappa" and v != 0.0}
    rounded = {key: _rounded(value) for key, value in values.items()}
    low, high = found.span
    return {**rounded, "fitted_range": [_rounded(min(low, 1.0)), _rounded(high)]}


def _rounded(value: object) -> object:
    if isinstance(value, list | tuple):
        return [_rounded(each) for each in value]
    return float(f"{value:.{DIGITS}g}") if isinstance(value, float) else value


def _material(form: Form, values: Values) -> RubberLaw | None:
    """The rubber of some parameters, by a wider law where their own refuses them."""
    for entry in ({"law": form.law.law()} | values, form.fitting.wider(values)):
        try:
            return rubber.from_dict(entry | {"kappa": STIFF}) if entry else None
        except UnsolvableCase:
            continue
    return None


def _unstable(law: RubberLaw, tests: Sequence[RubberTest]) -> Iterator[tuple[str, float]]:
    """By test the first stretch at which Drucker's condition does not hold.

    Looked at is what is stretched no more than the specimens were, by the first invariant.
    tau_i - tau_3 has to rise with ln l_j: the 2 x 2 matrix of its derivatives is positive definite.
    """
    largest = max(_first_invariant(test.kind, test.stretch).max() for test in tests)
    for kind in KINDS:
        stretch = np.geomspace(1, max(float(test.stretch.max()) for test in tests), CHECKED)
        stretch = stretch[_first_invariant(kind, stretch) <= largest]
        a, b = (np.log(square) / 2 for square in squares(kind, stretch))
        m11, m12, m22 = _moduli(law, a, b)
        with np.errstate(invalid="ignore"):
            good = (m11 > 0) & (m22 > 0) & (m11 * m22 - m12**2 > -UNSTABLE * m11 * m22)
        if not good.all():
            yield kind, float(stretch[np.argmin(good)])


def _first_invariant(kind: str, stretch: Array) -> Array:
    a, b = squares(kind, stretch)
    return np.asarray(a + b + 1 / (a * b))


def _moduli(law: RubberLaw, a: Array, b: Array) -> tuple[Array, Array, Array]:
    """Derivatives of tau_1 - tau_3 and tau_2 - tau_3 by the logarithms a, b of stretches."""

    def tau(a: Array, b: Array) -> Array:
        square_a, square_b = np.exp(2 * a), np.exp(2 * b)
        by_a, by_b, _ = law.slopes(square_a, square_b, np.zeros_like(a))  # type: ignore[arg-type]
        return np.array([2 * square_a * by_a, 2 * square_b * by_b])

    with np.errstate(all="ignore"):
        by_a = (tau(a + STEP, b) - tau(a - STEP, b)) / (2 * STEP)
        by_b = (tau(a, b + STEP) - tau(a, b - STEP)) / (2 * STEP)
    return by_a[0], (by_a[1] + by_b[0]) / 2, by_b[1]
