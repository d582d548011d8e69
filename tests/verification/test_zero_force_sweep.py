"""Random muscles: what a fine-stepped curve brackets as its zero, its coarse twin reports.

The twin is searched for by nothing but its stops: it has many, and asks for no state of zero force.
"""

from dataclasses import replace

import numpy as np
import pytest

from geometry.muscle import Braid, Muscle
from solver.load_path import LoadPath
from solver.material import Thread
from solver.numerics import Newton, Numerics
from solver.rubber.mooney_rivlin.law import MooneyRivlin
from solver.status import StateStatus
from solver.zero_force import limit_pressure

MUSCLES, SEED = 60, 20261126
FEW = 3  # of them in the daily run, by the cylinder
STOPS = 40  # of a fine curve
MODELS = ("cylinder", "membrane", "solid")
GOOD = (StateStatus.CONVERGED, StateStatus.UNSTABLE)


def random_muscle(rng):
    """A muscle that could be built, from soft to stiff and from slender to stout."""
    diameter = np.exp(rng.uniform(np.log(5), np.log(50)))
    wall = diameter * rng.uniform(0.05, 0.2)
    layers = diameter + 2 * wall * np.array([rng.uniform(0.1, 0.4), rng.uniform(0.5, 0.85)])
    threads = int(rng.uniform(20, 100))
    modulus = np.exp(rng.uniform(np.log(0.04), np.log(0.8)))  # MPa
    share = rng.uniform(0.5, 0.95)
    stiffness = np.exp(rng.uniform(np.log(3), np.log(100))) * modulus * diameter * wall
    angle = rng.uniform(15, 38)
    return {
        "muscle": Muscle(
            inner_diameter=float(diameter),
            wall_thickness=float(wall),
            length=float(diameter * rng.uniform(6, 20)),
            cap_length=float(4 * wall),
            braid=Braid.from_angle(
                angle=float(angle), threads=threads, layer_diameters=tuple(map(float, layers))
            ),
        ),
        "rubber": MooneyRivlin(c10=float(share * modulus), c01=float((1 - share) * modulus)),
        "thread": Thread(stiffness=float(stiffness * 10 / threads)),
        "numerics": Numerics(newton=Newton(tolerance=1e-8)),
    }


def fine_and_coarse(rng, make_case, model, kind, parts):
    """A curve of many stops, and one with a few of them that asks for its zero."""
    case = make_case(model=model, **parts)
    limit = limit_pressure(case)
    if kind == "isometric":
        held, stops = rng.uniform(0.02, 0.18), np.linspace(0, 4 * limit, STOPS + 1)
    else:
        held, stops = limit * rng.uniform(1.0, 4.0), np.linspace(0, 0.3, STOPS + 1)
    stops = tuple(float(f"{x:.6g}") for x in stops)
    count = int(rng.integers(1, 5))
    few = sorted(rng.choice(STOPS, size=count, replace=False) + 1)
    coarse = tuple(stops[k] for k in few)
    held = float(f"{held:.4g}")
    return (
        make_case(model=model, path=LoadPath(kind=kind, held=held, stops=stops), **parts),
        make_case(
            model=model, path=LoadPath(kind=kind, held=held, stops=coarse, zero_force=True), **parts
        ),
    )


def bracketed(solve_case, case):
    """The lowest zero of a fine curve in the wanted sense, on a finer one; NaN if there is none."""
    path = case.path
    sense = 1 if path.kind == "isometric" else -1
    for _ in range(2):
        solution = solve_case(replace(case, path=path))
        g = sense * solution.states["force"]
        good = np.array([status in GOOD for status in solution.state_status])
        rising = good[:-1] & good[1:] & (g[:-1] < 0) & (g[1:] > 0)
        if not rising.any():
            return np.nan
        k = int(np.argmax(rising))
        low, high = path.stops[k : k + 2]
        path = replace(path, stops=tuple(float(x) for x in np.linspace(low, high, 9)))
    return float(low - g[k] * (high - low) / (g[k + 1] - g[k]))


def missed(make_case, solve_case, count, models):
    """Curves that have a zero, and those that do not report it within 1 % or 1e-3 of all stops."""
    rng, asked, wrong = np.random.default_rng(SEED), 0, []
    for number in range(count):
        parts = random_muscle(rng)
        for kind in ("isometric", "isobaric"):
            for model in models:
                fine, coarse = fine_and_coarse(rng, make_case, model, kind, parts)
                stops = fine.path.stops
                expected = bracketed(solve_case, fine)
                if np.isnan(expected):
                    continue
                asked += 1
                solution = solve_case(coarse)
                swept = "pressure" if kind == "isometric" else "contraction"
                found = solution.states[swept][-1]
                near = abs(found - expected) <= max(0.01 * expected, 1e-3 * stops[-1])
                if not (near and solution.state_status[-1] in GOOD):
                    wrong.append(
                        f"{number} {model} {kind} {fine.path.held} {coarse.path.stops}: {found} "
                        f"{solution.notes[-1]}, not {expected}; {solution.status} {solution.reason}"
                    )
    return asked, wrong


def test_a_few_cylinders(make_case, solve_case):
    asked, wrong = missed(make_case, solve_case, FEW, ("cylinder",))
    assert asked >= FEW
    assert wrong == []


@pytest.mark.campaign
def test_random_muscles_report_their_zero(make_case, solve_case):
    asked, wrong = missed(make_case, solve_case, MUSCLES, MODELS)
    assert asked > 2 * MUSCLES
    assert len(wrong) <= 0.01 * asked, "\n".join([f"{len(wrong)} of {asked}:", *wrong])
