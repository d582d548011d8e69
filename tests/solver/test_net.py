"""Eq. (1) of the paper, by hand."""

import math

import numpy as np
import pytest

from geometry.muscle import Braid, Muscle
from solver import net
from solver.load_path import LoadPath
from solver.material import Thread
from solver.status import CaseStatus, StateStatus

# tan a = pi 21.2 / 144 = 0.4625123, so a = 24.821 deg, cos^2 a = 0.8237792, sin^2 a = 0.1762208
COS2 = 1 / (1 + (math.pi * 21.2 / 144) ** 2)


def test_the_angle_of_the_paper(muscle):
    assert math.degrees(muscle.braid.angle) == pytest.approx(24.8211, abs=5e-5)
    assert math.cos(muscle.braid.angle) ** 2 == pytest.approx(0.8237792, abs=1e-7)
    assert pytest.approx(0.8237792, abs=1e-7) == COS2


@pytest.mark.parametrize(
    ("pressure", "contraction", "force"),
    [
        # p pi 20^2 / (4 sin^2 a) (3 cos^2 a (1 - eps)^2 - 1); at 0.3 MPa the first factor is
        # 94.24778 / 0.1762208 = 534.828 N
        (0.3, 0.0, 786.9119),
        (0.3, 0.1, 535.7814),
        (0.3, 0.25, 208.6509),
        (0.6, 0.1, 1071.5629),
        (0.0, 0.1, 0.0),
    ],
)
def test_force(muscle, pressure, contraction, force):
    assert net.force(muscle, pressure, contraction) == pytest.approx(force, abs=1e-4)


def test_at_the_mean_layer_diameter(muscle):
    ratio = net.force(muscle, 0.3, 0.1, diameter=21.2) / net.force(muscle, 0.3, 0.1)
    assert ratio == pytest.approx((21.2 / 20) ** 2)


def test_four_times_the_force_at_twice_the_diameter(muscle):
    """Claim C7: F(40)/F(20) is 4 at every contraction, if the angle is the same."""
    braid = Braid(lead=144 * 41.2 / 21.2, threads=60, layer_diameters=(40.6, 41.8))
    wide = Muscle(inner_diameter=40, wall_thickness=2, length=300, braid=braid)
    contraction = np.linspace(0, 0.25, 26)
    ratio = net.force(wide, 0.3, contraction) / net.force(muscle, 0.3, contraction)
    np.testing.assert_allclose(ratio, 4)


def test_no_force_at_the_magic_angle(solve_case, make_case):
    """cos a' = 1/sqrt 3: 54.7 deg, whatever the pressure."""
    path = LoadPath(kind="isobaric", held=0.3, stops=(0.0, 0.1), zero_force=True)
    states = solve_case(make_case(model="geometric", path=path)).states
    assert states["contraction"][2] == pytest.approx(1 - 1 / math.sqrt(3 * COS2))
    assert states["contraction"][2] == pytest.approx(0.3639, abs=5e-5)
    assert states["force"][2] == pytest.approx(0, abs=1e-10)


def test_an_isobaric_curve(solve_case, make_case):
    path = LoadPath(kind="isobaric", held=0.3, stops=(0.0, 0.1, 0.25))
    states = solve_case(make_case(model="geometric", path=path)).states
    np.testing.assert_allclose(states["force"], [786.9119, 535.7814, 208.6509], atol=1e-4)
    # D0 sin a' / sin a with cos a' = (1 - eps) cos a
    expected = 20 * np.sqrt((1 - COS2 * np.array([1, 0.9, 0.75]) ** 2) / (1 - COS2))
    np.testing.assert_allclose(states["inner_diameter_inflated"], expected)


def test_force_is_proportional_to_pressure(solve_case, make_case):
    """Claim C3: no threshold."""
    path = LoadPath(kind="isometric", held=0.1, stops=(0.0, 0.1, 0.4), zero_force=True)
    states = solve_case(make_case(model="geometric", path=path)).states
    np.testing.assert_allclose(
        states["force"], 535.7814 / 0.3 * np.array([0, 0.1, 0.4, 0]), rtol=1e-5
    )


