"""Where nodes lie along the axis: ends, sizes, one family of meshes, and what is refused."""

import math
from dataclasses import replace

import numpy as np
import pytest

from geometry.grading import MAX_INTERVALS, MIN_INTERVALS, Grading, UnbuildableMesh
from geometry.mesh_settings import MeridianMesh, SectionMesh
from geometry.muscle import Braid, Muscle

MESHES = [
    SectionMesh(),
    MeridianMesh(),
    Grading(cap_step=1, growth=1, body_step=0.1),  # uniform
    Grading(cap_step=5, growth=1.5, body_step=0.1),  # the body's step is below the cap's
    Grading(cap_step=0.01, growth=3, body_step=1),
]
DIAMETERS = [10, 20, 40]
LENGTHS = [0.5, 5, 60, 299, 300, 1000]


def tube(diameter, length):
    return Muscle(inner_diameter=diameter, wall_thickness=2, length=length, braid=None)


@pytest.mark.parametrize("mesh", MESHES)
@pytest.mark.parametrize("diameter", DIAMETERS)
@pytest.mark.parametrize("length", LENGTHS)
class TestHalfLength:
    def test_begins_at_mid_length_and_ends_at_the_cap_exactly(self, mesh, diameter, length):
        z = mesh.half_length_stations(tube(diameter, length))
        assert (z[0], z[-1]) == (0, length / 2)
        assert (np.diff(z) > 0).all()
        assert len(z) > MIN_INTERVALS

    def test_steps_shrink_towards_the_cap(self, mesh, diameter, length):
        """But for the body's last step, which may be shorter than the graded zone's first."""
        muscle = tube(diameter, length)
        steps = np.diff(mesh.half_length_stations(muscle))
        body, graded = mesh._intervals(muscle)
        assert steps[:body] == pytest.approx(steps[0], rel=1e-9)
        ratios = steps[body:-1] / steps[body + 1 :]
        assert ratios == pytest.approx(mesh.growth, rel=1e-6)
        assert len(steps) == body + graded

    def test_steps_are_near_what_was_asked_for(self, mesh, diameter, length):
        muscle = tube(diameter, length)
        steps = np.diff(mesh.half_length_stations(muscle))
        asked = min(mesh.body_step * diameter, length / 2)
        assert steps.max() <= 1.5 * asked
        if mesh.growth > 1:  # else the body's step goes on to the cap
            cap = min(mesh.cap_step * 2, mesh.body_step * diameter)
            assert steps[-1] <= 1.5 * cap

    @pytest.mark.parametrize(("coarse", "fine"), [(1, 2), (1, 3), (2, 4)])
    def test_refined_meshes_are_nested(self, mesh, diameter, length, coarse, fine):
        muscle = tube(diameter, length)
        few = replace(mesh, refinement=coarse).half_length_stations(muscle)
        many = replace(mesh, refinement=fine).half_length_stations(muscle)
        assert many[:: fine // coarse] == pytest.approx(few, rel=1e-12, abs=1e-12)
        assert len(many) - 1 == (len(few) - 1) * fine // coarse


def test_refinement_is_a_family_for_extrapolation(muscle):
    """Every interval of refinement m is cut in m, so the largest step falls nearly as 1/m."""
    largest = [
        np.diff(SectionMesh(refinement=m).half_length_stations(muscle)).max() for m in (1, 2, 4)
    ]
    assert largest[0] / largest[1] == pytest.approx(2, rel=1e-9)
    assert largest[1] / largest[2] == pytest.approx(2, rel=1e-9)


def test_the_mesh_scales_with_the_muscle(muscle):
    large = Muscle(
        inner_diameter=60,
        wall_thickness=6,
        length=900,
        cap_length=24,
        braid=Braid(lead=432, threads=60, layer_diameters=(61.8, 65.4)),
    )
    for mesh in (SectionMesh(), MeridianMesh()):
        for stations in ("half_length_stations", "clamp_stations"):
            small = getattr(mesh, stations)(muscle)
            assert getattr(mesh, stations)(large) == pytest.approx(3 * small, rel=1e-12)


def test_clamp_is_uniform_behind_its_ramp(muscle):
    """Thirds of the ramp, of 2 mm here, where nearly all of the error arises; then even steps."""
    z = SectionMesh(refinement=2).clamp_stations(muscle)
    on_ramp = [150 + k / 3 for k in range(1, 7)]
    assert z == pytest.approx([*on_ramp, *range(153, 159)], rel=1e-14)
    assert z[-1] == 158


@pytest.mark.parametrize("wall", [1.2, 2.0, 7.0])
@pytest.mark.parametrize("ramp", [0.1, 0.5, 1.0, 1.2, 2.0, 3.9, 4.0, 10.0])
@pytest.mark.parametrize("cap_step", [0.25, 1.0, 2.0])
def test_clamp_is_cut_where_its_ramp_ends(wall, ramp, cap_step):
    """Fields have a kink there; and no interval is a sliver, nor longer than asked for."""
    tube = Muscle(
        inner_diameter=20, wall_thickness=wall, length=300, braid=None, cap_length=4 * wall
    )
    mesh = SectionMesh(cap_step=cap_step)
    z = np.concatenate([[0], mesh.clamp_stations(tube, ramp) - 150])
    assert z[-1] == pytest.approx(4 * wall, rel=1e-12)
    assert (np.diff(z) > 0.02 * min(ramp, cap_step) * wall).all()
    assert np.diff(z).max() < 1.5 * cap_step * wall
    held = ramp * wall
    if ramp < 4:
        assert np.abs(z - held).min() < 1e-9
    assert (z[1:] <= min(held, 4 * wall) * (1 + 1e-9)).sum() >= 3
    for refinement in (2, 3):
        finer = replace(mesh, refinement=refinement).clamp_stations(tube, ramp) - 150
        assert finer[refinement - 1 :: refinement] == pytest.approx(z[1:], rel=1e-9)


@pytest.mark.parametrize("length", [2.0, 2.4, 2.7, 4.0, 6.0, 6.1, 30.0])
def test_a_clamp_of_any_length_ends_where_it_ends(length):
    tube = Muscle(inner_diameter=20, wall_thickness=2, length=300, braid=None, cap_length=length)
    z = SectionMesh().clamp_stations(tube) - 150
    assert z[-1] == pytest.approx(length, rel=1e-12)
    assert (np.diff(z) > 0).all()
    assert np.abs(z - 2).min() < 1e-9


@pytest.mark.parametrize("ramp", [0, -1.0, math.nan, math.inf, "1", None])
def test_a_ramp_that_is_no_length_is_refused(muscle, ramp):
    with pytest.raises(UnbuildableMesh) as refusal:
        SectionMesh().clamp_stations(muscle, ramp)
    allowed = "a finite number > 0 (wall thickness)"
    assert str(refusal.value) == f"ramp = {ramp!r} is refused; allowed: {allowed}"


def test_no_clamp_without_cap_length():
    muscle = Muscle(inner_diameter=20, wall_thickness=2, length=300, braid=None, cap_length=0)
    with pytest.raises(UnbuildableMesh, match="cap_length = 0 is refused; allowed: more than 0"):
        SectionMesh().clamp_stations(muscle)


@pytest.mark.parametrize("mesh", [SectionMesh, MeridianMesh])
@pytest.mark.parametrize(
    ("field", "value", "allowed"),
    [
        ("cap_step", 0, "a finite number > 0"),
        ("cap_step", math.nan, "a finite number > 0"),
        ("body_step", -1, "a finite number > 0"),
        ("body_step", "2", "a finite number > 0"),
        ("growth", 0.99, "a finite number >= 1"),
        ("growth", math.inf, "a finite number >= 1"),
        ("refinement", 0, "an integer >= 1"),
        ("refinement", 1.5, "an integer >= 1"),
        ("refinement", True, "an integer >= 1"),
    ],
)
def test_settings_that_make_no_mesh_are_refused(mesh, field, value, allowed):
    with pytest.raises(UnbuildableMesh) as refusal:
        mesh(**{field: value})
    assert str(refusal.value) == f"{field} = {value!r} is refused; allowed: {allowed}"


@pytest.mark.parametrize(
    "slip", [{"body_step": 1e-4}, {"growth": 1.0001}, {"cap_step": 1e-4}, {"refinement": 5000}]
)
def test_a_slip_of_the_pen_is_no_mesh_of_millions(muscle, slip):
    mesh = SectionMesh(**slip)
    with pytest.raises(UnbuildableMesh, match=f"at most {MAX_INTERVALS} steps"):
        mesh.half_length_stations(muscle), mesh.clamp_stations(muscle)
