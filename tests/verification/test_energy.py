"""Force, energy, volume and stiffness of a record belong together.

Pi = energy - p V at a held pressure has dPi/dl = F, and F has dF/dl = stiffness. The contractions
are solved for anew, each to equilibrium; differences are of fourth order.
"""

import numpy as np
import pytest

from solver.effects import Effects
from solver.load_path import LoadPath

CONTRACTION, STEP = 0.1, 2e-3
DIFFERENCE = np.array([1, -8, 0, 8, -1]) / (12 * STEP)  # of values at -2, -1, 0, 1, 2 steps

CASES = {
    "membrane": {"model": "membrane"},
    "membrane two-way": {"model": "membrane", "effects": Effects(threads="two_way")},
    "solid clamp": {"model": "solid", "effects": Effects(end="clamp")},
    "solid butt": {"model": "solid", "effects": Effects(end="butt", threads="two_way")},
    "solid sliding": {"model": "solid", "effects": Effects(end="sliding")},
}


@pytest.fixture(params=CASES)
def states(request, make_case, solve_case):
    """Five states around 10 % contraction at 0.3 MPa, and one without contraction."""
    stops = (0.0, *(round(CONTRACTION + k * STEP, 6) for k in (-2, -1, 0, 1, 2)))
    path = LoadPath(kind="isobaric", held=0.3, stops=stops)
    solution = solve_case(make_case(path=path, **CASES[request.param]))
    assert solution.status == "converged", solution.reason
    return solution.states


@pytest.fixture
def by_length(muscle):
    """Derivative by the length of the muscle at the middle state [1/mm]."""
    return lambda values: -(DIFFERENCE @ values[1:]) / muscle.length


def test_force_is_the_derivative_of_the_potential(states, by_length):
    potential = states["energy"] - states["pressure"] * states["volume"]
    error = abs(by_length(potential) - states["force"][3]) / states["force"][0]
    assert error < 1e-5


def test_stiffness_is_the_derivative_of_the_force(states, by_length):
    # that of the last factorisation, which is one Newton step behind the state
    assert states["stiffness"][3] == pytest.approx(by_length(states["force"]), rel=1e-4)


def test_volume_by_length_is_minus_force_by_pressure(states, by_length):
    """Both are the mixed derivative of Pi."""
    assert -states["force_by_pressure"][3] == pytest.approx(by_length(states["volume"]), rel=1e-4)


def test_all_forces_agree(states):
    """From the motion of the cap, the reaction at the cap and that at mid-length."""
    largest = np.max(np.abs(states["force"]))
    for name in ("force_cap", "force_midplane"):
        np.testing.assert_allclose(states[name], states["force"], rtol=0, atol=1e-6 * largest)


def test_volume_is_the_derivative_of_the_potential_by_pressure(make_case, solve_case):
    """dPi/dp = -V at a held length."""
    pressures = tuple(round(0.3 + k * STEP, 6) for k in (-2, -1, 0, 1, 2))
    path = LoadPath(kind="isometric", held=0.1, stops=pressures)
    states = solve_case(make_case(model="solid", path=path)).states
    potential = states["energy"] - states["pressure"] * states["volume"]
    assert -(DIFFERENCE @ potential) == pytest.approx(states["volume"][2], rel=1e-5)


@pytest.mark.parametrize("model", ["cylinder", "membrane", "solid"])
def test_derivatives_by_pressure(make_case, solve_case, model):
    """Those of force and volume at a held length are those of states on both sides."""
    pressures = tuple(round(0.3 + k * STEP, 6) for k in (-2, -1, 0, 1, 2))
    path = LoadPath(kind="isometric", held=0.1, stops=pressures)
    states = solve_case(make_case(model=model, path=path)).states
    assert states["volume_by_pressure"][2] == pytest.approx(DIFFERENCE @ states["volume"], rel=1e-4)
    assert states["force_by_pressure"][2] == pytest.approx(DIFFERENCE @ states["force"], rel=1e-4)
