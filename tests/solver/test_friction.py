"""Friction of a sleeve's crossings: rate, formula, energies, models, refusals."""

from dataclasses import replace

import numpy as np
import pytest

from geometry.muscle import LayeredBraid, Muscle
from solver import balance
from solver.case import Case
from solver.effects import Effects
from solver.friction import Friction
from solver.history import History, Wave, sampled
from solver.load_path import LoadPath
from solver.memory import Memory
from solver.refusal import UnsolvableCase
from solver.rubber.mooney_rivlin.law import MooneyRivlin

RUBS = Friction(coefficient=0.2, contact=0.4)


def sleeved(muscle, **changes):
    """The muscle of the paper with a sleeve in place of the threads in its wall."""
    layers = {
        "kinds": ("sleeve",),
        "layer_diameters": (24.0,),
        "leads": (160.0,),
        "threads": (60,),
        "senses": (0,),
        "stiffness_shares": (1.0,),
    }
    return replace(muscle, braid=LayeredBraid(**(layers | changes)))


def cycles(muscle, samples=50, *, model="cylinder", pressure=0.3, rate=0.1, count=2, **more):
    period = 0.4 / rate
    times, stops = sampled(Wave.TRIANGLE, 0, 0.2, period, count, samples)
    history = History(times=times, period=period)
    path = LoadPath(kind="isobaric", held=pressure, stops=stops, history=history)
    given = {"model": model, "muscle": sleeved(muscle), "path": path, "friction": RUBS}
    return given | more


def width(states, samples=50, at=0.1):
    """Of the loop of the last cycle, straight between its states [N]."""
    e, f = (states[name][-samples - 1 :] for name in ("contraction", "force"))
    there, back = slice(samples // 2 + 1), slice(samples // 2, None)
    return np.interp(at, e[back][::-1], f[back][::-1]) - np.interp(at, e[there], f[there])


def test_no_rate_enters(make_case, solve_case, muscle):
    found = [
        solve_case(make_case(**cycles(muscle, rate=rate))).states["force"] for rate in (0.01, 1)
    ]
    np.testing.assert_allclose(found[0], found[1], rtol=1e-9)


@pytest.mark.parametrize("contact", [0.2, 0.4])
def test_a_sleeve_that_bears_all_of_the_pressure(make_case, solve_case, muscle, contact):
    """Around next to no rubber, twice 2/3 mu r_c p 2 pi r lz 2 cos(a0)/sin(a): 3 % of it is N."""
    soft = MooneyRivlin(c10=1e-3, c01=1e-4)
    friction = Friction(coefficient=0.2, contact=contact)
    states = solve_case(make_case(**cycles(muscle, rubber=soft, friction=friction))).states
    k = 50 + int(np.argmin(np.abs(states["contraction"][50:75] - 0.1)))
    radius, stretch = states["outer_diameter"][k] / 2, 1 - states["contraction"][k]
    first = np.arctan(np.pi * 24 / 160)
    turned = np.arctan(np.tan(first) * radius / 12 / stretch)
    area = 2 * np.pi * radius * stretch
    formula = 4 / 3 * 0.2 * contact * 0.3 * area * 2 * np.cos(first) / np.sin(turned)
    inner = states["inner_diameter_inflated"][k] / 2 / radius  # the pressure acts there
    assert width(states, at=states["contraction"][k]) == pytest.approx(inner * formula, rel=0.02)


def test_it_grows_with_pressure_where_that_of_rubber_falls(make_case, solve_case, muscle):
    found = [
        width(solve_case(make_case(**cycles(muscle, pressure=p))).states) for p in (0.2, 0.3, 0.4)
    ]
    assert found == pytest.approx([2.315, 5.059, 7.782], abs=2e-3)
    memory = Memory.flat(0.06, 1e-3, 1e3)
    rubber = [
        width(
            solve_case(make_case(**cycles(muscle, pressure=p, friction=None, memory=memory))).states
        )
        for p in (0.2, 0.4)
    ]
    assert rubber[0] > rubber[1]


@pytest.mark.parametrize("model", ["cylinder", "membrane", "solid"])
def test_energies(make_case, solve_case, muscle, model):
    """Nothing is gained in any step, and what is lost is the area of the loop."""
    case = make_case(**cycles(muscle, model=model))
    solution = solve_case(case)
    assert solution.status == "converged", solution.reason
    assert np.all(np.diff(solution.states["dissipated"]) >= 0)
    off, lost = balance.errors(case, solution.states)[-1]
    assert abs(off) < 0.01 * lost
    expected = {"cylinder": 5.059, "membrane": 4.472, "solid": 4.539}
    assert width(solution.states) == pytest.approx(expected[model], abs=2e-3)


def test_a_piece_of_an_infinite_tube_rubs_as_the_cylinder(make_case, solve_case, muscle):
    tube = Effects(end="sliding", volume="incompressible")
    memory = Memory.flat(0.06, 1e-3, 1e3)
    given = cycles(muscle, 20, count=1, memory=memory)
    one = solve_case(make_case(**(given | {"model": "solid", "effects": tube}))).states
    other = solve_case(make_case(**given)).states
    for name in ("force", "dissipated", "energy"):
        largest = np.max(np.abs(other[name]))
        np.testing.assert_allclose(one[name], other[name], atol=1e-6 * largest)


def test_it_is_of_a_case_only_where_it_matters(make_case, muscle):
    case = make_case(**cycles(muscle))
    assert case.active_effects[-1] == "friction"
    assert Case.from_json(case.canonical()).friction == RUBS
    still = {"muscle": sleeved(muscle), "model": "cylinder"}
    assert make_case(**still, friction=RUBS).key == make_case(**still).key


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"coefficient": 0}, "coefficient = 0"),
        ({"coefficient": 3}, "at most 2"),
        ({"contact": -1}, "mm"),
        ({"slip": 1}, "0.0001 to 0.1"),
    ],
)
def test_what_is_no_friction(values, said):
    with pytest.raises(UnsolvableCase, match=said):
        Friction(**({"coefficient": 0.2, "contact": 0.3} | values))


def test_what_has_none(make_case, muscle: Muscle):
    given = cycles(muscle)
    with pytest.raises(UnsolvableCase, match="which cross"):
        make_case(**(given | {"muscle": muscle}))
    with pytest.raises(UnsolvableCase, match="which cross"):
        make_case(**(given | {"muscle": sleeved(muscle, senses=(1,))}))
    with pytest.raises(UnsolvableCase, match="held where a sleeve has friction"):
        make_case(**given, effects=Effects(twist="free"))
