"""The state of zero force: enclosed, the lowest, where the muscle pulls above it; or not there."""

import math

import numpy as np
import pytest

from geometry.muscle import Braid, Muscle
from solver.effects import Effects
from solver.load_path import Control, LoadPath
from solver.material import Thread
from solver.rubber.mooney_rivlin.law import MooneyRivlin
from solver.status import CaseStatus, StateStatus
from solver.zero_force import Finder, Point, Search

MODELS = ["cylinder", "membrane", "solid"]

# --- the search itself, on explicit functions ----------------------------------------------------


def found_on(
    force,
    slope,
    points,
    *,
    low=0.0,
    high=1.0,
    step=0.01,
    ends=(-math.inf, math.inf),
    threads_push=False,
):
    """Finds the zero of a function over pressure; there are no states outside ``ends``."""
    search = Search(Control.CONTRACTION, 0.1, Control.PRESSURE, low, high, step, threads_push)

    def point(x):
        return Point(x=x, g=force(x), slope=slope(x), unloaded=False, position=x)

    def polish(start):
        x = start.x
        for _ in range(20):
            x -= force(x) / slope(x)
        return point(x) if ends[0] <= x <= ends[1] else None

    walk = lambda start, x: point(min(max(x, ends[0]), ends[1]))  # noqa: E731
    finder = Finder(search, [point(x) for x in points], walk, polish)
    return finder.find(), finder


def cubic(*roots):
    """Rises at the first and third root, falls at the second."""
    curve = np.polynomial.Polynomial.fromroots(roots)
    return curve, curve.deriv()


@pytest.mark.parametrize(
    "points", [(0.1, 0.5), (0.3,), (0.05, 0.1), (0.9,), (0.2, 0.21), (0.0, 0.2, 1.0)]
)
def test_one_zero_inside_or_outside_of_the_points(points):
    found, finder = found_on(
        lambda x: math.tanh(9 * (x - 0.2)), lambda x: 9 / math.cosh(9 * (x - 0.2)) ** 2, points
    )
    assert found.x == pytest.approx(0.2, abs=1e-9)
    assert len(finder.known) - len(points) < 12


@pytest.mark.parametrize(
    "points",
    [(0.05, 0.2), (0.05, 0.15, 0.6, 0.9), (0.2,), (0.2, 0.25), (0.05, 0.5), (0.05,), (0.5,)],
)
def test_of_several_the_lowest_that_rises(points):
    found, _ = found_on(*cubic(0.1, 0.3, 0.8), points)
    assert found.x == pytest.approx(0.1, abs=1e-9)


def test_a_wave_between_two_points_is_not_overlooked():
    """Falling at both of them, with three extrema between."""
    curve = np.polynomial.Polynomial.fit(
        [0.0, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5], [-0.4, -0.6, 0.0, 0.5, 0.0, -0.4, -0.8], 6
    )
    found, _ = found_on(curve, curve.deriv(), (0.01, 0.45))
    assert curve.deriv()(0.01) < 0
    assert curve.deriv()(0.45) < 0
    assert found.x == pytest.approx(0.1, abs=1e-9)


def test_a_zero_that_falls_is_none():
    found, finder = found_on(lambda x: 0.3 - x, lambda x: -1.0, (0.1, 0.5))
    assert finder.range == (0.0, 0.5)
    assert found.x == 0.0  # shortened and without pressure, it pulls by the smoothing alone


@pytest.mark.parametrize(("threads_push", "expected"), [(False, 0.0), (True, 0.27)])
def test_what_pulls_without_pressure_is_the_smoothing_unless_threads_push(threads_push, expected):
    """Then it is a wall that has crumpled, and the threshold is where the force rises."""
    points = (0.05, 0.1, 0.2, 0.3)
    found, _ = found_on(*cubic(-0.5, 0.02, 0.27), points, threads_push=threads_push)
    assert found.x == pytest.approx(expected, abs=1e-9)


