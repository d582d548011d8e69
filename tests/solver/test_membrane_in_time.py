"""Cycles and transients of the membrane: checked numbers, both limits, balance, refusals, cost."""

import numpy as np
import pytest

from solver import balance
from solver.history import History, Start, Valve, Wave, sampled
from solver.load_path import LoadPath
from solver.memory import Memory
from solver.refusal import UnsolvableCase
from solver.rubber.mooney_rivlin.law import MooneyRivlin

FLAT = Memory.flat(0.06, 1e-3, 1e3)
G = 9.80665


def cycles(samples, *, count=3, end=0.2, rate=0.1, memory=FLAT, **history):
    period = 2 * end / rate
    times, stops = sampled(Wave.TRIANGLE, 0, end, period, count, samples)
    timed = History(times=times, period=period, **history)
    path = LoadPath(kind="isobaric", held=0.3, stops=stops, history=timed)
    return {"model": "membrane", "path": path, "memory": memory}


def width(states, samples):
    """Of the loop of the last cycle at 10 %, straight between its states [N]."""
    e, f = (states[name][-samples - 1 :] for name in ("contraction", "force"))
    there, back = slice(samples // 2 + 1), slice(samples // 2, None)
    return np.interp(0.1, e[back][::-1], f[back][::-1]) - np.interp(0.1, e[there], f[there])


@pytest.mark.parametrize(("samples", "expected"), [(50, 7.9656), (100, 7.9691), (200, 7.9688)])
def test_width_of_the_third_loop(make_case, solve_case, samples, expected):
    case = make_case(**cycles(samples))
    solution = solve_case(case)
    assert solution.status == "converged", solution.reason
    assert width(solution.states, samples) == pytest.approx(expected, abs=5e-4)
    assert np.all(np.diff(solution.states["dissipated"]) > 0)
    off, lost = balance.errors(case, solution.states)[-1]
    assert abs(off) < 0.025 * lost * (50 / samples) ** 2


@pytest.mark.parametrize(("share", "expected"), [(0.12, 15.695), (0.18, 23.166)])
def test_width_by_the_relaxation(make_case, solve_case, share, expected):
    """Steps of this length make it 6e-4 smaller."""
    case = make_case(**cycles(50, memory=Memory.flat(share, 1e-3, 1e3)))
    found = width(solve_case(case).states, 50)
    assert found == pytest.approx(expected, rel=8e-4)


@pytest.mark.parametrize(
    ("frequency", "wide", "middle"),
    [
        (0.01, 0.00309, 0.1173),
        (0.1, 0.00312, 0.1101),
        (1, 0.00311, 0.1031),
        (10, 0.00306, 0.0964),
    ],
)
def test_contraction_under_a_load(make_case, solve_case, frequency, wide, middle):
    """200 N, 0 to 0.4 MPa and back, three times: width and mean at 0.3 MPa."""
    times, stops = sampled(Wave.TRIANGLE, 0, 0.4, 1 / frequency, 3, 60)
    history = History(times=times, period=1 / frequency)
    path = LoadPath(kind="isotonic", held=200.0, stops=stops, history=history)
    states = solve_case(make_case(path=path, memory=FLAT)).states
    p, e = (states[name][-61:] for name in ("pressure", "contraction"))
    there, back = np.interp(0.3, p[:31], e[:31]), np.interp(0.3, p[30:][::-1], e[30:][::-1])
    assert back - there == pytest.approx(wide, abs=2e-5)
    assert (there + back) / 2 == pytest.approx(middle, abs=1e-4)


def test_contraction_under_a_load_without_memory(make_case, solve_case):
    path = LoadPath(kind="isotonic", held=200.0, stops=(0.3,))
    states = solve_case(make_case(path=path)).states
    assert states["contraction"][0] == pytest.approx(0.1271, abs=5e-5)


@pytest.mark.parametrize(
    ("rate", "stiffer", "force"), [(1e12, 1.42, 172.985465), (1e-12, 1, 274.252883)]
)
def test_both_limits(make_case, solve_case, nbr, rate, stiffer, force):
    """As fast, and as slow, as can be the rubber is elastic."""
    given = cycles(2, count=1, end=0.1, rate=rate, start=Start.UNLOADED)
    found = solve_case(make_case(**given)).states["force"][1]
    assert found == pytest.approx(force, rel=1e-7)
    rubber = MooneyRivlin(c10=stiffer * nbr.c10, c01=stiffer * nbr.c01)
    elastic = solve_case(make_case(rubber=rubber)).states["force"][0]
    assert found == pytest.approx(elastic, rel=1e-6)


def test_one_radius_is_the_cylinder_far_from_the_caps(make_case, solve_case):
    """Loops of both models differ by what caps do: the membrane's is narrower."""
    wide = {}
    for model in ("cylinder", "membrane"):
        states = solve_case(make_case(**(cycles(20, count=1) | {"model": model}))).states
        wide[model] = width(states, 20)
    assert 0.9 < wide["membrane"] / wide["cylinder"] < 0.95


@pytest.mark.parametrize(
    ("memory", "expected", "when"),
    [(None, (20.287, 20.329, 20.338), 0.404), (FLAT, (17.149, 17.201, 17.213), 0.357)],
    ids=["elastic", "with memory"],
)
def test_a_mass_on_a_valve(make_case, solve_case, memory, expected, when):
    """5 kg, a supply of 0.3 MPa through 1e7 mm3/(s MPa): the second crest by 4, 2 and 1 ms."""
    for step, highest in zip((0.004, 0.002, 0.001), expected, strict=True):
        count = round((when + 0.012) / step)
        times = tuple(round(step * k, 9) for k in range(count + 1))
        history = History(times=times, mass=5.0, valve=Valve(conductance=1e7))
        stops = (0.0, *[0.3] * count)
        path = LoadPath(kind="isotonic", held=5 * G, stops=stops, history=history)
        states = solve_case(make_case(path=path, memory=memory)).states
        e = 100 * states["contraction"]
        assert e[0] == pytest.approx(-0.757, abs=5e-4)
        assert np.max(e) == pytest.approx(highest, abs=0.002)
        assert times[int(np.argmax(e))] == pytest.approx(when, abs=2 * step)


def test_a_gas_that_keeps_its_heat_and_a_dead_volume(make_case, solve_case):
    """The membrane and the cylinder, which is another program, fill alike."""
    times = tuple(round(0.005 * k, 9) for k in range(21))
    valve = Valve(conductance=2e6, critical_ratio=0.2, exponent=1.4, dead_volume=2e4)
    history = History(times=times, valve=valve)
    path = LoadPath(kind="isometric", held=0.05, stops=(0.15, *[0.6] * 20), history=history)
    found = [
        solve_case(make_case(path=path, model=model)).states["pressure"]
        for model in ("membrane", "cylinder")
    ]
    assert found[0][-1] > 0.2
    np.testing.assert_allclose(found[0], found[1], rtol=0.03)


@pytest.mark.parametrize("memory", [None, FLAT], ids=["elastic", "with memory"])
def test_rounding_does_not_grow_from_step_to_step(make_case, solve_case, memory):
    """Begun at once, in steps of a millionth of the first, energies balance to the end."""
    times, stops = sampled(Wave.TRIANGLE, 0.25, 0.4, 1.0, 1, 40)
    history = History(times=times, period=1.0, start=Start.UNLOADED)
    path = LoadPath(kind="isometric", held=0.05, stops=stops, history=history)
    case = make_case(path=path, memory=memory)
    states = solve_case(case).states
    moved = np.abs(np.diff(states["work"])).sum()
    ((off, _),) = balance.errors(case, states)
    assert abs(off) < (2e-6 if memory is None else 1e-3) * moved
    if memory is None:
        assert states["volume"][-1] == pytest.approx(states["volume"][0], rel=1e-9)


def test_fields_on_both_branches(make_case, solve_case):
    """The shape at equal contraction, shortening and lengthening."""
    solution = solve_case(make_case(**cycles(8, count=1), fields_at=(0.1,)))
    assert sorted(solution.fields) == [2, 6]
    radius = [solution.fields[k]["meridian"][:, 2] for k in (2, 6)]
    assert 1e-4 < np.max(np.abs(radius[0] - radius[1])) < 0.5


def test_without_pressure_there_is_no_wall_to_shorten(make_case):
    times, stops = sampled(Wave.SINE, 0.0, 0.3, 4.0, 1, 8)
    path = LoadPath(kind="isometric", held=0.1, stops=stops, history=History(times=times))
    with pytest.raises(UnsolvableCase, match="pressures > 0 at a held contraction"):
        make_case(path=path)
    make_case(path=path, model="cylinder")


def test_where_the_membrane_ends_the_history_does(make_case, solve_case):
    """A much stiffer wall stands upright at the cap."""
    memory = Memory.flat(0.24, 1e-3, 1e3)
    solution = solve_case(make_case(**cycles(40, count=1, end=0.3, memory=memory)))
    assert solution.status == "limit_point"
    assert solution.reason.startswith(("overhang", "crumpling"))
    assert "not_reached" in solution.state_status
