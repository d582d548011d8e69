"""A uniform cylinder: rubber through the wall thickness and stretching threads, no end caps.

What a state is stands in solver/cylinder_mechanics.py. A path is followed by solving at each stop
for the unknowns (radius, axial stretch, twist; those that the case has) from the stop before.
"""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import root

from solver.case import Case
from solver.cylinder_mechanics import Cylinder, State
from solver.effects import Rubber
from solver.load_path import Control, Due, Waypoint
from solver.record import Solution, unreached
from solver.status import CaseStatus, case_status, state_status

Array = NDArray[np.float64]
SHARP = 1e-3  # width of slackening, as a share, that counts as none
SMALLEST_STEP = 1 / 1024  # share of the way to a waypoint
LONGEST_STEP = 0.25  # of any unknown; they have no unit


def solve(case: Case) -> Solution:
    """The curve of a case."""
    cylinder = Cylinder(case)
    states = unreached(case.path.states)
    reason = ""
    for way in case.path.ways(rubber=case.effects.rubber is not Rubber.NONE):
        reason = _follow(cylinder, way, states)
        if not reason:
            break
    checks = states | {"unstable_modes": np.zeros(case.path.states)}
    status = state_status(case.path.kind, checks)
    states["stiffness"][:] = np.nan  # by lz; only its sign means something without a length
    outcome = case_status(status)
    return Solution(
        status=outcome,
        reason="" if outcome is CaseStatus.CONVERGED else reason,
        states=states,
        state_status=status,
        unknowns=cylinder.unknowns,
    )


def _control(cylinder: Cylinder, kind: Control, state: State) -> float:
    """Value of a control, as a share of its size for this muscle."""
    return {
        Control.CONTRACTION: 1 - state.lz,
        Control.PRESSURE: state.pressure,
        Control.FORCE: state.force,
        Control.VOLUME: math.pi * state.r**2 * state.lz * cylinder.case.muscle.length,
    }[kind] / _scale(cylinder, kind)


def _scale(cylinder: Cylinder, kind: Control) -> float:
    """What ``_control`` is a share of."""
    area = math.pi * cylinder.inner**2
    return {
        Control.CONTRACTION: 1.0,
        Control.PRESSURE: cylinder.modulus,
        Control.FORCE: cylinder.modulus * area,
        Control.VOLUME: area * cylinder.case.muscle.length,
    }[kind]


def _follow(cylinder: Cylinder, way: list[Waypoint], states: dict[str, Array]) -> str:
    """Record the stops of a way; where it could not be followed to its end, say where it ended."""
    at = cylinder.start
    aside_done, before, reason = False, set[bool](), ""
    for point in way:
        aside = point.due is not Due.ALWAYS
        if reason and point.due is not Due.AT_LAST:
            continue
        if aside and (aside_done or not _is_due(cylinder, point, at, before)):
            continue
        kinds = point.first, point.second
        targets = np.array([point.first_target, point.second_target])
        scales = np.array([_scale(cylinder, kind) for kind in kinds])
        found = _walk(cylinder, kinds, targets / scales, at)
        aside_done |= aside
        if found is None:
            last = cylinder.state(at)
            reason = reason or (
                f"no state found beyond contraction {1 - last.lz:g}, pressure {last.pressure:g} "
                f"MPa, force {last.force:g} N"
            )
            continue
        at = found
        if point.stop is not None:
            _record(cylinder, states, point.stop, at)
            before.add(bool(cylinder.state(at).force > 0))
    return reason


def _is_due(cylinder: Cylinder, point: Waypoint, at: Array, before: set[bool]) -> bool:
    """Whether to look for the state of zero force from here; ``before`` says where it pulled."""
    if point.due is Due.AT_LAST:
        return True in before
    pulls = cylinder.state(at).force > 0
    swept = next(c for c in (Control.CONTRACTION, Control.PRESSURE) if c is not point.first)
    return pulls == (point.due is Due.PULLS) and (
        (not pulls) in before or _force_slope(cylinder, at, swept) > 0
    )


