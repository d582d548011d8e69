"""States behind lost ones, off their controls or across a snap are never simply converged."""

import math
from dataclasses import replace

import numpy as np
import pytest

from solver import continuity, solve
from solver.effects import Effects
from solver.follow import End, Means
from solver.freefem import Limits
from solver.judge import judged
from solver.load_path import LoadPath
from solver.record import VARIABLES
from solver.status import CaseStatus, StateStatus

STOPS = (0.0, 0.1, 0.2, 0.25, 0.3)
LIMITS = Limits(wall_time=300, memory=4000)
CONVERGED, INVALID = StateStatus.CONVERGED, StateStatus.INVALID_STATE


@pytest.fixture
def case(make_case):
    return make_case(model="solid", path=LoadPath(kind="isobaric", held=0.3, stops=STOPS))


def states_of(case, force, slope):
    """Valid states with a force and its derivative by contraction."""
    states = {name: np.ones(case.path.states) for name in VARIABLES}
    x = np.array(case.path.stops)
    states["force"] = np.array([force(e) for e in x])
    states["stiffness"] = np.array([-slope(e) for e in x]) / case.muscle.length
    states["contraction"], states["unstable_modes"] = x, 0 * x
    return states


# --- at its controls ------------------------------------------------------------------------------

GOOD = {"contraction": 0.1, "pressure": 0.3, "force": 270.0, "energy": 1.0}


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (dict.fromkeys(GOOD, 1.0), "contraction is 1 instead of 0.1|pressure is 1 instead of 0.3"),
        ({"pressure": 0.300001}, "pressure is 0.300001 instead of 0.3"),
        ({"contraction": 0.0}, "contraction is 0 instead of 0.1"),
        ({"contraction": math.nan}, "contraction is nan"),
        ({"energy": math.nan}, "energy is nan"),
        ({"energy": math.inf}, "energy is inf"),
    ],
)
def test_a_row_that_is_no_state_of_the_curve(case, changes, said):
    continuity.check_state(case, 1, GOOD)
    with pytest.raises(ValueError, match=said):
        continuity.check_state(case, 1, GOOD | changes)


# --- one branch -----------------------------------------------------------------------------------


def snaps(case, branch, coarse=None):
    """Snaps of a curve, its states at the end, and how often it was solved again."""
    asked = []

    def again(finer):
        asked.append(finer)
        return states_of(finer, *branch), {}

    solved = states_of(case, *(coarse or branch)), {}
    return continuity.snaps(case, solved, again), solved[0], len(asked)


def onwards_on(branch, steps):
    """Goes on from every state of a curve, and notes from where and through which stops."""

    def onwards(finer, near):
        steps.append((near, finer.path.stops))
        return states_of(finer, *branch)

    return onwards


def refuse(finer):
    raise AssertionError(f"the whole curve is solved again: {finer.path.stops}")


KINK = lambda e: 500 - 4000 * max(e - 0.13, 0), lambda e: -4000.0 * (e > 0.13)


def test_a_bend_is_looked_at_from_the_state_before_it(case):
    """Only there: in quarters of the step, and those of the quarter that bends still."""
    solved, steps = (states_of(case, *KINK), {}), []
    assert continuity.snaps(case, solved, refuse, onwards_on(KINK, steps)) == []
    assert steps[0] == (0.1, pytest.approx((0.125, 0.15, 0.175, 0.2)))
    assert steps[1] == (0.125, pytest.approx((0.13125, 0.1375, 0.14375, 0.15)))


def test_from_the_side_from_which_it_was_reached(make_case):
    """On an isometric path the pressure falls."""
    path = LoadPath(kind="isometric", held=0.1, stops=(0.1, 0.2, 0.3))
    case, steps = make_case(path=path), []

    def states(case):
        found = states_of(case, lambda p: 4000 * max(p - 0.13, 0), lambda p: 0.0)
        found["force_by_pressure"] = np.array([4000.0 * (p > 0.13) for p in case.path.stops])
        return found

    def onwards(finer, near):
        steps.append((near, finer.path.stops))
        return states(finer)

    assert continuity.snaps(case, (states(case), {}), refuse, onwards) == []
    assert steps[0] == (0.2, pytest.approx((0.1, 0.125, 0.15, 0.175)))


