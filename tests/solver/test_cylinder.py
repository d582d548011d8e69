"""The cylinder against checked forces, an energy of its own, and the exact bare tube."""

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import minimize_scalar

from geometry.muscle import Muscle
from solver.effects import Effects
from solver.load_path import LoadPath
from solver.material import Thread
from solver.models.cylinder.direct import between, direct
from solver.models.cylinder.mechanics import Cylinder
from solver.models.cylinder.observe import observed

EPS = (0.0, 0.05, 0.1, 0.15, 0.2)


@pytest.fixture
def solve(make_case, solve_case):
    """States of a converged case of the cylinder."""

    def states(kind: str, held: float, *stops: float, zero_force: bool = False, **changes):
        path = LoadPath(kind=kind, held=held, stops=stops, zero_force=zero_force)
        solution = solve_case(make_case(model="cylinder", path=path, **changes))
        assert solution.status == "converged", solution.reason
        return solution.states

    return states


def test_checked_forces(solve):
    np.testing.assert_allclose(
        solve("isobaric", 0.3, *EPS)["force"], [689, 463, 299, 162, 40], atol=0.6
    )


def test_threshold_pressure(solve):
    states = solve("isometric", 0.1, 0.1, 0.3, zero_force=True)
    assert states["pressure"][2] == pytest.approx(0.1346, abs=5e-5)
    assert states["force"][2] == pytest.approx(0, abs=1e-8)
    assert states["force"][0] < 0 < states["force"][1]


@pytest.mark.parametrize(
    ("stretch", "radius", "force"),
    [(1.0, 11.199271, -1.33429), (0.9, 11.701958, -42.01424), (0.8, 12.292304, -96.44634)],
)
def test_bare_tube(solve, bare_tube, stretch, radius, force):
    """Without threads the cylinder is the exact infinite tube."""
    states = solve("isometric", round(1 - stretch, 10), 0.05, muscle=bare_tube)
    assert states["inner_diameter_inflated"][0] / 2 == pytest.approx(radius, abs=1e-6)
    assert states["force"][0] == pytest.approx(force, abs=1e-5)


def test_threads_that_vanish_leave_the_bare_tube(solve, bare_tube):
    bare = solve("isometric", 0.1, 0.05, muscle=bare_tube)
    nearly = solve("isometric", 0.1, 0.05, thread=Thread(stiffness=1e-7))
    assert nearly["force"][0] == pytest.approx(bare["force"][0], abs=1e-4)


# --- an energy of its own -------------------------------------------------------------------------


def energy(r: float, lz: float, threads: str) -> float:
    """Energy of wall and threads of the normal muscle per reference length [N mm/mm], by quad."""
    c10, c01, ri, ro = 0.345083, 0.083805, 10.0, 12.0

    def density(big: float) -> float:
        lt = math.sqrt(r**2 + (big**2 - ri**2) / lz) / big
        lr = 1 / (lt * lz)
        i1 = lr**2 + lt**2 + lz**2
        i2 = 1 / lr**2 + 1 / lt**2 + 1 / lz**2
        return (c10 * (i1 - 3) + c01 * (i2 - 3)) * 2 * math.pi * big

    total = quad(density, ri, ro, epsabs=1e-12, epsrel=1e-12)[0]
    for layer in (10.3, 10.9):
        angle = math.atan(2 * math.pi * layer / 144)
        lt = math.sqrt(r**2 + (layer**2 - ri**2) / lz) / layer
        strain = math.hypot(math.cos(angle) * lz, math.sin(angle) * lt) - 1
        if threads == "two_way":
            thread = strain**2 / 2
        else:
            positive = (strain + math.hypot(strain, 1e-3)) / 2
            thread = (positive**2 + 1e-3 * strain**2) / 2
        total += 60 * 315 * thread / math.cos(angle)  # threads per length: 60 / cos a
    return total


def potential(lz: float, pressure: float, threads: str) -> tuple[float, float]:
    """The smallest psi - p pi r^2 lz over r, and that r."""

    def value(r: float) -> float:
        return energy(r, lz, threads) - pressure * math.pi * r**2 * lz

    found = minimize_scalar(value, bounds=(8, 25), method="bounded", options={"xatol": 1e-9})
    return found.fun, found.x


@pytest.mark.parametrize("threads", ["two_way", "tension_only"])
@pytest.mark.parametrize(("pressure", "contraction"), [(0.3, 0.0), (0.3, 0.1), (0.05, 0.15)])
def test_state_is_a_minimum_and_force_its_derivative(solve, threads, pressure, contraction):
    """F = dPi/dl with Pi minimal in the radius, by fourth-order differences."""
    states = solve("isobaric", pressure, contraction, effects=Effects(threads=threads))
    lz, h = 1 - contraction, 2e-3
    steps = [potential(lz + k * h, pressure, threads)[0] for k in (-2, -1, 1, 2)]
    force = (steps[0] - 8 * steps[1] + 8 * steps[2] - steps[3]) / (12 * h)
    assert states["force"][0] == pytest.approx(force, abs=2e-3)
    radius = potential(lz, pressure, threads)[1]
    assert states["inner_diameter_inflated"][0] / 2 == pytest.approx(radius, abs=1e-5)


