"""A uniform cylinder: rubber through the wall thickness and stretching threads, no end caps.

What a state is stands in mechanics.py beside this module. A path is followed by solving at each
stop for the unknowns (radius, axial stretch, twist; those that the case has) from the stop before.
"""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import OptimizeResult, minimize_scalar, root

from solver import continuity
from solver.case import DYNAMIC, Case
from solver.effects import Rubber
from solver.judge import judged
from solver.load_path import Control, Waypoint
from solver.models.cylinder.mechanics import REACH, Cylinder, State
from solver.models.cylinder.observe import derivatives, observed, slopes, volume
from solver.models.cylinder.vibration import dynamic_stiffness
from solver.record import Solution, unreached, variables
from solver.zero_force import Finder, Point, Search

Array = NDArray[np.float64]
SHARP = 1e-3  # width of slackening, as a share, that counts as none
SMALLEST_STEP = 1 / 1024  # share of the way to a waypoint
LONGEST_STEP = 0.25  # of any unknown; they have no unit
ARC_STEP, ARC_STEPS = 0.02, 500  # along a branch, in the unknowns
NAMES = {  # of controls, as solver/path/newton.idp writes them
    Control.CONTRACTION: "contraction",
    Control.PRESSURE: "pressure [MPa]",
    Control.FORCE: "force [N]",
    Control.VOLUME: "volume [mm^3]",
}


def solve(case: Case) -> Solution:
    """The curve of a case."""
    cylinder = Cylinder(case)
    fields: dict[int, dict[str, Array]] = {}
    states, reason, searched = _curve(cylinder, fields)
    cuts = continuity.snaps(case, (states, fields), lambda finer: _solved(Cylinder(finer)))
    solution = judged(
        case,
        states,
        reason=reason,
        searched=searched,
        lost=continuity.behind(case, cuts),
        unknowns=cylinder.unknowns,
    )
    return replace(solution, fields=fields)


def _solved(cylinder: Cylinder) -> tuple[dict[str, Array], dict[int, dict[str, Array]]]:
    """States and fields."""
    fields: dict[int, dict[str, Array]] = {}
    return _curve(cylinder, fields)[0], fields


def _curve(
    cylinder: Cylinder, fields: dict[int, dict[str, Array]]
) -> tuple[dict[str, Array], str, tuple[float, float] | None]:
    """States, why the last way ended early, and where zero force was looked for."""
    path = cylinder.case.path
    states = unreached(path.states, variables(cylinder.case))
    for way in path.ways(rubber=cylinder.case.effects.rubber is not Rubber.NONE):
        reason, searched = _follow(cylinder, way, states, fields)
        if np.isfinite(states["force"][: len(path.stops)]).all():
            break
    return states, reason, searched


def control(cylinder: Cylinder, kind: Control, state: State) -> float:
    """Value of a control, as a share of its size for this muscle."""
    return {
        Control.CONTRACTION: 1 - state.lz,
        Control.PRESSURE: state.pressure,
        Control.FORCE: state.force,
        Control.VOLUME: volume(cylinder, state),
    }[kind] / scale(cylinder, kind)


def scale(cylinder: Cylinder, kind: Control) -> float:
    """What ``control`` is a share of."""
    area = math.pi * cylinder.inner**2
    return {
        Control.CONTRACTION: 1.0,
        Control.PRESSURE: cylinder.modulus,
        Control.FORCE: cylinder.modulus * area,
        Control.VOLUME: area * cylinder.case.muscle.length,
    }[kind]