@pytest.mark.parametrize("lost", ["unknown", "elsewhere", "unreached"])
def test_a_bend_that_cannot_be_looked_at_so_is_solved_again(case, lost):
    """The start is not known, or does not lead to the state: nothing is taken for granted."""
    runs = []

    def again(finer):
        runs.append(finer)
        return states_of(finer, *KINK), {}

    def onwards(finer, near):
        states = states_of(finer, *KINK)
        states["force"][-1] = {"elsewhere": 0.0, "unreached": math.nan}.get(lost, 0.0)
        return None if lost == "unknown" else states

    assert continuity.snaps(case, (states_of(case, *KINK), {}), again, onwards) == []
    assert runs


def test_a_snap_is_none_the_less_for_steps_from_the_state_before_it(case):
    """Their last quarter leads over it, as the step itself did."""
    snap = lambda e: 500 - 900 * e - 200 * (e > 0.213), lambda e: -900.0

    def again(finer):
        return states_of(finer, *snap), {}

    ((low, high),) = continuity.snaps(case, again(case), again, onwards_on(snap, []))
    assert low < 0.213 < high


@pytest.mark.parametrize(
    ("kind", "held", "near", "far"),
    [("isobaric", 0.3, 0.0, 0.1), ("isometric", 0.1, 0.3, 0.2), ("isotonic", 200.0, 0.2, 0.3)],
)
@pytest.mark.parametrize("model", ["membrane", "solid"])
def test_a_walk_goes_on_from_a_state_that_was_left(
    make_case, mesh_of, tmp_path, monkeypatch, kind, held, near, far, model
):
    """Through a stop in between it comes to the same state; all states are left here."""
    monkeypatch.setattr(continuity, "SHARE", 0.0)
    stops = tuple(sorted((near, far)))
    case = make_case(model=model, path=LoadPath(kind=kind, held=held, stops=stops))
    solver = solve._Solver(Means(mesh_of(case), tmp_path / "log", LIMITS, math.inf))
    (states, _), _, _ = solver.curve(case)
    ahead = tuple(sorted(((near + far) / 2, far)))
    found = solver.onwards(replace(case, path=replace(case.path, stops=ahead)), near)
    for name in ("force", "contraction", "volume"):
        expected = states[name][stops.index(far)]
        assert found[name][ahead.index(far)] == pytest.approx(expected, rel=1e-7)
    assert solver.onwards(case, far) is None  # no gap follows it


def test_near_stops_leave_nothing(make_case, mesh_of, tmp_path):
    path = LoadPath(kind="isobaric", held=0.3, stops=tuple(k / 100 for k in range(26)))
    case = make_case(model="membrane", path=path)
    solver = solve._Solver(Means(mesh_of(case), tmp_path / "log", LIMITS, math.inf))
    solver.curve(case)
    assert not solver._starts


def test_what_follows_its_derivative_is_not_solved_again(case):
    assert snaps(case, (lambda e: 500 - 900 * e, lambda e: -900.0))[::2] == ([], 0)


def test_a_curve_that_bends_between_far_stops_is_one_branch(case):
    """A kink like that of threads that become taut."""
    found, states, runs = snaps(case, KINK)
    assert found == []
    assert 1 <= runs <= continuity.ROUNDS
    np.testing.assert_array_equal(states["force"], [KINK[0](e) for e in STOPS])


def test_an_infinite_slope_at_a_stop_is_no_snap(case):
    """Rigid threads leave their cylinder so: the force falls by the root of the contraction."""
    root = lambda e: 878 - 1500 * math.sqrt(e), lambda e: -750 / math.sqrt(max(e, 1e-12))
    assert snaps(case, root)[0] == []


@pytest.mark.parametrize("stops", [(0.0, 0.025, 0.05, 0.15), (0.0, 0.1, 0.2)])
def test_a_net_of_rigid_threads_is_one_branch(make_case, solve_case, stops):
    path = LoadPath(kind="isobaric", held=0.3, stops=stops)
    rigid = make_case(model="cylinder", path=path, effects=Effects(stretch="rigid"))
    assert solve_case(rigid).state_status == [CONVERGED] * len(stops)


def test_a_snap_stays_and_is_found_where_it_is(case):
    found, _, _ = snaps(case, (lambda e: 500 - 900 * e - 200 * (e > 0.213), lambda e: -900.0))
    ((low, high),) = found
    assert low < 0.213 < high
    assert high - low < 0.002
    assert continuity.behind(case, found) == {3, 4}


