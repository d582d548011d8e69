"""The muscle: its derived numbers, its plain form, and what is refused."""

import math
import pickle
from dataclasses import asdict, replace

import pytest

from geometry.muscle import Braid, Muscle, UnbuildableMuscle

LAYERS = (20.6, 21.8)


def test_angles_of_the_paper(muscle):
    """24.8 degrees at the mean layer diameter of spacing 2.4 mm, and those of the layers."""
    inner, outer = (math.degrees(angle) for angle in muscle.braid.layer_angles)
    assert math.degrees(muscle.braid.angle) == pytest.approx(24.82, abs=0.005)
    assert inner == pytest.approx(24.20, abs=0.005)
    assert outer == pytest.approx(25.44, abs=0.005)
    assert muscle.braid.mean_diameter == pytest.approx(21.2, rel=1e-15)
    assert muscle.braid.axial_spacing == pytest.approx(2.4, rel=1e-15)


def test_angle_of_the_wider_spacing():
    """3.6 mm between threads is the paper's 17.1 degrees."""
    braid = Braid(lead=216, threads=60, layer_diameters=LAYERS)
    assert math.degrees(braid.angle) == pytest.approx(17.14, abs=0.005)
    assert braid.axial_spacing == pytest.approx(3.6, rel=1e-15)


def test_lead_from_angle():
    """The 40 mm muscle has the angle of the 20 mm muscle, so a longer lead."""
    angle = math.degrees(math.atan(math.pi * 21.2 / 144))
    small = Braid.from_angle(angle=angle, threads=60, layer_diameters=LAYERS)
    large = Braid.from_angle(angle=angle, threads=60, layer_diameters=(40.6, 41.8))
    assert small.lead == pytest.approx(144, rel=1e-14)
    assert large.lead == pytest.approx(279.85, abs=0.005)
    assert math.degrees(large.angle) == pytest.approx(angle, rel=1e-14)


def test_radii(muscle, bare_tube):
    assert (muscle.inner_radius, muscle.outer_radius, muscle.outer_diameter) == (10, 12, 24)
    assert muscle.layer_radii == pytest.approx((10.3, 10.9))
    assert bare_tube.layer_radii == ()


@pytest.mark.parametrize("name", ["muscle", "bare_tube"])
def test_plain_form_returns_the_same_muscle(name, request):
    muscle = request.getfixturevalue(name)
    assert Muscle.from_dict(muscle.as_dict()) == muscle


def values(**changes):
    """Arguments of a buildable muscle, some of them or of its braid's changed."""
    braid = {"lead": 144, "threads": 60, "layer_diameters": LAYERS}
    tube = {"inner_diameter": 20, "wall_thickness": 2, "length": 300, "cap_length": 8}
    for name, value in changes.items():
        (braid if name in braid else tube)[name] = value
    return {**tube, "braid": braid}


@pytest.mark.parametrize("field", ["inner_diameter", "wall_thickness", "length", "lead"])
@pytest.mark.parametrize("value", [0, -1, math.nan, math.inf, "20", None, True])
def test_lengths_must_be_positive_and_finite(field, value):
    with pytest.raises(UnbuildableMuscle) as refusal:
        Muscle.from_dict(values(**{field: value}))
    assert (refusal.value.field, refusal.value.allowed) == (field, "a finite number > 0 (mm)")
    assert str(refusal.value) == (
        f"{field} = {value!r} is refused; allowed: a finite number > 0 (mm)"
    )


@pytest.mark.parametrize("value", [-0.1, math.nan, math.inf, "8"])
def test_cap_length_must_not_be_negative(value):
    with pytest.raises(UnbuildableMuscle) as refusal:
        Muscle.from_dict(values(cap_length=value))
    assert refusal.value.field == "cap_length"
    assert ">= 0" in str(refusal.value)


def test_cap_length_may_be_zero():
    assert Muscle.from_dict(values(cap_length=0)).cap_length == 0


@pytest.mark.parametrize("value", [0, -60, 60.0, 1.5, "60", True])
def test_threads_must_be_counted(value):
    with pytest.raises(UnbuildableMuscle) as refusal:
        Muscle.from_dict(values(threads=value))
    assert refusal.value.field == "threads"
    assert repr(value) in str(refusal.value)
    assert "an integer >= 1" in str(refusal.value)


@pytest.mark.parametrize(
    "diameters",
    [
        (20.0, 21.8),  # on the inner surface
        (20.6, 24.0),  # on the outer surface
        (19.0, 21.8),
        (20.6, 25.0),
        (21.8, 20.6),
        (20.6, 20.6),
        (20.6,),
        (20.6, 21.2, 21.8),
        (-20.6, 21.8),
        (20.6, math.nan),
        (20.6, "21.8"),
        20.6,
    ],
)
def test_layers_must_be_two_inside_the_wall_inner_first(diameters):
    with pytest.raises(UnbuildableMuscle) as refusal:
        Muscle.from_dict(values(layer_diameters=diameters))
    assert refusal.value.field == "layer_diameters"
    assert repr(diameters) in str(refusal.value)


def test_layers_just_inside_the_wall_are_allowed():
    layers = (math.nextafter(20, 21), math.nextafter(24, 23))
    assert Muscle.from_dict(values(layer_diameters=layers)).braid.layer_diameters == layers


@pytest.mark.parametrize("angle", [0, 90, -24.8, 91, math.nan, math.inf, "24.8"])
def test_angle_must_lie_between_axis_and_hoop(angle):
    with pytest.raises(UnbuildableMuscle) as refusal:
        Braid.from_angle(angle=angle, threads=60, layer_diameters=LAYERS)
    assert refusal.value.field == "angle"
    assert "less than 90 (degrees)" in str(refusal.value)


@pytest.mark.parametrize(
    ("change", "named"),
    [
        (lambda v: v | {"diameter": 20}, "muscle.diameter"),
        (lambda v: v | {"braid": v["braid"] | {"leed": 144}}, "muscle.braid.leed"),
        (lambda v: {k: v[k] for k in v if k != "length"}, "muscle.length"),
        (lambda v: {k: v[k] for k in v if k != "braid"}, "muscle.braid"),
        (lambda v: v | {"braid": {"lead": 144, "threads": 60}}, "muscle.braid.layer_diameters"),
        (lambda v: v | {"braid": 144}, "muscle.braid"),
        (lambda v: [20, 2, 300], "muscle"),
    ],
)
def test_plain_form_has_exactly_the_fields(change, named):
    with pytest.raises(UnbuildableMuscle) as refusal:
        Muscle.from_dict(change(values()))
    assert refusal.value.field == named


def test_a_muscle_is_checked_again_when_it_is_changed(muscle):
    with pytest.raises(UnbuildableMuscle, match="layer_diameters"):
        replace(muscle, wall_thickness=0.5)


def test_a_refusal_travels_between_processes():
    refusal = UnbuildableMuscle("length", -1, "a finite number > 0 (mm)")
    again = pickle.loads(pickle.dumps(refusal))
    assert (again.field, again.value, str(again)) == ("length", -1, str(refusal))


def test_every_field_has_a_unit(muscle):
    """The unit stands in the metadata, for records and tables."""
    for part in (muscle, muscle.braid):
        entries = type(part).__dataclass_fields__
        assert set(entries) == set(asdict(part))
        without = {name for name, entry in entries.items() if "unit" not in entry.metadata}
        assert without <= {"braid"}