def _follow(
    cylinder: Cylinder,
    way: list[Waypoint],
    states: dict[str, Array],
    fields: dict[int, dict[str, Array]],
) -> tuple[str, tuple[float, float] | None]:
    """Record the stops of a way and the state of zero force.

    Gives where the way ended if that was before its end, and where zero force was looked for.
    """
    case, at, reason = cylinder.case, cylinder.start, ""
    curve = _Branch(cylinder) if case.path.zero_force else None
    for point in way:
        kinds = point.first, point.second
        targets = np.array([point.first_target, point.second_target])
        scales = np.array([scale(cylinder, kind) for kind in kinds])
        at, reached = walk(cylinder, kinds, targets / scales, at)
        if curve is not None and curve.holds(at):
            curve.points.append(curve.point(at))
        if not reached:
            reason = limit(cylinder, kinds, targets / scales, at)
            break
        if point.stop is not None:
            _record(cylinder, states, point.stop, at)
            if case.vibrates:
                fields[point.stop] = {DYNAMIC: dynamic_stiffness(cylinder, at)}
    if curve is None or not curve.points:
        return reason, None
    finder = Finder(curve.search, curve.points, curve.walk, curve.polish)
    found = finder.find()
    if found is not None:
        _record(cylinder, states, len(case.path.stops), found.position)
    return reason, finder.range


class _Branch:
    """The curve of a case as solver.zero_force.Finder asks for it."""

    def __init__(self, cylinder: Cylinder) -> None:
        self.cylinder = cylinder
        self.search = Search.of(cylinder.case)
        self.points: list[Point[Array]] = []

    def holds(self, at: Array) -> bool:
        """Whether a state is on the curve."""
        held = self.search.held
        value = control(self.cylinder, held, self.cylinder.state(at))
        return abs(value - self.search.still / scale(self.cylinder, held)) < 1e-9

    def point(self, at: Array) -> Point[Array]:
        """A state with what the search needs of it."""
        state, swept = self.cylinder.state(at), self.search.swept
        over_pressure = swept is Control.PRESSURE
        unloaded = max(abs(state.lz - 1), abs(state.pressure) / self.cylinder.modulus) < 1e-9
        return Point(
            x=state.pressure if over_pressure else 1 - state.lz,
            g=state.force if over_pressure else -state.force,
            slope=_force_slope(self.cylinder, at, swept),
            unloaded=unloaded,
            position=at,
        )

    def walk(self, start: Point[Array], x: float) -> Point[Array]:
        """To x; the last state on the way if that ends before."""
        goal = [
            value / scale(self.cylinder, kind)
            for kind, value in ((self.search.held, self.search.still), (self.search.swept, x))
        ]
        kinds = self.search.held, self.search.swept
        return self.point(walk(self.cylinder, kinds, np.array(goal), start.position)[0])

    def polish(self, start: Point[Array]) -> Point[Array] | None:
        """To no force."""
        held = self.search.still / scale(self.cylinder, self.search.held)
        kinds = self.search.held, Control.FORCE
        at, reached = walk(self.cylinder, kinds, np.array([held, 0.0]), start.position)
        return self.point(at) if reached else None


def walk(
    cylinder: Cylinder, kinds: tuple[Control, Control], goal: Array, at: Array
) -> tuple[Array, bool]:
    """From some unknowns to those whose controls are at ``goal``, in as many steps as needed.

    Gives the last unknowns on the way, and whether it came to its end. No step is long: a far root
    may be of another branch, as when a balloon snaps.
    """
    start = values(cylinder, kinds, at)
    end = np.append(goal, np.zeros(cylinder.free))
    done, step = 0.0, 1.0
    while done < 1:
        share = min(done + step, 1.0)
        target = start + share * (end - start)
        with np.errstate(all="ignore"):
            found = root(lambda x, t=target: values(cylinder, kinds, x) - t, at, tol=1e-13)
        if is_near(cylinder, found, at):
            at, done, step = found.x, share, 2 * step
        else:
            step /= 2
            if step < SMALLEST_STEP:
                return at, False
    return at, True


def is_near(cylinder: Cylinder, found: OptimizeResult, at: Array) -> bool:
    """Whether a root is one, of a tube, and not far from some unknowns."""
    positive = found.x[1] > 0 and (cylinder.rigid or found.x[0] > 0)
    near = np.max(np.abs(found.x - at)) < LONGEST_STEP
    return bool(np.max(np.abs(found.fun)) < 1e-11 and positive and near)