def test_a_jump_is_no_zero():
    found, _ = found_on(lambda x: math.copysign(1 + x, x - 0.2), lambda x: 1.0, (0.1, 0.5))
    assert found is None


def test_where_the_branch_ends_there_is_none():
    found, finder = found_on(lambda x: x - 0.2, lambda x: 1.0, (0.1,), ends=(0, 0.15))
    assert found is None
    assert finder.range[1] == 0.15


def test_a_point_with_a_millionth_of_the_largest_force_is_one():
    found, _ = found_on(lambda x: x - 0.2 + 1e-9, lambda x: 1.0, (0.1, 0.2, 0.5))
    assert found.x == 0.2


# --- muscles -------------------------------------------------------------------------------------


@pytest.fixture
def zero(make_case, solve_case):
    """Value, status and note of the state of zero force of a case, whose stops are converged."""

    def state(model, kind, held, stops, case_status=CaseStatus.CONVERGED, **changes):
        path = LoadPath(kind=kind, held=held, stops=stops, zero_force=True)
        solution = solve_case(make_case(model=model, path=path, **changes))
        assert solution.status is case_status, solution.reason
        swept = "contraction" if kind == "isobaric" else "pressure"
        return solution.states[swept][-1], solution.state_status[-1], solution.notes[-1]

    return state


@pytest.fixture
def wide():
    """Twice as wide as the muscle of the paper, with a flat braid."""
    braid = Braid.from_angle(angle=32.61, threads=79, layer_diameters=(43.762, 45.564))
    return {
        "muscle": Muscle(
            inner_diameter=42.86, wall_thickness=3.004, length=412.3, braid=braid, cap_length=12
        ),
        "rubber": MooneyRivlin(c10=0.4843, c01=0.1549),
        "thread": Thread(stiffness=566.3),
    }


@pytest.mark.parametrize(
    ("model", "expected", "status"),
    [
        ("cylinder", 0.10437, CaseStatus.CONVERGED),
        ("membrane", 0.10576, CaseStatus.LIMIT_POINT),  # without pressure it crumples
        ("solid", 0.10762, CaseStatus.CONVERGED),  # by another code
    ],
)
def test_a_wide_muscle(zero, wide, model, expected, status):
    """From its highest pressure Newton's method alone ends far above."""
    value, of_state, note = zero(model, "isometric", 0.08, (0.0, 0.1254), status, **wide)
    assert value == pytest.approx(expected, rel=2e-3)
    assert (of_state, note) == (StateStatus.CONVERGED, "")


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize(
    "stops", [(0.3,), (0.05, 0.3), (0.05, 0.1), (0.14, 0.2), (0.0, 0.6), (0.01,)]
)
def test_the_threshold_is_the_same_whatever_the_stops(zero, make_case, solve_case, model, stops):
    """Also where all stops lie on one side of it; a membrane has no state at the lowest."""
    near = zero(model, "isometric", 0.1, (0.2,))[0]
    path = LoadPath(kind="isometric", held=0.1, stops=stops, zero_force=True)
    solution = solve_case(make_case(model=model, path=path))
    assert solution.states["pressure"][-1] == pytest.approx(near, rel=1e-7)
    assert solution.state_status[-1] is StateStatus.CONVERGED
    assert solution.notes[-1] == ""  # also where no stop was reached: its force is none


def test_a_stop_at_the_threshold_is_it(zero):
    near = zero("solid", "isometric", 0.1, (0.2,))[0]
    assert zero("solid", "isometric", 0.1, (float(near), 0.3))[0] == pytest.approx(near, rel=1e-8)


@pytest.mark.parametrize("model", MODELS)
def test_where_only_the_smoothing_pulls_the_threshold_is_zero(zero, model):
    """At the initial length, and just below; taut threads pull without pressure, so there none."""
    for contraction in (0.0, 0.0005):
        value, status, note = zero(model, "isometric", contraction, (0.05, 0.1))
        assert str(float(value)) == "0.0"  # no rounding, and no sign
        assert status is StateStatus.CONVERGED
        assert "smoothing of the slack law" in note
    value, status, note = zero(model, "isometric", -0.02, (0.05, 0.1))
    assert np.isnan(value)
    assert status is StateStatus.NO_ROOT
    assert note == "no change of sign from 0 to 0.1 MPa"


