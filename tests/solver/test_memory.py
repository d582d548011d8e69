"""A rubber with a memory: its spectrum, its steps, and small strains against the Prony series."""

import math

import numpy as np
import pytest

from solver.memory import Memory, weights
from solver.models.cylinder.mechanics import Cylinder
from solver.models.cylinder.wall_memory import WallMemory, principal
from solver.refusal import UnsolvableCase

THREE = Memory(shares=(0.1, 0.2, 0.15), times=(0.1, 1.0, 10.0))
MODULUS = 6 * (0.345083 + 0.083805)  # of NBR in tension [MPa]


def test_a_flat_spectrum_has_a_branch_a_decade():
    memory = Memory.flat(0.06, 1e-3, 1e3)
    assert memory.times == (1e-3, 1e-2, 0.1, 1, 10, 100, 1000)
    assert memory.shares == (0.06,) * 7
    assert sum(Memory.flat(0.06, 1e-3, 5e2).shares) == pytest.approx(0.06 * math.log10(5e5) * 7 / 6)


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"shares": (), "times": ()}, "shares = () is refused"),
        ({"shares": (0.1, -0.1), "times": (1.0, 2.0)}, "shares = -0.1"),
        ({"shares": (0.1,), "times": (1.0, 2.0)}, "as many as shares, 1"),
        ({"shares": (0.1,), "times": (math.inf,)}, "times = inf"),
        ({"shares": (0.1,), "times": (1.0,), "reference_time": 0}, "reference_time = 0"),
    ],
)
def test_what_is_no_memory(values, said):
    with pytest.raises(UnsolvableCase) as refused:
        Memory(**values)
    assert said in str(refused.value)


def test_a_spectrum_that_ends_before_it_begins():
    with pytest.raises(UnsolvableCase, match="to = 1"):
        Memory.flat(0.06, 10, 1)


def test_weights_are_one_together_and_go_over_into_a_series():
    steps = np.array([0.0, 1e-9, 0.99e-4, 1.01e-4, 0.1, 1.0, 1e9])
    np.testing.assert_allclose(sum(weights(steps)), 1, rtol=0, atol=1e-12)
    near = np.array([0.999999e-4, 1.000001e-4])
    for values in weights(near):
        assert values[0] == pytest.approx(values[1], rel=1e-5)


def uniaxial(memory, nbr, strains, step):
    """Stress along a pull by some strains, of a wall that was at rest [MPa]."""
    wall = WallMemory(memory, nbr.branch, np.ones(1))
    stresses = []
    for strain in strains[1:]:
        b = np.array([(1 + strain) ** 2])
        a = b**-0.5
        wall.freeze(step)
        by_a, by_b, _ = nbr.slopes(a, float(b[0]), np.zeros(1))
        over_a, over_b = wall.slopes(a, b)
        along = (by_b + over_b) - (by_a + over_a) * a / (2 * b)  # dA = -A/(2B) dB
        stresses.append(2 * float(along[0]) * math.sqrt(b[0]))
        wall.advance(principal(a, b))
    return np.array(stresses)


def test_small_vibrations_are_those_of_the_prony_series(nbr):
    """3.379995 + 0.274605i MPa."""
    exact = MODULUS * (1 + THREE.modulus(2 / (2 * math.pi)))
    assert exact.real == pytest.approx(3.379995, abs=1e-6)
    assert exact.imag == pytest.approx(0.274605, abs=1e-6)
    errors = []
    for samples in (16, 32):
        step = math.pi / samples
        at = step * np.arange(50 * samples + 1)
        stress = uniaxial(THREE, nbr, 1e-4 * np.sin(2 * at), step)[-samples:]
        turn = 2 * at[-samples:]
        storage, loss = (2e4 * np.mean(stress * wave(turn)) for wave in (np.sin, np.cos))
        errors.append(complex(storage, loss) - exact)
    assert abs(errors[0]) < 0.01
    assert abs(errors[0]) / abs(errors[1]) == pytest.approx(4, rel=0.1)


def test_a_held_strain_relaxes_exactly_whatever_the_steps(make_case):
    """1 + 0.2 exp(-2) + 0.1 exp(-0.2) = 1.1089401320 of the long-term force after 2 s."""
    cylinder = Cylinder(make_case(model="cylinder"))
    long_term = cylinder._forces(14, 0.9, 0.0, threads=False)
    memory = Memory(shares=(0.2, 0.1), times=(1.0, 10.0))
    cylinder.memory = WallMemory(memory, cylinder.case.rubber.branch, cylinder.measure)
    held = principal(cylinder.hoop(14, 0.9) ** 2, 0.81)
    for steps in ((0.0, 2.0), (0.0, 0.1, 0.4, 1.5)):
        cylinder.memory.rest(np.ones_like(held))
        for step in steps:
            cylinder.memory.freeze(step)
            now = cylinder._forces(14, 0.9, 0.0, threads=False)
            cylinder.memory.advance(held)
        assert now[0] / long_term[0] == pytest.approx(1.1089401320, abs=1e-10)
        assert now[1] / long_term[1] == pytest.approx(1.1089401320, abs=1e-10)


def test_stored_energy_and_dissipation_of_a_wall_at_rest_are_none(nbr):
    c = principal(np.array([1.3, 0.9]), 1.1)
    wall = WallMemory(THREE, nbr.branch, np.array([2.0, 3.0]))
    wall.rest(c)
    assert wall.stored == pytest.approx(0, abs=1e-15)
    assert wall.dissipation == pytest.approx(0, abs=1e-15)
    assert np.max(np.abs(wall.slopes(c[0], c[1]))) < 1e-15
    wall.freeze(0.1)
    wall.advance(principal(np.array([1.0, 1.0]), 1.0))
    assert wall.stored > 0
    assert wall.dissipation > 0


def test_slopes_and_their_derivatives(nbr):
    wall = WallMemory(THREE, nbr.branch, np.ones(1))
    wall.rest(principal(np.array([1.2]), 0.8))
    wall.freeze(0.3)
    at, h = np.array([1.1, 0.9]), 1e-6

    def slopes(a, b):
        return np.ravel(wall.slopes(np.array([a]), np.array([b])))

    by_a = (slopes(at[0] + h, at[1]) - slopes(at[0] - h, at[1])) / (2 * h)
    by_b = (slopes(at[0], at[1] + h) - slopes(at[0], at[1] - h)) / (2 * h)
    aa, ab, bb = np.ravel(wall.hessian(np.array([at[0]]), np.array([at[1]])))
    assert by_a == pytest.approx([aa, ab], rel=1e-8)
    assert by_b == pytest.approx([ab, bb], rel=1e-8)


def test_constants_of_a_test_that_took_a_minute(nbr):
    """After that time, held, the rubber bears what its constants say."""
    memory = Memory.flat(0.06, 1e-3, 1e3, reference_time=60)
    wall = WallMemory(memory, nbr.branch, np.ones(1))
    wall.freeze(0.0)
    wall.advance(principal(np.array([1.5]), 0.9))
    wall.freeze(60.0)
    over = wall.slopes(np.array([1.5]), 0.9)[0]
    law = nbr.slopes(np.array([1.5]), 0.9, np.zeros(1))[0]
    assert memory.long_term * law + over == pytest.approx(law, rel=1e-12)
