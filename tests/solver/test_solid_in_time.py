"""Cycles and vibrations of the solid: against cylinder and membrane, limits, balance, fields."""

from dataclasses import replace

import numpy as np
import pytest

from geometry.mesh_settings import SectionMesh
from solver import balance
from solver.case import DYNAMIC
from solver.effects import Effects
from solver.history import History, Start, Valve, Wave, sampled, through
from solver.load_path import LoadPath
from solver.memory import Memory
from solver.numerics import Numerics
from solver.rubber.mooney_rivlin.law import MooneyRivlin
from solver.rubber.yeoh.law import Yeoh

FLAT = Memory.flat(0.06, 1e-3, 1e3)
LONG = Numerics(section=SectionMesh(cap_step=10, body_step=20, growth=2))  # nothing changes along Z
COARSE = Numerics(section=SectionMesh(cap_step=2, body_step=10, growth=2))
FINE_WALL = Numerics(section=replace(LONG.section, rows=(2, 2, 4)))
TUBE = {"effects": Effects(end="sliding", volume="incompressible"), "numerics": LONG}


def cycles(samples, *, count=1, end=0.2, rate=0.1, memory=FLAT, **history):
    period = 2 * end / rate
    times, stops = sampled(Wave.TRIANGLE, 0, end, period, count, samples)
    timed = History(times=times, period=period, **history)
    path = LoadPath(kind="isobaric", held=0.3, stops=stops, history=timed)
    return {"model": "solid", "path": path, "memory": memory}


