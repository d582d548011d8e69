"""Switching an effect off removes its unknowns or terms, and gives the limiting case."""

import math
from dataclasses import replace

import numpy as np
import pytest

from geometry.muscle import Muscle
from solver.effects import Effects
from solver.load_path import LoadPath
from solver.material import Thread
from solver.numerics import Numerics, Slack
from solver.program import composition
from solver.rubber.mooney_rivlin.law import MooneyRivlin

STOPS = (0.0, 0.05, 0.1, 0.15, 0.2)
CURVE = LoadPath(kind="isobaric", held=0.3, stops=STOPS)
LARGEST = 689.5  # N, force of the cylinder at the initial length


@pytest.fixture
def solution(make_case, solve_case):
    """A converged solution; keywords are fields of Case, or of Effects."""

    def solve(model, path=CURVE, *, case=None, **effects):
        found = solve_case(
            make_case(model=model, path=path, effects=Effects(**effects), **(case or {}))
        )
        assert found.status == "converged", found.reason
        return found

    return solve


def agree(a, b, *, force=1e-4, diameter=1e-4):
    """Forces within a share of the largest, diameters within a share of themselves."""
    scale = np.abs(b.states["force"]).max()
    np.testing.assert_allclose(a.states["force"], b.states["force"], atol=force * scale, rtol=0)
    name = "inner_diameter_inflated"
    np.testing.assert_allclose(a.states[name], b.states[name], rtol=diameter)


# --- thread stretch -------------------------------------------------------------------------------


def test_rigid_threads_are_the_limit_of_stiff_ones(solution):
    """A rigid net has no unknown radius; stiff threads tend to it."""
    rigid = solution("cylinder", stretch="rigid")
    assert rigid.unknowns == 0
    differences = []
    for stiffness in (1e4, 1e5):
        stiff = solution("cylinder", case={"thread": Thread(stiffness=stiffness)})
        assert stiff.unknowns == 1
        change = stiff.states["force"][1:] - rigid.states["force"][1:]
        differences.append(np.abs(change).max())
    assert differences[1] < 0.3 * differences[0]
    assert differences[1] < 1e-3 * LARGEST
    assert rigid.states["force"][2] == pytest.approx(333.2, abs=0.1)  # 878 N at 0 (PHYSICS)
    assert rigid.states["force"][0] == pytest.approx(878, abs=0.5)


def test_a_slack_rigid_net_bears_nothing(solution, make_case, muscle):
    """Below the threshold the wall rests inside the net, like a tube without one."""
    path = LoadPath(kind="isometric", held=0.1, stops=(0.0, 0.02, 0.05))
    rigid = solution("cylinder", path, stretch="rigid")
    bare = solution("cylinder", path, case={"muscle": replace(muscle, braid=None)})
    agree(rigid, bare, force=1e-9, diameter=1e-9)
    assert (rigid.states["thread_stretch_max"] < 1).all()


def test_rigid_threads_under_a_load(solution):
    """Isotonic paths solve for the contraction, of the same curve."""
    curve = solution("cylinder", stretch="rigid")
    load = float(curve.states["force"][2])
    path = LoadPath(kind="isotonic", held=load, stops=(0.1, 0.2, 0.3))
    found = solution("cylinder", path, stretch="rigid")
    assert found.states["contraction"][2] == pytest.approx(0.1, abs=1e-9)


# --- rubber ---------------------------------------------------------------------------------------


def test_a_rigid_net_without_rubber_is_eq_1(solution, muscle):
    """At one radius, the mean of the layers, which is then the D0 of Eq. (1)."""
    net = solution("cylinder", stretch="rigid", rubber="none", wall="one_radius")
    assert net.unknowns == 0
    angle = muscle.braid.angle
    area = math.pi * 21.2**2 / (4 * math.sin(angle) ** 2)
    eq_1 = 0.3 * area * (3 * math.cos(angle) ** 2 * (1 - np.array(STOPS)) ** 2 - 1)
    np.testing.assert_allclose(net.states["force"], eq_1, rtol=1e-12)


def test_rubber_that_becomes_soft_is_none(solution):
    none = solution("cylinder", rubber="none")
    soft = solution("cylinder", case={"rubber": MooneyRivlin(c10=1e-3, c01=0)})
    agree(soft, none, force=2e-3, diameter=2e-3)


# --- wall thickness -------------------------------------------------------------------------------


def thin(muscle: Muscle, share: float) -> Muscle:
    """The muscle with a wall, and layers in it, of a share of the thickness."""
    layers = tuple(20 + share * (d - 20) for d in (20.6, 21.8))
    braid = replace(muscle.braid, layer_diameters=layers)
    return replace(muscle, wall_thickness=2 * share, braid=braid)


