"""Bare tubes past their largest pressure: a fold without a load, an asymptote at a held length.

Exact: an incompressible Mooney-Rivlin tube, its energy per reference length psi(r, lz) by Gauss
points, derivatives by complex steps.
"""

import math
import re

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar

from geometry.mesh_settings import SectionMesh
from geometry.muscle import Braid, Muscle
from solver.effects import Effects
from solver.load_path import Control, LoadPath, Waypoint
from solver.material import Thread
from solver.models.cylinder import curve
from solver.models.cylinder.mechanics import Cylinder
from solver.numerics import Numerics
from solver.rubber.mooney_rivlin.law import MooneyRivlin
from solver.rubber.ogden.law import Ogden
from solver.status import CaseStatus, StateStatus

C10, C01, INNER, OUTER = 0.345083, 0.083805, 10.0, 12.0
ALMOST_INCOMPRESSIBLE = MooneyRivlin(c10=C10, c01=C01, kappa=1e5)
NODES, WEIGHTS = np.polynomial.legendre.leggauss(20)
RADII = INNER + (OUTER - INNER) / 2 * (1 + NODES)


def pressure_and_force(r: float, lz: float) -> tuple[float, float]:
    """What holds the tube at inner radius r and stretch lz [MPa, N]."""

    def psi(r: complex, lz: complex) -> complex:
        a, b = (r**2 + (RADII**2 - INNER**2) / lz) / RADII**2, lz**2
        w = C10 * (a + b + 1 / (a * b) - 3) + C01 * (a * b + 1 / a + 1 / b - 3)
        return np.sum(w * 2 * math.pi * RADII * WEIGHTS) * (OUTER - INNER) / 2

    h = 1e-30
    pressure = psi(r + 1j * h, lz).imag / h / (2 * math.pi * r * lz)
    return pressure, psi(r, lz + 1j * h).imag / h - pressure * math.pi * r**2


def pressure_without_load(r: float) -> float:
    lz = brentq(lambda lz: pressure_and_force(r, lz)[1], 0.9, 3)
    return pressure_and_force(r, lz)[0]


@pytest.fixture
def sliding_tube(make_case, solve_case, bare_tube):
    def solve(path: LoadPath):
        return solve_case(
            make_case(
                model="solid",
                muscle=bare_tube,
                rubber=ALMOST_INCOMPRESSIBLE,
                effects=Effects(end="sliding"),
                numerics=Numerics(section=SectionMesh(cap_step=5, growth=1, body_step=1)),
                path=path,
            )
        )

    return solve


def largest(solution) -> float:
    """The extreme value that the reason names."""
    return float(re.search(r" at ([-\d.e]+)", solution.reason)[1])


def test_fold_without_a_load(sliding_tube):
    fold = minimize_scalar(lambda r: -pressure_without_load(r), bounds=(12, 30), method="bounded")
    solution = sliding_tube(LoadPath(kind="isotonic", held=0.0, stops=(0.05, 0.1, 0.13, 0.15)))
    assert solution.status is CaseStatus.LIMIT_POINT
    assert solution.reason.startswith("fold of the pressure")
    assert largest(solution) == pytest.approx(-fold.fun, rel=1e-3)
    for p, diameter in zip(
        (0.05, 0.1, 0.13), solution.states["inner_diameter_inflated"], strict=False
    ):
        r = brentq(lambda r, p=p: pressure_without_load(r) - p, 10.0, fold.x)
        assert diameter / 2 == pytest.approx(r, rel=1e-4)
    assert solution.state_status[3] is StateStatus.NOT_REACHED


def test_asymptote_at_a_held_length(sliding_tube):
    solution = sliding_tube(LoadPath(kind="isometric", held=0.0, stops=(0.05, 0.15, 0.2)))
    limit = 2 * (C10 + C01) * math.log(OUTER / INNER)
    assert solution.status is CaseStatus.LIMIT_POINT
    assert solution.reason.startswith("asymptote of the pressure")
    assert largest(solution) == pytest.approx(limit, rel=0.01)
    assert largest(solution) < limit * (1 + 1e-6)
    for p, diameter in zip((0.05, 0.15), solution.states["inner_diameter_inflated"], strict=False):
        assert pressure_and_force(diameter / 2, 1.0)[0] == pytest.approx(p, rel=1e-4)
    assert solution.state_status[2] is StateStatus.NOT_REACHED


@pytest.mark.parametrize("model", ["cylinder", "solid"])
def test_the_threshold_of_a_soft_muscle_is_the_lowest_zero_of_its_force(
    make_case, solve_case, model
):
    """Soft and wide, it pulls most at 0.3 to 0.5 MPa and pushes again at high pressure."""
    braid = Braid.from_angle(angle=21, threads=60, layer_diameters=(21.2, 23.6))
    muscle = Muscle(inner_diameter=20, wall_thickness=4, length=100, braid=braid, cap_length=16)
    rubber, thread = MooneyRivlin(c10=0.028, c01=0.01), Thread(stiffness=80)

    def threshold(*stops: float) -> float:
        path = LoadPath(kind="isometric", held=0.17, stops=stops, zero_force=True)
        case = make_case(muscle=muscle, rubber=rubber, thread=thread, model=model, path=path)
        solution = solve_case(case)
        assert solution.status == "converged", solution.reason
        return solution.states["pressure"][-1]

    near = threshold(0.03, 0.06)
    assert 0.03 < near < 0.06
    assert threshold(0.1, 0.3, 0.5, 0.7) == pytest.approx(near, rel=1e-6)


