"""Membrane and solid against forces and growths that two independent codes agreed on.

NBR, EA = 315 N per thread, kappa = 1000 MPa, muscle 300 mm long. Errors are judged against the
largest force or growth of the curve.
"""

import numpy as np
import pytest

from geometry.mesh_settings import SectionMesh
from solver.effects import Effects
from solver.load_path import LoadPath
from solver.material import Thread
from solver.numerics import Numerics

FINE = Numerics(section=SectionMesh(refinement=2))
CLAMP = Effects(end="clamp", threads="tension_only")
PAPER = Effects(end="butt", threads="two_way")
STOPS = (0.0, 0.05, 0.1, 0.15, 0.2, 0.25)

CURVES = {
    # effects, pressure [MPa], contractions, forces [N], growths of the inner radius [mm]
    "clamp 0.3": (
        CLAMP,
        0.3,
        STOPS,
        (671.42, 438.66, 273.93, 140.94, 26.57, -74.69),
        (1.5619, 3.4606, 5.0561, 6.3857, 7.4932, 8.4143),
    ),
    "clamp 0.6": (CLAMP, 0.6, (0.0, 0.1, 0.2, 0.25), (1328.96, 733.45, 268.03, 66.0), None),
    "butt 0.3": (PAPER, 0.3, (0.0, 0.1, 0.15), (672.48, 272.21, 138.4), (1.5548, 5.0736, 6.411)),
}


@pytest.fixture
def curve(make_case, solve_case):
    """States of a converged isobaric curve."""

    def solve(pressure, stops, **keywords):
        path = LoadPath(kind="isobaric", held=pressure, stops=stops)
        solution = solve_case(make_case(path=path, **keywords))
        assert solution.status == "converged", solution.reason
        return solution.states

    return solve


def assert_near(found, expected, share):
    """Within a share of the curve's largest value."""
    np.testing.assert_allclose(found, expected, rtol=0, atol=share * np.max(np.abs(expected)))


@pytest.mark.parametrize("name", CURVES)
def test_solid(curve, name):
    effects, pressure, stops, forces, growths = CURVES[name]
    states = curve(pressure, stops, model="solid", effects=effects, numerics=FINE)
    assert_near(states["force"], forces, 0.001)
    if growths is not None:
        assert_near(states["inner_diameter_inflated"] / 2 - 10, growths, 0.001)


@pytest.mark.parametrize("name", CURVES)
def test_solid_on_the_default_mesh(curve, name):
    effects, pressure, stops, forces, _ = CURVES[name]
    states = curve(pressure, stops, model="solid", effects=effects)
    assert_near(states["force"], forces, 0.001)


def test_the_solid_converges(curve):
    """Within 0.02 % on the default mesh, and of second order at least.

    The fourth is not reached, as the springs of the clamp have a kink. Errors are so small that the
    order shows in the changes from mesh to mesh only, not against forces of two decimals.
    """
    effects, pressure, stops, forces, _ = CURVES["clamp 0.3"]
    first, second, fourth = (
        curve(pressure, stops, model="solid", effects=effects, numerics=mesh)["force"]
        for mesh in (Numerics(), FINE, Numerics(section=SectionMesh(refinement=4)))
    )
    assert_near(first[:5], forces[:5], 0.0002)
    assert_near(second, forces, 0.0001)
    assert np.all(np.abs(fourth - second)[1:] < np.abs(second - first)[1:] / 4)


def test_clamped_solid_stays_far_from_inversion(curve):
    states = curve(0.3, STOPS, model="solid", effects=CLAMP, numerics=FINE)
    assert states["min_det_f"].min() > 0.76


def test_membrane(curve):
    states = curve(0.3, STOPS, model="membrane")
    assert_near(states["force"], (672.34, 438.56, 274.25, 142.58, 30.44, -65.46), 0.001)
    growths = states["inner_diameter_inflated"] / 2 - 10
    assert_near(growths, (1.5551, 3.4612, 5.0527, 6.3695, 7.4568, 8.3334), 0.001)


def test_membrane_is_near_the_solid(curve):
    """Within 0.3 % of the largest force to 15 %, 0.6 % to 20 %."""
    membrane = curve(0.3, STOPS, model="membrane")["force"]
    solid = curve(0.3, STOPS, model="solid", effects=CLAMP, numerics=FINE)["force"]
    share = np.abs(membrane - solid) / solid[0]
    assert np.all(share[:4] < 0.003)
    assert share[4] < 0.006


@pytest.mark.parametrize(("model", "pressure"), [("cylinder", 0.1346), ("solid", 0.1364)])
def test_threshold_pressure(make_case, solve_case, model, pressure):
    """The pressure below which the muscle pushes at 10 % contraction."""
    path = LoadPath(kind="isometric", held=0.1, stops=(0.1, 0.3), zero_force=True)
    states = solve_case(make_case(model=model, path=path)).states
    assert states["pressure"][2] == pytest.approx(pressure, abs=1e-4)
    assert states["force"][2] == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize(("model", "pressure"), [("membrane", 0.1346), ("solid", 0.1365)])
@pytest.mark.parametrize("stiffness", [315, 20e3])
def test_threshold_pressure_with_stops_below_it(make_case, solve_case, model, pressure, stiffness):
    """Below it the force falls with pressure, and the membrane crumples."""
    path = LoadPath(kind="isometric", held=0.1, stops=(0.05, 0.1, 0.15, 0.3), zero_force=True)
    case = make_case(model=model, path=path, thread=Thread(stiffness=stiffness))
    states = solve_case(case).states
    assert states["pressure"][-1] == pytest.approx(pressure, abs=3e-3)
    assert states["force"][-1] == pytest.approx(0, abs=1e-6)
