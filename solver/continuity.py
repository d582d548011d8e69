"""Whether the states of a curve are of one branch: they are at their controls, and hang together.

Newton's method converges on whatever branch it comes to. So a step of the free quantity between
neighbouring stops is compared with the trapezoid of its recorded derivative (dF/dl on an isobaric
path, dF/dp on an isometric one, on an isotonic one the contraction by de/dp). Where they differ by
more than a share of the largest value, the step is done again with stops in between, from the state
before it, and so are those of its parts that differ still. Mostly the curve only bends there, and
the finer steps come to the same state. Where they do not, or that state is not known as a whole,
the curve is solved once more with stops in between, and again. A state that this reaches with
another value is taken from it. Where the difference stays and the step of the free quantity has not
become smaller with that of the control, the muscle snaps; what lies behind is of another branch.
(A net of rigid threads begins with an infinite slope: its steps go with the root of the control's.)
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from solver.case import Case
from solver.load_path import Control, PathKind

SHARE = 0.05  # of the curve's largest value: the difference that is looked at
SAME = 1e-3  # of the curve's largest value: the difference of two states that are the same
BETWEEN = 3  # stops in between
ROUNDS = 3
JUMP = 0.75  # share of a step of the free quantity that stays in a quarter of the control's
NEWTON_SLACK = 100.0  # times the tolerance: how far a state may be from its controls
States = dict[str, NDArray[np.float64]]
Solved = tuple[States, dict[int, States]]  # states, and fields by state
Curve = tuple[tuple[float, ...], States]  # by other stops
Onwards = Callable[[Case, float], States | None]


def check_state(case: Case, stop: int, row: dict[str, float]) -> None:
    """Raise ValueError if a row is no state of the curve at a stop (the last: of zero force)."""
    path, history = case.path, case.path.history
    asked = {path.kind.held: path.held}
    if stop < len(path.stops):
        asked[path.kind.swept] = path.stops[stop]
    if history is not None:
        if history.held is not None:
            asked[path.kind.held] = history.held[stop]
        if history.mass and stop > 0:
            del asked[Control.FORCE]  # what is left of the load moves the mass
        if history.valve is not None and stop > 0:
            del asked[Control.PRESSURE]  # of the supply
    modulus = case.rubber.load_scale
    sizes = {
        Control.CONTRACTION: 1.0,
        Control.PRESSURE: modulus,
        Control.FORCE: modulus * math.pi * case.muscle.inner_radius**2,
    }
    for control, value in asked.items():
        found = row[control.variable]
        if not abs(found - value) <= NEWTON_SLACK * case.numerics.newton.tolerance * sizes[control]:
            raise ValueError(f"a state whose {control.variable} is {found:g} instead of {value:g}")
    for name, number in row.items():
        if not (math.isfinite(number) or name.startswith("smoothing")):
            raise ValueError(f"a state whose {name} is {number}")


def free_quantity(
    case: Case, states: States
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """The swept control at the stops, the quantity that follows from it, and its derivative."""
    path, count = case.path, len(case.path.stops)
    by_contraction = -case.muscle.length * states["stiffness"][:count]
    by_pressure = states["force_by_pressure"][:count]
    x = np.array(path.stops)
    if path.kind is PathKind.ISOBARIC:
        return x, states["force"][:count], by_contraction
    if path.kind is PathKind.ISOMETRIC:
        return x, states["force"][:count], by_pressure
    with np.errstate(divide="ignore", invalid="ignore"):
        return x, states["contraction"][:count], -by_pressure / by_contraction


def gaps(case: Case, states: States, largest: float | None = None) -> list[int]:
    """Stops from which to the next one the curve does not follow its derivative.

    ``largest`` is the largest value of the curve, if that has more stops than these.
    """
    x, value, slope = free_quantity(case, states)
    if not np.isfinite(value).any():
        return []
    if largest is None:
        largest = float(np.nanmax(np.abs(value)))
    trapezoid = np.diff(x) * (slope[1:] + slope[:-1]) / 2
    off = np.abs(np.diff(value) - trapezoid) > SHARE * largest
    return [int(k) for k in np.flatnonzero(off)]


def snaps(
    case: Case,
    solved: Solved,
    again: Callable[[Case], Solved],
    onwards: Onwards = lambda _case, _near: None,
) -> list[tuple[float, float]]:
    """Where the curve snaps, as intervals of the swept control.

    ``onwards`` solves a case whose stops follow a state of the curve, from that state, if it is
    known as a whole; ``again`` one with more stops. What these finer steps reach with another value
    is replaced in ``solved``.
    """
    path = case.path
    reached = np.flatnonzero(np.isfinite(solved[0]["force"][: len(path.stops)]))
    if not reached.size or path.by_way:  # more stops would be another way
        return []
    if _only_bends(case, solved[0], onwards):
        return []
    kept = [path.stops[k] for k in reached]  # what has no state is not tried again
    stops, values = path.stops, solved[0]
    before = stops, values
    for _ in range(ROUNDS):
        found = gaps(_with_stops(case, stops), values)
        if not found:
            break
        more = [x for k in found for x in np.linspace(stops[k], stops[k + 1], BETWEEN + 2)[1:-1]]
        before = stops, values
        stops = tuple(sorted({*kept, *(set(stops) - set(path.stops)), *map(float, more)}))
        fine = again(_with_stops(case, stops))
        values = fine[0]
    if values is solved[0]:
        return []
    places = [stops.index(stop) for stop in kept]
    if _differ(case, solved[0], reached, fine[0], places):
        if path.zero_force:
            fine = again(replace(case, path=replace(path, stops=stops)))
            places, reached = [*places, len(stops)], np.append(reached, len(path.stops))
        _take_over(solved, fine, dict(zip(map(int, reached), places, strict=True)))
    return [
        (stops[k], stops[k + 1])
        for k in gaps(_with_stops(case, stops), values)
        if _jumps(case, stops[k], stops[k + 1], (stops, values), before)
    ]


def _only_bends(case: Case, states: States, onwards: Onwards) -> bool:
    """Whether finer steps over each gap, from the state before it, show one branch."""
    stops = case.path.stops
    largest = float(np.nanmax(np.abs(free_quantity(case, states)[1])))
    order = [point.stop for point in case.path.ways()[0]]
    return all(
        _is_joined(
            case,
            (stops[k : k + 2], _part(states, k)),
            onwards,
            falls=order.index(k) > order.index(k + 1),
            largest=largest,
        )
        for k in gaps(case, states)
    )


def _is_joined(
    case: Case,
    ends: Curve,
    onwards: Onwards,
    *,
    falls: bool,
    largest: float,
    rounds: int = ROUNDS,
) -> bool:
    """Whether finer steps from one of two neighbouring states come to the other, without a snap."""
    stops = tuple(map(float, np.linspace(ends[0][0], ends[0][1], BETWEEN + 2)))
    near, ahead = (stops[-1], stops[:-1]) if falls else (stops[0], stops[1:])
    found = onwards(_with_stops(case, ahead), near)
    if found is None or not np.isfinite(found["force"]).all():
        return False
    name, far = case.path.kind.follows, 0 if falls else -1
    if not abs(found[name][far] - ends[1][name][far]) <= SAME * largest:
        return False
    states = {
        name: np.append(found[name], two[-1]) if falls else np.append(two[0], found[name])
        for name, two in ends[1].items()
    }
    off = gaps(_with_stops(case, stops), states, largest)
    if rounds == 1:
        finer = stops, states
        return not any(_jumps(case, stops[k], stops[k + 1], finer, ends) for k in off)
    return all(
        _is_joined(
            case,
            (stops[k : k + 2], _part(states, k)),
            onwards,
            falls=falls,
            largest=largest,
            rounds=rounds - 1,
        )
        for k in off
    )


def _part(states: States, k: int) -> States:
    """The states at a stop and the next one."""
    return {name: values[k : k + 2] for name, values in states.items()}


def _jumps(
    case: Case,
    low: float,
    high: float,
    now: Curve,
    before: Curve,
) -> bool:
    """Whether nearly all of a step of the round before is in this quarter of its interval."""
    coarse = before[0]
    above = next(stop for stop in coarse if stop >= high)
    below = next(stop for stop in reversed(coarse) if stop <= low)

    def step(a: float, b: float, found: Curve) -> float:
        value = free_quantity(_with_stops(case, found[0]), found[1])[1]
        return float(abs(value[found[0].index(b)] - value[found[0].index(a)]))

    return not step(low, high, now) <= JUMP * step(below, above, before)


def _with_stops(case: Case, stops: tuple[float, ...]) -> Case:
    """The same curve by other stops."""
    return replace(
        case,
        path=replace(case.path, stops=stops, zero_force=False),
        fields_at=tuple(stop for stop in case.fields_at if stop in stops),
    )


def _differ(
    case: Case,
    states: States,
    numbers: NDArray[np.intp],
    fine: States,
    places: Sequence[int],
) -> bool:
    """Whether finer steps have reached some states with another value."""
    name = case.path.kind.follows
    values = states[name][numbers]
    largest = np.max(np.abs(values))
    return bool(np.any(np.abs(fine[name][places] - values) > SAME * largest))


def _take_over(solved: Solved, fine: Solved, places: dict[int, int]) -> None:
    """Replace what finer steps have reached, fields too; ``places`` says where it is there."""
    for k, place in places.items():
        if np.isfinite(fine[0]["force"][place]):
            for variable, values in solved[0].items():
                values[k] = fine[0][variable][place]
            if k in solved[1]:
                solved[1][k] = fine[1][place]


def behind(case: Case, cuts: Sequence[tuple[float, float]]) -> set[int]:
    """Stops that lie behind one of some intervals, on the first way to them."""
    stops = case.path.stops
    order = [point.stop for point in case.path.ways()[0] if point.stop is not None]
    found: set[int] = set()
    for before, stop in pairwise(order):
        near, far = sorted((stops[before], stops[stop]))
        if found or any(near <= low and high <= far for low, high in cuts):
            found.add(stop)
    return found