def test_a_wall_that_has_crumpled_under_threads_that_push_has_no_threshold_there(zero):
    effects = Effects(threads="two_way")
    crumpled = CaseStatus.INVALID_STATE  # at 0.05 MPa
    value, status, _ = zero("solid", "isometric", 0.2, (0.05, 0.2, 0.3), crumpled, effects=effects)
    assert value == pytest.approx(0.2706, abs=5e-4)
    assert status is StateStatus.CONVERGED


@pytest.mark.parametrize("model", ["cylinder", "solid"])
def test_two_way_threads_have_no_smoothing(zero, model):
    effects = Effects(threads="two_way")
    value, status, note = zero(model, "isometric", 0.0, (0.05, 0.1), effects=effects)
    assert value == pytest.approx(0, abs=1e-9)
    assert (status, note) == (StateStatus.CONVERGED, "")


@pytest.mark.parametrize("model", ["cylinder", "solid"])
def test_a_muscle_without_pressure_is_free_at_its_length(zero, model):
    value, status, note = zero(model, "isobaric", 0.0, (0.05, 0.1))
    assert value == pytest.approx(0, abs=1e-12)
    assert status is StateStatus.CONVERGED
    assert "smoothing" in note


@pytest.mark.parametrize(
    ("model", "expected"), [("cylinder", 0.2170235), ("membrane", 0.2149519), ("solid", 0.2125266)]
)
@pytest.mark.parametrize("stops", [(0.1,), (0.0, 0.25), (-0.02, 0.1), (0.24,)])
def test_the_free_contraction_is_the_same_whatever_the_stops(zero, model, stops, expected):
    assert zero(model, "isobaric", 0.3, stops)[0] == pytest.approx(expected, abs=1e-7)


@pytest.mark.parametrize("model", ["cylinder", "solid"])
def test_a_bare_tube_has_no_threshold(zero, bare_tube, model):
    """Its force falls with pressure; at the initial length it is zero without."""
    effects = Effects(end="sliding") if model == "solid" else Effects()
    tube = {"muscle": bare_tube, "effects": effects}
    value, status, note = zero(model, "isometric", 0.0, (0.05, 0.1), **tube)
    assert np.isnan(value)
    assert status is StateStatus.NO_ROOT
    assert note.startswith("no change of sign from 0 to 0.15")


@pytest.mark.parametrize("stops", [(0.0, 0.8), (0.03, 0.7), (0.5,), (0.1, 0.3, 0.5, 0.7)])
@pytest.mark.parametrize("model", ["cylinder", "solid"])
def test_a_soft_muscle_pulls_between_two_zeros(zero, model, stops):
    """It pushes again at high pressure; stops on both sides of both zeros hide them."""
    braid = Braid.from_angle(angle=21, threads=60, layer_diameters=(21.2, 23.6))
    soft = {
        "muscle": Muscle(
            inner_diameter=20, wall_thickness=4, length=100, braid=braid, cap_length=16
        ),
        "rubber": MooneyRivlin(c10=0.028, c01=0.01),
        "thread": Thread(stiffness=80),
    }
    near = zero(model, "isometric", 0.17, (0.03, 0.06), **soft)[0]
    assert 0.03 < near < 0.06
    assert zero(model, "isometric", 0.17, stops, **soft)[0] == pytest.approx(near, rel=1e-6)


def test_stops_do_not_depend_on_the_search(make_case, solve_case):
    """To the tolerance of Newton's method bitwise the same muscle states."""
    curves = [
        solve_case(
            make_case(
                model="solid",
                path=LoadPath(kind="isometric", held=0.1, stops=(0.1, 0.2, 0.3), zero_force=zero),
            )
        ).states["force"][:3]
        for zero in (False, True)
    ]
    np.testing.assert_array_equal(*curves)
