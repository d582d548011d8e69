"""Least squares with confidence intervals, for parameters that are positive."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.stats import norm
from scipy.stats import t as student

Array = NDArray[np.float64]
Forces = Callable[[Mapping[str, float]], Array]  # by values of the parameters
CONFIDENCE = 0.95
STEP = 1e-3  # relative step of finite differences, far above the tolerance of Newton's method
CLOSE = 1e-3  # relative distance from a bound below which a value counts as stopped by it
DECADES = 100.0  # an interval from a value to that many times it says next to nothing
WITHIN = float(norm.ppf((1 + CONFIDENCE) / 2))  # standard deviations of a tolerance
ROUNDS, SETTLED = 8, 0.01  # of the scatter: at most, and its last relative change
PASSES = 2  # of the model's error at most: anew where values have moved by more than that
MOVED = 0.1  # of a logarithm
LEAST_SCATTER = 1e-6, 1e-4  # N, and share of that at the start: of forces that are computed
DIGITS = 13  # of a value that is tried
SINGULAR = 1e12  # condition of a matrix beyond which values cannot be told apart
ENOUGH = {"xtol": 1e-5, "ftol": 1e-6, "gtol": 1e-8}  # beside intervals
EXACT = {"xtol": 1e-6, "ftol": 1e-8, "gtol": 1e-8}


@dataclass(frozen=True)
class Parameter:
    """What may be fitted: where to start and how far to go.

    Attributes
    ----------
    tolerance : within which of ``start`` it is known already, with a confidence of 95 %; then
        ``low`` and ``high`` are its ends
    step : relative, of finite differences
    """

    name: str
    unit: str
    start: float
    low: float
    high: float
    tolerance: float | None = None
    step: float = STEP


@dataclass(frozen=True)
class Fitted:
    """A fitted value with its confidence interval, NaN where the data does not bound it."""

    parameter: Parameter
    value: float
    low: float
    high: float

    @property
    def at_bound(self) -> bool:
        """Whether the bounds stopped it, and not the data."""
        bounds = np.log([self.parameter.low, self.parameter.high])
        return bool(np.min(np.abs(bounds - np.log(self.value))) < self._close)

    @property
    def _close(self) -> float:
        """Of a logarithm, to that of a bound; a tolerance may be as narrow as the usual one."""
        whole = np.log(self.parameter.high / self.parameter.low)
        return min(CLOSE, 0.01 * whole) if self.parameter.tolerance else CLOSE

    @property
    def says_nothing(self) -> bool:
        """Whether the data leaves its size open."""
        return not self.low > 0 or self.high / self.low > DECADES


def fit(parameters: Sequence[Parameter], residuals: Forces) -> list[Fitted]:
    """Minimise the sum of squares of ``residuals``, which takes values by name.

    The logarithms are fitted, as stiffnesses act in proportion and are positive. Intervals come
    from the Jacobian at the minimum and the scatter around it, with Student's t for few points.

    Raises
    ------
    ValueError
        If there are not more residuals than parameters.
    """
    of_logarithms, start, bounds = _logarithmic(parameters, residuals)
    found = least_squares(of_logarithms, start, bounds=bounds, diff_step=STEP, **EXACT)
    free = found.fun.size - len(parameters)
    if free < 1:
        raise ValueError(_too_few(found.fun.size, parameters))
    covariance = (2 * found.cost / free) * _inverse(found.jac.T @ found.jac)
    return _fitted(parameters, found.x, covariance, free)


def fit_by_imperfect_model(
    parameters: Sequence[Parameter], residuals: Forces, errors: Forces
) -> list[Fitted]:
    """The same where the model is wrong too, by about as much as ``errors`` says.

    These are what a fuller model adds to the forces. How much of that is right is not known, but it
    is the same share at all points: what is measured is F + a ``errors``, with a normal ``a`` of
    mean 0 and standard deviation 1, beside the scatter s of single points. So the covariance of the
    points is s^2 I + d d' with d = ``errors`` (generalised least squares), and s comes from what
    remains. What is known of a parameter with a tolerance is a normal distribution too.

    Raises
    ------
    ValueError
        If there are not more residuals than parameters.
    """
    of_logarithms, x, bounds = _logarithmic(parameters, lambda values: residuals(_shorter(values)))
    count, centre = len(parameters), np.log([p.start for p in parameters])
    spread = np.array([_deviation(p) for p in parameters])  # of what is known, infinite if nothing
    steps = np.array([p.step for p in parameters] + [STEP])
    ends = np.column_stack([bounds, [-np.inf, np.inf]])
    first = of_logarithms(x)
    points, least = first.size, max(LEAST_SCATTER[0], LEAST_SCATTER[1] * _size(first))
    if points <= count:
        raise ValueError(_too_few(points, parameters))
    z = np.append(x, 0.0)  # logarithms of the values, then the share a
    for _ in range(PASSES):
        x = z[:count]
        wrong = errors(_shorter(_values(parameters, x)))
        scatter = max(_size(of_logarithms(z[:count])), least)
        for _ in range(ROUNDS):

            def weighted(z: Array, wrong: Array = wrong, by: float = scatter) -> Array:
                off = of_logarithms(z[:count]) + z[count] * wrong
                return np.concatenate([off / by, (z[:count] - centre) / spread, z[count:]])

            found = least_squares(
                weighted, z, bounds=ends, diff_step=steps, x_scale="jac", **ENOUGH
            )
            z = found.x
            seen = found.jac[:points].T @ found.jac[:points]
            covariance = _of_scaled(seen + np.diag(np.append(spread, 1.0) ** -2.0))
            used = float(np.trace(covariance @ seen))  # parameters that the points decide
            free = points - (used if np.isfinite(used) else count)
            ratio = _size(found.fun[:points]) * np.sqrt(points / free)
            before, scatter = scatter, max(scatter * ratio, least)
            if abs(scatter / before - 1) <= SETTLED:
                break
        if np.max(np.abs(z[:count] - x)) <= MOVED:
            break
    return _fitted(parameters, z[:count], covariance[:count, :count], free)


def _logarithmic(
    parameters: Sequence[Parameter], residuals: Forces
) -> tuple[Callable[[Array], Array], Array, Array]:
    """Residuals as a function of logarithms, where to start, and bounds (two rows)."""
    bounds = np.log([(p.low, p.high) for p in parameters]).T
    start = np.clip(np.log([p.start for p in parameters]), *bounds)
    return (lambda x: residuals(_values(parameters, x))), start, bounds


def _values(parameters: Sequence[Parameter], x: Array) -> dict[str, float]:
    return dict(zip([p.name for p in parameters], np.exp(x).tolist(), strict=True))


def _shorter(values: Mapping[str, float]) -> dict[str, float]:
    """Of the logarithm of a start the start itself: it is solved for already."""
    return {name: float(f"{value:.{DIGITS}g}") for name, value in values.items()}


def _deviation(parameter: Parameter) -> float:
    """Standard deviation of the logarithm of what is known of a parameter."""
    if parameter.tolerance is None:
        return np.inf
    return parameter.tolerance / parameter.start / WITHIN


def _size(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _too_few(points: int, parameters: Sequence[Parameter]) -> str:
    return f"{points} forces cannot fix {len(parameters)} values"


def _inverse(square: Array) -> Array:
    """Of a symmetric matrix; NaN if it is all but singular."""
    if np.linalg.cond(square) > SINGULAR:
        return np.full(square.shape, np.nan)
    return np.asarray(np.linalg.inv(square))


def _of_scaled(square: Array) -> Array:
    """The same of a matrix whose entries have sizes of their own, as a share has beside values."""
    sizes = np.sqrt(np.diag(square))
    if not sizes.all():
        return np.full(square.shape, np.nan)
    both = np.outer(sizes, sizes)
    return np.asarray(_inverse(square / both) / both)


def _fitted(
    parameters: Sequence[Parameter], x: Array, covariance: Array, free: float
) -> list[Fitted]:
    """Values with intervals, of logarithms and their covariance; NaN if they cannot be told."""
    width = np.sqrt(np.diag(covariance)) * student.ppf((1 + CONFIDENCE) / 2, free)
    return [
        Fitted(p, float(np.exp(at)), float(np.exp(at - w)), float(np.exp(at + w)))
        for p, at, w in zip(parameters, x, width, strict=True)
    ]
