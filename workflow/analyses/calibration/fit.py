"""Least squares with confidence intervals, for parameters that are positive."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.stats import t as student

Array = NDArray[np.float64]
CONFIDENCE = 0.95
STEP = 1e-3  # relative step of finite differences, far above the tolerance of Newton's method
CLOSE = 1e-3  # relative distance from a bound below which a value counts as stopped by it


@dataclass(frozen=True)
class Parameter:
    """What may be fitted: where to start and how far to go."""

    name: str
    unit: str
    start: float
    low: float
    high: float


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
        return bool(np.min(np.abs(bounds - np.log(self.value))) < CLOSE)


def fit(
    parameters: Sequence[Parameter], residuals: Callable[[Mapping[str, float]], Array]
) -> list[Fitted]:
    """Minimise the sum of squares of ``residuals``, which takes values by name.

    The logarithms are fitted, as stiffnesses act in proportion and are positive. Intervals come
    from the Jacobian at the minimum and the scatter around it, with Student's t for few points.

    Raises
    ------
    ValueError
        If there are not more residuals than parameters.
    """
    names = [parameter.name for parameter in parameters]
    bounds = np.log([(p.low, p.high) for p in parameters]).T

    def of_logarithms(x: Array) -> Array:
        return residuals(dict(zip(names, np.exp(x).tolist(), strict=True)))

    start = np.clip(np.log([p.start for p in parameters]), *bounds)
    found = least_squares(
        of_logarithms, start, bounds=bounds, diff_step=STEP, xtol=1e-6, ftol=1e-8, gtol=1e-8
    )
    free = found.fun.size - len(parameters)
    if free < 1:
        raise ValueError(f"{found.fun.size} forces cannot fix {len(parameters)} values")
    width = _widths(found.jac, 2 * found.cost / free, free)
    return [
        Fitted(p, float(np.exp(x)), float(np.exp(x - w)), float(np.exp(x + w)))
        for p, x, w in zip(parameters, found.x, width, strict=True)
    ]


def _widths(jacobian: Array, variance: float, free: int) -> Array:
    """Half widths of the confidence intervals of the logarithms; NaN if they cannot be told."""
    square = jacobian.T @ jacobian
    if np.linalg.cond(square) > 1e12:
        return np.full(len(square), np.nan)
    error = np.sqrt(variance * np.diag(np.linalg.inv(square)))
    return np.asarray(error * student.ppf((1 + CONFIDENCE) / 2, free))
