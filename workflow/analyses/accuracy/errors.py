"""Discretisation errors from a family of meshes: extrapolation, observed order, grid convergence.

The value of a mesh of size h is taken as f + c h^p. On a family of refinements m, h = 1/m; f and c
of every state and one order p for all are those that fit best, finer meshes weighing more.
So a single pair of meshes that happens to agree fools nobody (Eca and Hoekstra 2014).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
ORDERS = np.linspace(0.5, 8, 1501)  # candidates for the observed order
SAFETY = 1.25  # of the grid-convergence index with three or more meshes (Roache 1998)
ASSUMED_ORDER = 2.0  # of two meshes, which show no order; families of more show 2.6 or higher


@dataclass(frozen=True)
class Extrapolation:
    """What a family of meshes converges to.

    Attributes
    ----------
    order : observed order of convergence p; NaN if the values do not converge
    limit : extrapolated values, one per state
    """

    order: float
    limit: Array


def extrapolate(refinements: Sequence[float], values: ArrayLike) -> Extrapolation:
    """Order and limit of values of shape (mesh, state), meshes in the order of ``refinements``.

    Raises
    ------
    ValueError
        If there are fewer than three meshes.
    """
    if len(refinements) < 3:
        raise ValueError("an order is observed on three meshes or more")
    m, v = np.asarray(refinements, dtype=float), np.asarray(values, dtype=float)
    weight = (m / m.sum())[:, None]
    misfits, limits = [], []
    for order in ORDERS:
        terms = np.stack([np.ones_like(m), m**-order], axis=1)
        found = np.linalg.lstsq(terms * weight, v * weight, rcond=None)[0]
        misfits.append(float(np.sum(((terms @ found - v) * weight) ** 2)))
        limits.append(found[0])
    best = int(np.argmin(misfits))
    inside = 0 < best < len(ORDERS) - 1
    return Extrapolation(float(ORDERS[best]) if inside else np.nan, np.asarray(limits[best]))


def grid_convergence_index(
    fine: ArrayLike, coarse: ArrayLike, ratio: float, order: float
) -> NDArray[np.float64]:
    """Error of the finer of two meshes with sizes of a ratio > 1, estimated high (Roache 1998)."""
    difference = np.abs(np.asarray(fine) - np.asarray(coarse))
    return np.asarray(SAFETY * difference / (ratio**order - 1))


def pair_error(coarse: ArrayLike, fine: ArrayLike, ratio: float = 2.0) -> NDArray[np.float64]:
    """Error of the coarser of two meshes, of which the order is not observed but assumed."""
    difference = np.abs(np.asarray(fine) - np.asarray(coarse))
    return np.asarray(difference / (1 - ratio**-ASSUMED_ORDER))


def share(difference: ArrayLike, scale: ArrayLike) -> float:
    """Largest absolute difference as a share of the largest absolute value of ``scale``.

    Of the values that are known; NaN where there are none.
    """
    return _largest(difference) / _largest(scale)


def _largest(values: ArrayLike) -> float:
    known = np.abs(np.asarray(values, dtype=float))
    return float(np.nanmax(known)) if np.isfinite(known).any() else np.nan


def exponent(x: ArrayLike, y: ArrayLike) -> float:
    """Exponent b of the law y = a x^b that fits best in logarithms; NaN for less than two x."""
    x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    if len(np.unique(x)) < 2:
        return np.nan
    return float(np.polyfit(np.log(x), np.log(y), 1)[0])