def _walk(
    cylinder: Cylinder, kinds: tuple[Control, Control], goal: Array, at: Array
) -> Array | None:
    """From some unknowns to those whose controls are at ``goal``, in as many steps as needed.

    No step is long: a far root may be of another branch, as when a balloon snaps.
    """
    torque = cylinder.modulus * cylinder.inner**3

    def values(x: Array) -> Array:
        state = cylinder.state(x)
        found = [_control(cylinder, kind, state) for kind in kinds]
        return np.array(found + [state.torque / torque] * cylinder.free)

    start = values(at)
    end = np.append(goal, np.zeros(cylinder.free))
    done, step = 0.0, 1.0
    while done < 1:
        share = min(done + step, 1.0)
        target = start + share * (end - start)
        with np.errstate(all="ignore"):
            found = root(lambda x, t=target: values(x) - t, at, tol=1e-13)
        positive = found.x[1] > 0 and (cylinder.rigid or found.x[0] > 0)
        near = np.max(np.abs(found.x - at)) < LONGEST_STEP
        if np.max(np.abs(found.fun)) < 1e-11 and positive and near:
            at, done, step = found.x, share, 2 * step
        else:
            step /= 2
            if step < SMALLEST_STEP:
                return None
    return at


def _record(cylinder: Cylinder, states: dict[str, Array], stop: int, at: Array) -> None:
    """Put a state into the record."""
    muscle, state = cylinder.case.muscle, cylinder.state(at)
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
        "min_det_f": 1.0,  # incompressible by construction
        "min_det_f_nodes": 1.0,
        "margin": min(state.lz, state.r / cylinder.inner),
        "stiffness": _force_slope(cylinder, at, Control.CONTRACTION),
    }
    if cylinder.case.effects.rubber is not Rubber.NONE:
        values["rubber_stretch_max"] = cylinder.rubber_stretch(state)
    values["smoothing"], values["smoothing_rate"] = _smoothing(cylinder, at)
    if muscle.braid is not None:
        stretch = cylinder.thread_stretch(state)
        values |= {"thread_stretch_min": stretch.min(), "thread_stretch_max": stretch.max()}
    for name, value in values.items():
        states[name][stop] = value


def _smoothing(cylinder: Cylinder, at: Array) -> tuple[float, float]:
    """Force that the smoothing of the slack law adds, and its derivative by a narrow width.

    Against states at the same contraction and pressure, of laws a thousandth as wide; NaN where
    such a state is not found.
    """
    case = cylinder.case
    if "slack" not in case.as_dict()["numerics"]:
        return 0.0, 0.0
    assert case.thread is not None
    here, kinds = cylinder.state(at), (Control.CONTRACTION, Control.PRESSURE)
    goal = np.array([_control(cylinder, kind, here) for kind in kinds])
    forces = []
    for share in (SHARP, 2 * SHARP):
        slack = replace(case.numerics.slack, width=share * case.numerics.slack.width)
        sharp = Cylinder(replace(case, numerics=replace(case.numerics, slack=slack)))
        found = _walk(sharp, kinds, goal, at)
        forces.append(math.nan if found is None else sharp.state(found).force)
    width = case.numerics.slack.width_of(case.thread)
    return here.force - forces[0], (forces[1] - forces[0]) / (SHARP * width)


def _force_slope(cylinder: Cylinder, at: Array, along: Control) -> float:
    """dF/dlz at fixed pressure, or dF/dp at fixed lz; without torque; by central differences."""
    step = 1e-6

    def loads(x: Array) -> Array:
        state = cylinder.state(x)
        return np.array([state.force, state.lz, state.pressure] + [state.torque] * cylinder.free)

    columns = [
        (loads(at + shift) - loads(at - shift)) / (2 * step) for shift in step * np.eye(len(at))
    ]
    force, *controls = np.array(columns).T
    moved = np.zeros(len(at))
    moved[0 if along is Control.CONTRACTION else 1] = 1
    return float(force @ np.linalg.solve(np.array(controls), moved))
