"""By what muscles are like each other: the dimensionless groups of a curve, and of its states.

Muscles of equal groups have equal shares of error, whatever their size.
"""

from collections.abc import Mapping
from math import cos, degrees, pi, radians, sin

import numpy as np
from numpy.typing import NDArray

from geometry.braid import Kind
from solver.case import Case
from solver.load_path import PathKind
from solver.record import Solution
from workflow.plan.judged import FOLLOWS, QUANTITIES, is_valid, scale, variable_of

__all__ = ["FOLLOWS", "QUANTITIES", "groups", "is_pushed", "of_states", "share"]


def groups(case: Case) -> dict[str, float]:
    """Of a curve; NaN without a braid.

    pressure : largest of the path, of the initial shear modulus of the rubber
    wall, length : of the inner diameter
    strain : p D^2 / (sum of n EA): about how far threads stretch
    angle : mean braid angle [degree]
    gap : widest between tube and sleeve, of the outer radius; sleeve : share of layers around it
    furthest, first : largest and smallest contraction of the path, where it is given
    load : of p pi D^2 / 4, where it is given
    lowest : as ``pressure``, the smallest of the path above zero
    """
    muscle, path = case.muscle, case.path
    isobaric, isometric = (path.kind is kind for kind in (PathKind.ISOBARIC, PathKind.ISOMETRIC))
    pressure = path.held if isobaric else max(path.stops)
    square = muscle.inner_diameter**2
    found = {
        "pressure": pressure / case.rubber.shear_modulus,
        "wall": muscle.wall_thickness / muscle.inner_diameter,
        "length": muscle.length / muscle.inner_diameter,
        "furthest": max(path.stops) if isobaric else path.held if isometric else 0.0,
        "first": min(path.stops) if isobaric else path.held if isometric else 0.0,
        "load": 0.0 if isobaric or isometric else path.held / max(pressure * pi * square / 4, 1e-9),
        "lowest": pressure / case.rubber.shear_modulus
        if isobaric
        else min((stop for stop in path.stops if stop > 0), default=0.0)
        / case.rubber.shear_modulus,
    }
    if muscle.braid is None or case.thread is None:
        return found | dict.fromkeys(("strain", "angle", "gap", "sleeve"), float("nan"))
    layers = muscle.braid.layers(muscle.outer_radius)
    stiffness = sum(each.threads * each.share for each in layers) * case.thread.stiffness
    gap = max(each.radius - each.carrier for each in layers)
    return found | {
        "strain": pressure * square / stiffness,
        "angle": degrees(muscle.braid.angle),
        "gap": max(gap, 0.0) / muscle.outer_radius,
        "sleeve": sum(each.kind is Kind.SLEEVE for each in layers) / len(layers),
    }


def thread_stretch(of: Mapping[str, float]) -> float:
    """About how far threads stretch at the largest pressure, as a share, by groups of a curve.

    Of a thin net at its first angle, which bears the pressure around itself alone:
    p D^2 pi cos(angle) / (2 n EA sin^2(angle)).
    """
    angle = radians(of["angle"])
    return pi / 2 * of["strain"] * cos(angle) / sin(angle) ** 2


def of_states(case: Case, solution: Solution) -> dict[str, NDArray[np.float64]]:
    """Of all states of a curve.

    contraction; at : its pressure, of the initial shear modulus; pull : its force, of p pi D^2 / 4
    at the largest pressure of the path
    """
    found = solution.states
    top = groups(case)["pressure"] * case.rubber.shear_modulus
    area = pi * case.muscle.inner_diameter**2 / 4
    return {
        "contraction": found["contraction"],
        "at": found["pressure"] / case.rubber.shear_modulus,
        "pull": found["force"] / (top * area),
    }


def is_pushed(solution: Solution) -> NDArray[np.bool_]:
    """At which states a muscle is pushed: those that may be believed, with a negative force."""
    return np.asarray(is_valid(solution) & (solution.states["force"] < 0))


def share(case: Case, solution: Solution, exact: Solution, quantity: str) -> NDArray[np.float64]:
    """Errors at all states, of the largest value along the curve; NaN where there are none."""
    name = variable_of(case, quantity)
    off = np.abs(solution.states[name] - exact.states[name]) / scale(case, exact, quantity)
    return np.where(is_valid(solution) & is_valid(exact), off, np.nan)