@pytest.mark.parametrize(
    ("rubber", "size", "stops"),
    [
        (MooneyRivlin(c10=C10, c01=C01), {"inner_diameter": 8, "length": 40}, (0.05, 0.2, 1.0)),
        (MooneyRivlin(c10=0.028, c01=0.018), {"inner_diameter": 30, "length": 100}, (0.01, 0.2)),
    ],
)
def test_a_tube_many_times_its_length_is_no_answer(make_case, solve_case, rubber, size, stops):
    """Beyond its largest pressure Newton's method finds another branch, 13 times as long."""
    tube = Muscle(wall_thickness=1, braid=None, **size)
    path = LoadPath(kind="isotonic", held=0.0, stops=stops)
    solution = solve_case(make_case(model="membrane", muscle=tube, rubber=rubber, path=path))
    assert solution.status is not CaseStatus.CONVERGED
    assert solution.reason
    for k, contraction in enumerate(solution.states["contraction"]):
        good = solution.state_status[k] is StateStatus.CONVERGED
        assert good == (contraction > -0.5)
        assert good or solution.notes[k]


# Ogden's rubber of 1972: a true fold at a held length, then a valley; by codes of others.
BALLOON = Ogden(convention="textbook", mu=(0.63, 0.0012, -0.01), alpha=(1.3, 5.0, -2.0), kappa=1e5)
FOLD, FOLD_RADIUS = 0.0625854, 20.238
VALLEY, VALLEY_RADIUS = 0.057235, 37.5


@pytest.fixture
def balloon(make_case, bare_tube):
    def case(model: str, stops: tuple[float, ...]):
        return make_case(
            model=model,
            muscle=bare_tube,
            rubber=BALLOON,
            effects=Effects(end="sliding") if model == "solid" else Effects(),
            numerics=Numerics(section=SectionMesh(cap_step=5, growth=1, body_step=1)),
            path=LoadPath(kind="isometric", held=0.0, stops=stops),
        )

    return case


@pytest.mark.parametrize(
    ("model", "stops"),
    [
        ("cylinder", (0.055, 0.0605, 0.065)),
        ("cylinder", (0.03, 0.2)),
        ("solid", (0.055, 0.0605, 0.065)),
    ],
)
def test_a_fold_of_ogden_under_pressure(balloon, solve_case, model, stops):
    """There are states at these pressures behind the valley, three times as wide; none is taken."""
    solution = solve_case(balloon(model, stops))
    assert solution.status is CaseStatus.LIMIT_POINT
    assert solution.reason.startswith("fold of the pressure")
    assert largest(solution) == pytest.approx(FOLD, rel=1e-4)
    for pressure, status in zip(stops, solution.state_status, strict=True):
        reached = StateStatus.CONVERGED if pressure < FOLD else StateStatus.NOT_REACHED
        assert status is reached
    assert np.nanmax(solution.states["inner_diameter_inflated"]) / 2 < FOLD_RADIUS


RADII_PASSED = (12.0, 16.0, FOLD_RADIUS, 25.0, 30.0, VALLEY_RADIUS, 45.0)


def check_passed(pressures: list[float]) -> None:
    assert max(pressures[:5]) == pressures[2] == pytest.approx(FOLD, rel=5e-6)
    assert min(pressures[2:]) == pressures[5] == pytest.approx(VALLEY, rel=2e-5)


def test_a_fold_is_passed_under_volume_control_by_the_cylinder(balloon):
    tube = Cylinder(balloon("cylinder", (0.05,)))
    kinds, at, found = (Control.CONTRACTION, Control.VOLUME), tube.start, []
    for radius in RADII_PASSED:
        volume = math.pi * radius**2 * tube.case.muscle.length
        goal = np.array([0.0, volume / curve.scale(tube, Control.VOLUME)])
        at, reached = curve.walk(tube, kinds, goal, at)
        assert reached
        found.append(tube.state(at).pressure)
    check_passed(found)


def test_a_fold_is_passed_under_volume_control_by_the_solid(balloon, walk):
    case = balloon("solid", (0.05,))
    length = case.muscle.length
    way = [
        Waypoint(Control.CONTRACTION, 0.0, Control.VOLUME, math.pi * radius**2 * length, stop=k)
        for k, radius in enumerate(RADII_PASSED)
    ]
    rows = walk(case, way)
    assert [row["waypoint"] for row in rows] == list(range(len(way)))
    check_passed([row["pressure"] for row in rows])