@pytest.mark.parametrize("model", ["cylinder", "membrane"])
def test_one_radius_is_the_limit_of_a_thin_wall(solution, muscle, model):
    differences = []
    for share in (0.1, 0.01):
        case = {"muscle": thin(muscle, share)}
        whole = solution(model, case=case)
        one = solution(model, case=case, wall="one_radius")
        change = one.states["force"] - whole.states["force"]
        differences.append(np.abs(change).max() / whole.states["force"].max())
        assert one.unknowns == whole.unknowns
    assert differences[1] < 0.15 * differences[0]
    assert differences[1] < 2e-3


def test_one_radius_has_one_point_in_the_wall(make_case):
    case = make_case(model="membrane", effects=Effects(wall="one_radius"))
    assert "membrane_wall_integrated" not in composition(case)


def test_one_radius_of_the_muscle(solution):
    """The membrane loses 7 % of its force at 10 %: 253 N."""
    one = solution("membrane", wall="one_radius")
    assert one.states["force"][2] == pytest.approx(253, abs=0.3)


# --- twist ----------------------------------------------------------------------------------------


def test_a_held_end_is_axisymmetric_and_needs_a_torque(solution):
    held, free = solution("cylinder"), solution("cylinder", twist="free")
    assert (held.unknowns, free.unknowns) == (1, 2)
    assert (held.states["twist"] == 0).all()
    assert (np.abs(held.states["torque"]) > 100).all()
    np.testing.assert_allclose(free.states["torque"], 0, atol=1e-6)
    assert (free.states["twist"] > 0).all()


def test_twist_of_a_soft_hinge_is_torque_over_stiffness(solution):
    """To first order the free end turns by the held end's torque over the torsional stiffness."""
    held, free = solution("cylinder"), solution("cylinder", twist="free")
    work = 0.5 * np.abs(held.states["torque"] * free.states["twist"])  # per length
    assert (work < 1e-3 * LARGEST).all()
    assert (np.abs(free.states["force"] - held.states["force"]) < 2e-3 * LARGEST).all()


def test_layers_that_balance_do_not_twist(solution, muscle):
    """With both layers almost at one radius nothing turns."""
    braid = replace(muscle.braid, layer_diameters=(21.2, 21.2 + 1e-6))
    free = solution("cylinder", case={"muscle": replace(muscle, braid=braid)}, twist="free")
    np.testing.assert_allclose(free.states["twist"], 0, atol=1e-8)
    bare = solution(
        "cylinder",
        LoadPath(kind="isometric", held=0.1, stops=(0.05,)),
        case={"muscle": replace(muscle, braid=None)},
        twist="free",
    )
    assert bare.states["twist"][0] == pytest.approx(0, abs=1e-12)


# --- compressibility ------------------------------------------------------------------------------


def test_incompressible_is_the_limit_of_a_large_bulk_modulus(solution):
    none = solution("solid", volume="incompressible")
    changes = []
    for kappa in (1e3, 1e4, 1e7):
        rubber = MooneyRivlin(c10=0.345083, c01=0.083805, kappa=kappa)
        some = solution("solid", case={"rubber": rubber})
        assert some.unknowns == none.unknowns
        changes.append(np.abs(some.states["force"] - none.states["force"]).max())
    assert changes[1] < 0.15 * changes[0]
    assert changes[2] < 1e-6 * LARGEST


def test_the_term_is_absent(make_case):
    case = make_case(model="solid", effects=Effects(volume="incompressible"))
    assert "solid_compressible" not in composition(case)


# --- slackening, end caps -------------------------------------------------------------------------


@pytest.mark.parametrize("model", ["cylinder", "membrane", "solid"])
def test_slackening_does_not_matter_where_all_threads_are_taut(solution, model):
    path = LoadPath(kind="isobaric", held=0.4, stops=(0.0, 0.01))
    narrow = {"numerics": Numerics(slack=Slack(width=1e-6))}
    slack = solution(model, path, case=narrow)
    assert slack.states["thread_stretch_min"].min() > 1
    agree(slack, solution(model, path, threads="two_way"), force=1e-5, diameter=1e-5)


def test_a_long_muscle_hardly_feels_its_caps(solution, muscle):
    """What the caps change goes as 1 / L; without them there is one unknown."""
    cylinder = solution("cylinder")
    changes = []
    for length in (300, 3000):
        membrane = solution("membrane", case={"muscle": replace(muscle, length=length)})
        assert membrane.unknowns > 10 * cylinder.unknowns
        changes.append(np.abs(membrane.states["force"] - cylinder.states["force"]).max())
    assert changes[1] == pytest.approx(changes[0] / 10, rel=0.2)