def test_an_isotonic_curve_inverts_the_isobaric(solve_case, make_case):
    path = LoadPath(kind="isotonic", held=535.7814, stops=(0.15, 0.3, 0.6))
    solution = solve_case(make_case(model="geometric", path=path))
    assert solution.states["contraction"][1] == pytest.approx(0.1, abs=1e-6)
    assert np.all(np.diff(solution.states["contraction"]) > 0)
    np.testing.assert_allclose(solution.states["force"], 535.7814)


def test_without_pressure_it_carries_no_load(solve_case, make_case):
    path = LoadPath(kind="isotonic", held=100.0, stops=(0.0, 0.3))
    solution = solve_case(make_case(model="geometric", path=path))
    assert solution.state_status == [StateStatus.NOT_REACHED, StateStatus.CONVERGED]
    assert solution.status is not CaseStatus.CONVERGED
    assert "without pressure" in solution.reason


def test_what_it_knows_nothing_of_is_not_a_number(solve_case, make_case):
    states = solve_case(make_case(model="geometric")).states
    for name in ("min_det_f", "volume", "energy", "stiffness", "outer_diameter", "iterations"):
        assert np.isnan(states[name]).all(), name


# --- at the layers --------------------------------------------------------------------------------


@pytest.fixture
def thick(silicone):
    """Threads near the outside of a thick wall: its layers are 38 % wider than its bore."""
    braid = Braid.from_angle(angle=18, threads=24, layer_diameters=(2.76, 2.78))
    muscle = Muscle(inner_diameter=2, wall_thickness=0.4, length=150, cap_length=1.6, braid=braid)
    return {"muscle": muscle, "rubber": silicone, "thread": Thread(stiffness=60)}


def test_at_the_layers_it_bounds_what_the_bore_does_not(make_case, solve_case, thick):
    path = LoadPath(kind="isobaric", held=0.5, stops=(0.0,))
    force = {
        model: solve_case(make_case(model=model, path=path, **thick)).states["force"][0]
        for model in ("geometric", "cylinder", "solid", "geometric_layers")
    }
    assert force["geometric"] == pytest.approx(28.187, abs=1e-3)
    assert force["geometric_layers"] == pytest.approx(28.187 * 1.385**2, abs=1e-2)
    assert force["geometric"] < 0.6 * force["solid"]
    assert 0.9 * force["geometric_layers"] < force["solid"] < force["geometric_layers"]
    assert 0.9 * force["geometric_layers"] < force["cylinder"] < force["geometric_layers"]


def test_at_the_layers_it_is_the_work_of_the_pressure(make_case, solve_case, thick):
    """F = -p dV/dl of the bore, of a wall that keeps its volume: by central differences."""
    contraction, pressure, step = 0.1, 0.5, 1e-4
    path = LoadPath(
        kind="isobaric", held=pressure, stops=(contraction - step, contraction, contraction + step)
    )
    states = solve_case(make_case(model="geometric_layers", path=path, **thick)).states
    length = 150 * (1 - states["contraction"])
    volume = math.pi / 4 * states["inner_diameter_inflated"] ** 2 * length
    slope = (volume[2] - volume[0]) / (length[2] - length[0])
    assert states["force"][1] == pytest.approx(-pressure * slope, rel=1e-6)


@pytest.mark.parametrize("model", ["geometric", "geometric_layers"])
def test_a_load_is_found_again(make_case, solve_case, thick, model):
    path = LoadPath(kind="isotonic", held=10.0, stops=(0.3, 0.5))
    loaded = solve_case(make_case(model=model, path=path, **thick)).states
    for pressure, contraction in zip(path.stops, loaded["contraction"], strict=True):
        back = LoadPath(kind="isobaric", held=pressure, stops=(float(contraction),))
        found = solve_case(make_case(model=model, path=back, **thick)).states["force"][0]
        assert found == pytest.approx(10.0, rel=1e-12)


def test_the_curve_of_the_paper_is_the_same_case(make_case):
    case = make_case(model="geometric")
    assert case.key == "9f0d502a42d51c0d"
    assert make_case(model="geometric_layers").key != case.key