def test_a_state_of_another_branch_is_replaced_by_that_of_finer_steps(case):
    branch = lambda e: 500 - 900 * e, lambda e: -900.0
    astray = lambda e: 500 - 900 * e - 200 * (e == 0.2), lambda e: -900.0
    found, states, _ = snaps(case, branch, astray)
    assert found == []
    np.testing.assert_allclose(states["force"], [500 - 900 * e for e in STOPS])


@pytest.mark.parametrize(("kind", "expected"), [("isometric", {0}), ("isotonic", {1, 2})])
def test_behind_is_by_the_way_to_the_stops(make_case, kind, expected):
    """From the highest pressure down, or up."""
    path = LoadPath(kind=kind, held=0.1, stops=(0.1, 0.2, 0.3))
    assert continuity.behind(make_case(path=path), [(0.12, 0.13)]) == expected


@pytest.mark.parametrize("model", ["cylinder", "membrane", "solid"])
@pytest.mark.parametrize("kind", ["isobaric", "isometric", "isotonic"])
def test_recorded_derivatives_are_those_of_the_curve(make_case, solve_case, model, kind):
    held, stops = {
        "isobaric": (0.3, (0.05, 0.055, 0.06)),
        "isometric": (0.1, (0.2, 0.205, 0.21)),
        "isotonic": (200.0, (0.3, 0.305, 0.31)),
    }[kind]
    case = make_case(model=model, path=LoadPath(kind=kind, held=held, stops=stops))
    x, value, slope = continuity.free_quantity(case, solve_case(case).states)
    assert slope[1] == pytest.approx((value[2] - value[0]) / (x[2] - x[0]), rel=1e-3)


# --- behind what is lost --------------------------------------------------------------------------


@pytest.fixture
def curve_by(case, monkeypatch, tmp_path):
    """Solves the case where each way, in turn, turns inside out at some stops."""

    def run(*invalid):
        turns = iter(invalid)

        def follow(case, _way, _means, states, _fields, _start):
            bad = next(turns)
            for name, values in states_of(case, lambda e: 500 - 900 * e, lambda e: -900.0).items():
                states[name][:] = values
            states["min_det_f"][list(bad)] = -1
            return End(None, "", None, 100)

        monkeypatch.setattr(solve, "follow", follow)
        solver = solve._Solver(Means(tmp_path / "mesh", tmp_path / "log", LIMITS, 1.0))
        (states, _), end, lost = solver.curve(case)
        return judged(case, states, reason=end.reason, lost=lost)

    return run


def test_behind_an_invalid_state_nothing_is_converged(curve_by):
    solution = curve_by({2}, {4})  # from either side only to the far end
    assert solution.status is CaseStatus.INVALID_STATE
    assert solution.state_status == [CONVERGED, CONVERGED, INVALID, INVALID, INVALID]
    assert "det F at a quadrature point is -1" in solution.notes[2]
    assert "reached through a state that is turned inside out" in solution.notes[3]
    assert "3 of 5 states" in solution.reason


def test_unless_it_is_reached_from_the_other_side(curve_by):
    solution = curve_by({2}, {2})
    assert solution.state_status == [CONVERGED, CONVERGED, INVALID, CONVERGED, CONVERGED]
    assert curve_by(set()).state_status == [CONVERGED] * 5


def test_the_way_back_reaches_the_same_states(make_case, solve_case, walk):
    """Shortened first, then pressurised."""
    path = LoadPath(kind="isobaric", held=0.3, stops=(0.0, 0.1))
    case = make_case(model="solid", path=path)
    back = [row["force"] for row in walk(case, path.way_back())]
    np.testing.assert_allclose(back[::-1], solve_case(case).states["force"], rtol=1e-7)


def test_every_state_that_is_not_converged_says_why(case):
    states = states_of(case, lambda e: 500 - 900 * e, lambda e: -900.0)
    for name in VARIABLES:
        states[name][4] = np.nan
    states["unstable_modes"][1], states["margin"][2] = 2, -0.1
    solution = judged(case, states, reason="fold of the contraction at 0.27")
    assert solution.status is CaseStatus.LIMIT_POINT
    assert solution.notes == [
        "",
        "2 unstable modes at fixed contraction and pressure",
        "turned inside out: the smallest margin is -0.1",
        "",
        "fold of the contraction at 0.27",
    ]