def width(states, samples):
    """Of the loop of the last cycle at 10 %, straight between its states [N]."""
    e, f = (states[name][-samples - 1 :] for name in ("contraction", "force"))
    there, back = slice(samples // 2 + 1), slice(samples // 2, None)
    return np.interp(0.1, e[back][::-1], f[back][::-1]) - np.interp(0.1, e[there], f[there])


def test_a_piece_of_an_infinite_tube_is_the_cylinder(make_case, solve_case):
    """Three cycles of 50, 8.649 N; its force and energies too are those of the cylinder."""
    given = cycles(50, count=3)
    tube = solve_case(make_case(**given, **TUBE))
    assert tube.status == "converged", tube.reason
    assert width(tube.states, 50) == pytest.approx(8.649, rel=6e-4)
    cylinder = solve_case(make_case(**(given | {"model": "cylinder"}))).states
    for name in ("force", "energy", "dissipated", "work"):
        largest = np.max(np.abs(cylinder[name]))
        np.testing.assert_allclose(tube.states[name], cylinder[name], atol=1e-6 * largest)


def test_its_vibrations_are_those_of_the_cylinder(make_case, solve_case):
    path = LoadPath(kind="isobaric", held=0.3, stops=(0.1,))
    given = {"model": "solid", "path": path, "memory": FLAT, "frequencies": (0.1, 1.0, 10.0)}
    rows = solve_case(make_case(**given, **TUBE)).fields[0][DYNAMIC]
    assert rows[:, 1] == pytest.approx([10.60006, 10.83892, 11.07638], abs=1e-5)
    assert rows[:, 2] == pytest.approx([0.16595, 0.16486, 0.16242], abs=6e-6)
    clamped = solve_case(make_case(**given)).fields[0][DYNAMIC]
    membrane = solve_case(make_case(**(given | {"model": "membrane"}))).fields[0][DYNAMIC]
    np.testing.assert_allclose(clamped[:, 1:], membrane[:, 1:], rtol=0.015)


@pytest.mark.parametrize(("rate", "stiffer"), [(1e12, 1.42), (1e-12, 1.0)])
def test_both_limits(make_case, solve_case, nbr, rate, stiffer):
    """As fast, and as slow, as can be the rubber is elastic."""
    given = cycles(2, end=0.1, rate=rate, start=Start.UNLOADED)
    found = solve_case(make_case(**given)).states["force"][1]
    rubber = MooneyRivlin(c10=stiffer * nbr.c10, c01=stiffer * nbr.c01)
    elastic = solve_case(make_case(model="solid", rubber=rubber)).states["force"][0]
    assert found == pytest.approx(elastic, rel=1e-6)


def test_energy_is_balanced_to_second_order(make_case, solve_case):
    """Loops are 1 % wider than the membrane's; some energy is lost in every step."""
    left = []
    for samples in (20, 40):
        case = make_case(**cycles(samples))
        solution = solve_case(case)
        assert solution.status == "converged", solution.reason
        assert np.all(np.diff(solution.states["dissipated"]) > 0)
        left.append(balance.errors(case, solution.states)[-1][0])
    assert left[0] / left[1] == pytest.approx(4, rel=0.2)
    membrane = solve_case(make_case(**(cycles(40) | {"model": "membrane"}))).states
    assert width(solution.states, 40) / width(membrane, 40) == pytest.approx(1.0116, abs=1e-3)


def test_a_history_agrees_with_an_eighth_of_the_step(make_case, solve_case):
    """No wave, of several amplitudes, and held for a while; on a coarse mesh."""
    rows = ((0, 0.02), (0.4, 0.15), (1.2, 0.15), (2.0, 0.05), (2.8, 0.12), (4, 0.02))
    memory = Memory(shares=(0.1, 0.1, 0.2), times=(0.3, 3.0, 30.0))

    def force(steps):
        times = tuple(4.0 * k / steps for k in range(steps + 1))
        stops = through(rows, times)
        path = LoadPath(kind="isobaric", held=0.3, stops=stops, history=History(times=times))
        case = make_case(model="solid", path=path, memory=memory, numerics=COARSE)
        states = solve_case(case).states
        assert np.all(np.diff(states["dissipated"]) >= 0)
        return states["force"][:: steps // 10]

    coarse, middle, fine = force(20), force(40), force(160)
    first, second = (np.max(np.abs(values - fine)) for values in (coarse, middle))
    assert second < 2e-4 * np.max(np.abs(fine))
    assert first / second == pytest.approx(4, rel=0.25)


def test_a_law_of_which_the_branches_are_neo_hookean(make_case, solve_case):
    """Yeoh's, with a reference time: of it the long-term part is less than one."""
    memory = Memory.flat(0.06, 1e-3, 1e3, reference_time=60)
    given = cycles(20, memory=memory) | {"rubber": Yeoh(c1=0.4, c2=0.02, c3=0.001)}
    tube = solve_case(make_case(**given, **TUBE)).states
    cylinder = solve_case(make_case(**(given | {"model": "cylinder"}))).states
    for name in ("force", "energy", "dissipated"):
        largest = np.max(np.abs(cylinder[name]))
        np.testing.assert_allclose(tube[name], cylinder[name], atol=1e-6 * largest)


def test_fields_on_both_branches(make_case, solve_case):
    """Shape and stress at equal contraction, shortening and lengthening."""
    solution = solve_case(make_case(**cycles(8), fields_at=(0.1,)))
    assert sorted(solution.fields) == [2, 6]
    there, back = (solution.fields[k] for k in (2, 6))
    assert 1e-4 < np.max(np.abs(there["corners"][:, 2] - back["corners"][:, 2])) < 0.5
    hoop = [fields["stress"][:, 3] for fields in (there, back)]
    assert 1e-3 < np.median(np.abs(hoop[0] - hoop[1])) < 0.1


def test_the_stress_of_the_branches_is_in_the_fields(make_case, solve_case):
    """On both ways the radial stress of a tube is the pressure inside, and none outside."""
    given = cycles(8) | {"fields_at": (0.1,)}
    solution = solve_case(make_case(**(given | TUBE | {"numerics": FINE_WALL})))
    hoop = []
    for stop in (2, 6):
        corners, stress = (solution.fields[stop][name] for name in ("corners", "stress"))
        inside, outside = (np.isclose(corners[:, 0], radius) for radius in (10, 12))
        assert np.mean(stress[inside, 0]) == pytest.approx(-0.3, abs=2e-4)
        assert np.mean(stress[outside, 0]) == pytest.approx(0, abs=2e-4)
        hoop.append(np.mean(stress[inside, 3]))
    assert hoop[0] - hoop[1] > 0.02


def test_a_mass_on_a_valve(make_case, solve_case):
    """The tube moves as the cylinder, which is another program."""
    times = tuple(round(0.004 * k, 9) for k in range(26))
    history = History(times=times, mass=5.0, valve=Valve(conductance=1e7))
    path = LoadPath(kind="isotonic", held=49.03325, stops=(0.0, *[0.3] * 25), history=history)
    given = {"path": path, "memory": FLAT}
    tube = solve_case(make_case(model="solid", **given, **TUBE)).states
    cylinder = solve_case(make_case(model="cylinder", **given)).states
    assert tube["contraction"][0] == pytest.approx(-0.007765, abs=1e-6)
    assert tube["contraction"][-1] > 0.08
    for name in ("contraction", "pressure"):
        np.testing.assert_allclose(tube[name], cylinder[name], atol=1e-6)
