"""What is known of a state of the cylinder beside its shape and its loads."""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from solver.effects import Rubber
from solver.models.cylinder.mechanics import Cylinder, State

Array = NDArray[np.float64]


def observed(cylinder: Cylinder, at: Array) -> dict[str, float]:
    """What is known of a state, as in VARIABLES of solver/record.py, but the smoothing."""
    muscle, state = cylinder.case.muscle, cylinder.state(at)
    by = slopes(cylinder, at)
    inner, outer = (
        cylinder.radius_at(radius, state.r, state.lz)
        for radius in (muscle.inner_radius, muscle.outer_radius)
    )
    values = {
        "contraction": 1 - state.lz,
        "pressure": state.pressure,
        "force": state.force,
        "force_cap": state.force,
        "force_midplane": state.force,
        "inner_diameter_inflated": 2 * inner,
        "outer_diameter": 2 * outer,
        "twist": state.twist,
        "torque": state.torque,
        "volume": volume(cylinder, state),
        "energy": cylinder.energy(state) * muscle.length,
        "min_det_f": 1.0,  # incompressible by construction
        "min_det_f_nodes": 1.0,
        "margin": min(state.lz, state.r / cylinder.inner, cylinder.rubber_margin(state)),
        "stiffness": float(by[0, 0]) / muscle.length,
        "force_by_pressure": float(by[0, 1]),
        "volume_by_pressure": float(by[1, 1]),
    }
    if cylinder.case.effects.rubber is not Rubber.NONE:
        values["rubber_stretch_max"] = cylinder.rubber_stretch(state)
    if cylinder.sleeved:
        values["contact_pressure"] = cylinder.contact_pressure(state)
    if muscle.braid is not None:
        stretch = cylinder.thread_stretch(state)
        values |= {
            "thread_stretch_min": float(stretch.min()),
            "thread_stretch_max": float(stretch.max()),
        }
    return values


def volume(cylinder: Cylinder, state: State) -> float:
    """Enclosed [mm3]."""
    return math.pi * state.r**2 * state.lz * cylinder.case.muscle.length


def slopes(cylinder: Cylinder, at: Array) -> Array:
    """Of force and volume (rows) by lz at fixed pressure and by p at fixed lz; without torque."""

    def loads(x: Array) -> Array:
        state = cylinder.state(x)
        results = [state.force, volume(cylinder, state)]
        return np.array([*results, state.lz, state.pressure] + [state.torque] * cylinder.free)

    found = derivatives(loads, at)
    moved = np.eye(len(at))[:, :2]
    return np.asarray(found[:2] @ np.linalg.solve(found[2:], moved))


def derivatives(values: Callable[[Array], Array], at: Array) -> Array:
    """Of several values (rows) by every unknown, by central differences."""
    step = 1e-6
    columns = [
        (values(at + shift) - values(at - shift)) / (2 * step) for shift in step * np.eye(len(at))
    ]
    return np.array(columns).T
