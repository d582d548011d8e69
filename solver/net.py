"""The fundamental geometrical model, Eq. (1) of the paper: an inextensible net on a cylinder.

F = p pi D0^2 / (4 sin^2 a) (3 cos^2 a (1 - eps)^2 - 1), a the braid angle at the mean layer
diameter. The net alone decides the radius, so contraction ends at 54.7 deg. D0 is

- the inner diameter, as in the paper, or
- the mean layer diameter. As the volume of the wall stays the same, the volume inside the net
  changes as that of the bore does: this is -p dV/dl of a wall that keeps its volume, at any
  thickness.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from geometry.muscle import Muscle
from solver.case import Case
from solver.load_path import PathKind
from solver.record import Solution, unreached, variables
from solver.status import case_status, state_status


def force(
    muscle: Muscle,
    pressure: float | NDArray[np.float64],
    contraction: float | NDArray[np.float64],
    diameter: float | None = None,
) -> NDArray[np.float64]:
    """Force of Eq. (1) [N]; ``diameter`` is D0 [mm], the inner diameter if left out."""
    angle, d0 = _angle_and_diameter(muscle, diameter)
    area = math.pi * d0**2 / (4 * math.sin(angle) ** 2)
    shortening = 1 - np.asarray(contraction)
    return np.asarray(pressure * area * (3 * math.cos(angle) ** 2 * shortening**2 - 1))


def contraction_under_load(
    muscle: Muscle, pressure: NDArray[np.float64], load: float, diameter: float | None = None
) -> NDArray[np.float64]:
    """Contraction at which Eq. (1) gives ``load`` [N]; NaN where there is no pressure."""
    angle, d0 = _angle_and_diameter(muscle, diameter)
    area = math.pi * d0**2 / (4 * math.sin(angle) ** 2)
    with np.errstate(divide="ignore", invalid="ignore"):
        squared = (1 + load / (area * pressure)) / (3 * math.cos(angle) ** 2)
    return np.where(pressure > 0, 1 - np.sqrt(squared), np.nan)


def bore(
    muscle: Muscle, contraction: NDArray[np.float64], diameter: float | None = None
) -> NDArray[np.float64]:
    """Inner diameter [mm], from that of the net, D0 sin(a') / sin(a); NaN beyond its contraction.

    cos(a') = (1 - eps) cos(a); what lies between bore and net keeps its volume.
    """
    angle, d0 = _angle_and_diameter(muscle, diameter)
    shortening = 1 - contraction
    with np.errstate(invalid="ignore", divide="ignore"):
        net = d0 * np.sqrt(1 - (shortening * math.cos(angle)) ** 2) / math.sin(angle)
        if diameter is None:
            return np.asarray(net)
        return np.asarray(np.sqrt(net**2 - (d0**2 - muscle.inner_diameter**2) / shortening))


def _angle_and_diameter(muscle: Muscle, diameter: float | None) -> tuple[float, float]:
    """The angle of the braid [rad] and D0 [mm], the inner diameter if left out."""
    assert muscle.braid is not None  # else the case is refused (solver/case.py)
    return muscle.braid.angle, muscle.inner_diameter if diameter is None else diameter


def solve(case: Case, d0: float | None = None) -> Solution:
    """Eq. (1) at every stop of a path; ``d0`` is D0 [mm], the inner diameter if left out."""
    contraction, pressure = _sweep[case.path.kind](case, d0)
    states = unreached(case.path.states, variables(case))
    states["contraction"], states["pressure"] = contraction, pressure
    states["force"] = force(case.muscle, pressure, contraction, d0)
    states["inner_diameter_inflated"] = bore(case.muscle, contraction, d0)
    # what this model has no opinion on cannot make a state invalid or unstable
    checks = states | {
        "min_det_f": np.ones_like(pressure),
        "min_det_f_nodes": np.ones_like(pressure),
        "margin": np.ones_like(pressure),
        "unstable_modes": np.zeros_like(pressure),
        "stiffness": np.ones_like(pressure),
    }
    status = state_status(case.path.kind, checks)
    outcome = case_status(status)
    reason = "" if outcome == "converged" else "without pressure the net carries no load"
    return Solution(status=outcome, reason=reason, states=states, state_status=status)


def _isobaric(case: Case, _d0: float | None) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    contraction = np.array(case.path.stops, dtype=float)
    if case.path.zero_force:
        assert case.muscle.braid is not None
        free = 1 - 1 / (math.sqrt(3) * math.cos(case.muscle.braid.angle))
        contraction = np.append(contraction, free)
    return contraction, np.full_like(contraction, case.path.held)


def _isometric(case: Case, _d0: float | None) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    pressure = np.array(case.path.stops, dtype=float)
    if case.path.zero_force:
        pressure = np.append(pressure, 0.0)  # Eq. (1) has no threshold
    return np.full_like(pressure, case.path.held), pressure


def _isotonic(case: Case, d0: float | None) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    pressure = np.array(case.path.stops, dtype=float)
    return contraction_under_load(case.muscle, pressure, case.path.held, d0), pressure


_Sweep = Callable[[Case, float | None], tuple[NDArray[np.float64], NDArray[np.float64]]]
_sweep: dict[PathKind, _Sweep] = {
    PathKind.ISOBARIC: _isobaric,
    PathKind.ISOMETRIC: _isometric,
    PathKind.ISOTONIC: _isotonic,
}