def values(cylinder: Cylinder, kinds: tuple[Control, Control], x: Array) -> Array:
    """The controls at some unknowns, then the torque where twist is free; as shares."""
    state = cylinder.state(x)
    torque = state.torque / (cylinder.modulus * cylinder.inner**3)
    return np.array([control(cylinder, k, state) for k in kinds] + [torque] * cylinder.free)


def limit(cylinder: Cylinder, kinds: tuple[Control, Control], goal: Array, at: Array) -> str:
    """Why there is no way from the unknowns ``at`` to the controls ``goal``.

    The branch is followed by its length: where the control that is moved has an extremum, it is
    named with its value.
    """
    here = values(cylinder, kinds, at)
    moving = int(np.argmax(np.abs(goal - here[:2])))
    sense = math.copysign(1.0, goal[moving] - here[moving])
    held = [k for k in range(len(here)) if k != moving]
    unit = sense * scale(cylinder, kinds[moving])

    def along(start: Array, tangent: Array, length: float) -> Array | None:
        """The unknowns at a length of the branch from ``start``."""

        def off(x: Array) -> Array:
            return np.append(
                (values(cylinder, kinds, x) - here)[held], tangent @ (x - start) - length
            )

        with np.errstate(all="ignore"):
            found = root(off, start + length * tangent, tol=1e-13)
        near = np.max(np.abs(found.x - start)) < 2 * ARC_STEP
        return found.x if np.max(np.abs(found.fun)) < 1e-10 and near else None

    def moved(x: Array | None) -> float:
        """The moving control, so that it rises towards its goal."""
        return -math.inf if x is None else sense * float(values(cylinder, kinds, x)[moving])

    last, before = at, None
    for _ in range(ARC_STEPS):
        rows = derivatives(lambda x: values(cylinder, kinds, x), at)
        if not np.isfinite(rows).all():
            break
        tangent = np.linalg.svd(rows[held])[2][-1]  # along it the held controls do not change
        tangent *= np.sign(sense * rows[moving] @ tangent if before is None else before @ tangent)
        there = along(at, tangent, ARC_STEP)
        if there is None:
            break
        if moved(there) < moved(at):
            ends = -ARC_STEP, ARC_STEP
            most = minimize_scalar(
                lambda s, x=at, t=tangent: -moved(along(x, t, s)), bounds=ends, method="bounded"
            )
            return f"fold of the {NAMES[kinds[moving]]} at {-most.fun * unit:g}"
        at, before = there, tangent
        if cylinder.state(at).r > REACH * cylinder.inner:
            return f"asymptote of the {NAMES[kinds[moving]]} at {moved(at) * unit:g}"
    state = cylinder.state(last)
    return (
        f"no state found beyond contraction {1 - state.lz:g}, pressure {state.pressure:g} "
        f"MPa, force {state.force:g} N"
    )


def _record(cylinder: Cylinder, states: dict[str, Array], stop: int, at: Array) -> None:
    """Put a state into the record."""
    values = observed(cylinder, at)
    values["smoothing"], values["smoothing_rate"] = _smoothing(cylinder, at)
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
    goal = np.array([control(cylinder, kind, here) for kind in kinds])
    forces = []
    for share in (SHARP, 2 * SHARP):
        slack = replace(case.numerics.slack, width=share * case.numerics.slack.width)
        sharp = Cylinder(replace(case, numerics=replace(case.numerics, slack=slack)))
        found, reached = walk(sharp, kinds, goal, at)
        forces.append(sharp.state(found).force if reached else math.nan)
    width = case.numerics.slack.width_of(case.thread)
    return here.force - forces[0], (forces[1] - forces[0]) / (SHARP * width)


def _force_slope(cylinder: Cylinder, at: Array, along: Control) -> float:
    """dF/dlz at fixed pressure, or dF/dp at fixed lz; without torque."""
    return float(slopes(cylinder, at)[0, 0 if along is Control.CONTRACTION else 1])
