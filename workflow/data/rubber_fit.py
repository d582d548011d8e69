"""A law of rubber fitted to tests: least squares of nominal stress, and whether it is stable.

All laws are linear in their moduli. Powers and limits, which are not, are searched for; for each
trial of these the moduli follow from linear least squares, those of Ogden's law with mu alpha >= 0
in every term, as with other signs a law is of no rubber outside of its tests.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares, nnls

from solver import rubber
from solver.refusal import UnsolvableCase
from solver.rubber.rubber_law import RubberLaw
from workflow.data.rubber_tests import KINDS, RubberTest, squares, stress
from workflow.study.errors import StudyError, choices

Array = NDArray[np.float64]
POWERS = (-6.0, -2.0, -0.5, 0.7, 1.5, 2.5, 5.0, 9.0)  # of Ogden's terms, to start from
BEST = 8  # starts that are followed to their end
LEAST_POWER, LARGEST_POWER = 1e-3, 20.0
LEAST_MODULUS = 1e-10  # MPa, of a term of Ogden's law
UNSTABLE = 1e-6  # of a determinant: how far below 0 is below rounding
DIGITS = 6  # of what is written
CHECKED = 200  # stretches at which stability is looked at
STEP = 1e-5  # of logarithms of stretches, in differences


@dataclass(frozen=True)
class Form:
    """How a law is fitted.

    Attributes
    ----------
    columns : stress by every modulus, at shapes and a test
    values : the parameters of the law, by shapes and moduli
    starts : shapes to begin with; bounds of them
    """

    law: str
    columns: Callable[[Sequence[float], RubberTest], Array]
    values: Callable[[Sequence[float], Array], dict[str, object]]
    starts: tuple[tuple[float, ...], ...] = ((),)
    low: tuple[float, ...] = ()
    high: tuple[float, ...] = ()
    positive: bool = False


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
        columns = self.form.columns(self.shapes, RubberTest(kind, stretch, stretch))
        return np.asarray(columns @ self.moduli)


def forms() -> dict[str, Form]:
    """Laws that can be fitted, by name."""
    found = {name: _linear(name, names) for name, names in LINEAR.items()}
    found |= {f"ogden{n}": _ogden(n) for n in range(1, 5)}
    limits = tuple((x,) for x in (3.0, 10.0, 30.0, 100.0, 300.0))
    found["gent"] = _scaled("gent", "jm", limits, (1e-2,), (1e6,))
    ends = tuple((x,) for x in (1.2, 2.0, 4.0, 8.0))
    found["arruda_boyce"] = _scaled("arruda_boyce", "lambda_m", ends, (1.01,), (100.0,))
    return found


LINEAR = {
    "neo_hooke": ("c10",),
    "mooney_rivlin": ("c10", "c01"),
    "yeoh": ("c1", "c2", "c3"),
    "rivlin2": ("c10", "c01", "c20", "c11", "c02"),
    "rivlin3": ("c10", "c01", "c20", "c11", "c02", "c30", "c21", "c12", "c03"),
}
AS_RIVLIN = {"c1": "c10", "c2": "c20", "c3": "c30"}  # of Yeoh


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
    size = len(form.low) + form.columns(form.starts[0], RubberTest("uniaxial", ONE, ONE)).shape[1]
    if count <= size:
        raise StudyError(f"{law} has {size} parameters, and there are {count} points")
    shapes, moduli = _solved(form, used)
    values = form.values(shapes, moduli)
    residuals = {test.kind: form.columns(shapes, test) @ moduli - test.stress for test in used}
    material = _material(form.law, values)
    unstable = {} if material is None else dict(_unstable(material, used))
    return Fit(form, tuple(used), values, shapes, moduli, residuals, material, unstable)


ONE = np.ones(1)


def _up_to(test: RubberTest, largest: float) -> RubberTest:
    own = test.stretch <= largest
    return RubberTest(test.kind, test.stretch[own], test.stress[own])


def _solved(form: Form, tests: Sequence[RubberTest]) -> tuple[tuple[float, ...], Array]:
    """Shapes and moduli of the least squares."""
    expected = np.concatenate([test.stress for test in tests])

    def moduli(shapes: Sequence[float]) -> tuple[Array, Array]:
        columns = np.concatenate([form.columns(shapes, test) for test in tests])
        if not np.isfinite(columns).all():
            return np.zeros(columns.shape[1]), 1e3 * (1 + np.abs(expected))
        scale = np.linalg.norm(columns, axis=0)
        scale[scale == 0] = 1
        if form.positive:
            found = nnls(columns / scale, expected)[0] / scale
            kept = found > LEAST_MODULUS  # less can be written in no study file
            if not kept.all():
                found = np.zeros(len(kept))
                found[kept] = nnls((columns / scale)[:, kept], expected)[0] / scale[kept]
        else:
            found = np.linalg.lstsq(columns / scale, expected, rcond=None)[0] / scale
        return found, columns @ found - expected

    if not form.low:
        return (), moduli(())[0]

    def residuals(shapes: Array) -> Array:
        return moduli(shapes)[1]

    starts = sorted(form.starts, key=lambda start: float(np.sum(residuals(np.array(start)) ** 2)))
    bounds = np.array(form.low), np.array(form.high)
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


def _linear(name: str, parameters: tuple[str, ...]) -> Form:
    """A law that is linear in all of its parameters."""
    law = "rivlin" if name.startswith("rivlin") else name
    stiff = 1e3  # of a rubber to which each modulus is added, so that there is one

    def columns(_shapes: Sequence[float], test: RubberTest) -> Array:
        of = {AS_RIVLIN.get(key, key): 0.0 for key in parameters}
        base = stress(_rivlin(of | {"c10": stiff}), test.kind, test.stretch)
        found = []
        for key in of:
            more = _rivlin(of | {key: 1.0, "c10": stiff + (key == "c10")})
            found.append(stress(more, test.kind, test.stretch) - base)
        return np.array(found).T

    def values(_shapes: Sequence[float], moduli: Array) -> dict[str, object]:
        return dict(zip(parameters, map(float, moduli), strict=True))

    return Form(law, columns, values)


def _rivlin(values: Mapping[str, float]) -> RubberLaw:
    return rubber.from_dict({"law": "rivlin", "kappa": 1e9, **values})


def _ogden(count: int) -> Form:
    """Terms of powers; each modulus is half its mu alpha, the part of the shear modulus."""

    def columns(powers: Sequence[float], test: RubberTest) -> Array:
        a, b = squares(test.kind, test.stretch)
        alpha = np.where(np.abs(powers) > LEAST_POWER, powers, LEAST_POWER)
        along, through = test.stretch[:, None], 1 / np.sqrt(a * b)[:, None]
        return np.asarray(2 / alpha * (along**alpha - through**alpha) / along)

    def values(powers: Sequence[float], moduli: Array) -> dict[str, object]:
        terms = [(2 * m / a, a) for m, a in zip(moduli, powers, strict=True) if m > 0]
        terms.sort(key=lambda term: -abs(term[0]))
        mu, alpha = zip(*terms, strict=True) if terms else ((), ())
        return {"convention": "textbook", "mu": [*map(float, mu)], "alpha": [*map(float, alpha)]}

    starts = tuple(combinations(POWERS, count))
    ends = (-LARGEST_POWER,) * count, (LARGEST_POWER,) * count
    return Form("ogden", columns, values, starts, *ends, positive=True)


def _scaled(
    law: str,
    shape: str,
    starts: tuple[tuple[float, ...], ...],
    low: tuple[float, ...],
    high: tuple[float, ...],
) -> Form:
    """A law of one modulus, mu, and one shape."""

    def columns(shapes: Sequence[float], test: RubberTest) -> Array:
        one = {"law": law, "mu": 1.0, shape: float(shapes[0]), "kappa": 1e9}
        with np.errstate(all="ignore"):
            return stress(rubber.from_dict(one), test.kind, test.stretch)[:, None]

    def values(shapes: Sequence[float], moduli: Array) -> dict[str, object]:
        return {"mu": float(moduli[0]), shape: float(shapes[0])}

    return Form(law, columns, values, starts, low, high)


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


def _material(law: str, values: Mapping[str, object]) -> RubberLaw | None:
    """The rubber of some parameters, as a polynomial of Rivlin where its own law refuses a sign."""
    polynomial = {AS_RIVLIN.get(key, key): value for key, value in values.items()}
    for name, own in ((law, values), ("rivlin", polynomial)):
        try:
            return rubber.from_dict({"law": name, "kappa": 1e9, **own})
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