def test_recorded_geometry(solve, muscle):
    """Outer diameter by incompressibility, thread stretches by the layers."""
    states = solve("isobaric", 0.3, 0.1)
    r, lz = states["inner_diameter_inflated"][0] / 2, 0.9
    outer = 2 * math.sqrt(r**2 + (12**2 - 10**2) / lz)
    assert states["outer_diameter"][0] == pytest.approx(outer)
    stretches = [
        math.hypot(
            math.cos(a) * lz, math.sin(a) * math.sqrt(r**2 + (layer**2 - 10**2) / lz) / layer
        )
        for layer, a in zip((10.3, 10.9), muscle.braid.layer_angles, strict=True)
    ]
    assert states["thread_stretch_min"][0] == pytest.approx(min(stretches))
    assert states["thread_stretch_max"][0] == pytest.approx(max(stretches))


def test_length_does_not_matter(solve, muscle):
    short = Muscle(inner_diameter=20, wall_thickness=2, length=30, braid=muscle.braid)
    assert solve("isobaric", 0.3, 0.1, muscle=short)["force"][0] == pytest.approx(
        solve("isobaric", 0.3, 0.1)["force"][0], rel=1e-12
    )


def test_isotonic_inverts_isobaric(solve):
    force = solve("isobaric", 0.3, 0.1)["force"][0]
    states = solve("isotonic", force, 0.1, 0.3)
    assert states["contraction"][1] == pytest.approx(0.1, abs=1e-9)


def test_the_unloaded_tube_is_at_rest(solve, bare_tube):
    states = solve("isobaric", 0.0, 0.0, muscle=bare_tube)
    assert states["force"][0] == pytest.approx(0, abs=1e-10)
    assert states["inner_diameter_inflated"][0] == pytest.approx(20, abs=1e-10)


def test_a_net_without_rubber_under_a_load(solve, muscle):
    """Of one radius and hardly stretching: F = p pi R^2 (3 lz^2 cos^2 - 1) / sin^2."""
    pressures = np.array([0.2, 0.4])
    net = {"effects": Effects(rubber="none", wall="one_radius"), "thread": Thread(stiffness=1e5)}
    lz = 1 - solve("isotonic", 200.0, *pressures, **net)["contraction"]
    radius = muscle.braid.mean_diameter / 2
    angle = math.atan(2 * math.pi * radius / muscle.braid.lead)
    share = (3 * (lz * math.cos(angle)) ** 2 - 1) / math.sin(angle) ** 2
    np.testing.assert_allclose(pressures * math.pi * radius**2 * share, 200, rtol=1e-3)


@pytest.mark.parametrize(
    "effects", [Effects(), Effects(twist="free"), Effects(stretch="rigid"), Effects(rubber="none")]
)
@pytest.mark.parametrize("pressure", [0.05, 0.3])
def test_a_state_found_at_once_is_that_of_the_path(solve, make_case, effects, pressure):
    stops = (-0.04, 0.0, 0.1, 0.2)
    path = LoadPath(kind="isobaric", held=pressure, stops=stops)
    walked = solve("isobaric", pressure, *stops, effects=effects)
    cylinder = Cylinder(make_case(model="cylinder", path=path, effects=effects))
    for number, contraction in enumerate(stops):
        found = observed(cylinder, direct(cylinder, pressure, contraction))
        for name in ("force", "volume", "outer_diameter", "stiffness", "energy"):
            assert found[name] == pytest.approx(walked[name][number], rel=1e-8, abs=1e-8), name


def test_no_radius_holds_a_pressure_that_bursts_the_tube(make_case, bare_tube):
    cylinder = Cylinder(make_case(model="cylinder", muscle=bare_tube))
    assert direct(cylinder, 0.05, 0.1) is not None
    assert direct(cylinder, 5.0, 0.1) is None


def test_a_root_is_found_in_few_steps():
    """Of its order, 1.44: each step has more than twice as many digits as the last but one."""
    asked = []

    def off(x: float) -> float:
        asked.append(x)
        return x**3 + np.exp(x) - 40

    found = between(off, 0.0, 5.0)
    assert off(found) == pytest.approx(0, abs=1e-13)
    assert len(asked) <= 20
    assert between(lambda x: x, 0.0, 1.0) == 0
