"""A state of the cylinder at a pressure and a contraction, found at once and not along a path."""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from solver.models.cylinder.mechanics import REACH, Cylinder

Array = NDArray[np.float64]
WIDER = 1.05  # factor of the radius, in search of the one that holds a pressure
ROUNDS, EXACT = 100, 1e-15  # steps of a root, and its size


def direct(
    cylinder: Cylinder, pressure: float, contraction: float, start: float = 1.0
) -> Array | None:
    """The unknowns at a pressure [MPa] and a contraction.

    The wall is blown up from its rest (or from ``start``, as a share of the radius) until it holds
    the pressure: of several such radii it is the smallest. None where there is none within
    ``REACH``.
    """
    lz, twist = 1 - contraction, [0.0] * cylinder.free
    if cylinder.rigid:
        at = np.array([1 + pressure / cylinder.modulus, lz, *twist])
        return at if math.isfinite(cylinder.state(at).force) else None

    def off(share: float) -> float:
        return cylinder.state(np.array([share, lz, *twist])).pressure - pressure

    low = start
    while off(low) > 0:
        low /= WIDER
        if low < 1 / REACH:
            return None
    high = low * WIDER
    while not off(high) >= 0:
        low, high = high, high * WIDER
        if high > REACH:
            return None
    at = np.array([between(off, low, high), lz, *twist])
    return _without_torque(cylinder, at, pressure) if cylinder.free else at


def between(off: Callable[[float], float], low: float, high: float) -> float:
    """The root between two points on both sides of it, by the Illinois rule.

    SciPy has better ones, which take half a second to import.
    """
    below, above = off(low), off(high)
    x, moved = low if not below else high, 0
    for _ in range(ROUNDS):
        if not below or not above or abs(high - low) <= EXACT * abs(high):
            break
        last, x = x, (low * above - high * below) / (above - below)
        if abs(x - last) <= EXACT * abs(x):  # one end may be exact and never moved
            break
        value = off(x)
        if value * above > 0:  # an end that stays twice weighs half
            high, above, below = x, value, below / (2 if moved == 1 else 1)
            moved = 1
        elif value * below > 0:
            low, below, above = x, value, above / (2 if moved == -1 else 1)
            moved = -1
        else:
            break
    return x


def _without_torque(cylinder: Cylinder, at: Array, pressure: float) -> Array | None:
    """The state at the same length and pressure in which the ends have turned freely."""
    from scipy.optimize import root  # late: it takes half a second to import

    sizes = np.array([cylinder.modulus, cylinder.modulus * cylinder.inner**3])

    def off(free: Array) -> Array:
        state = cylinder.state(np.array([free[0], at[1], free[1]]))
        return np.asarray([state.pressure - pressure, state.torque] / sizes)

    found = root(off, at[[0, 2]], tol=1e-13)
    if np.max(np.abs(found.fun)) > 1e-11:
        return None
    radius, twist = map(float, found.x)
    return np.array([radius, at[1], twist])
