"""Quantities as people write them, against pint, and what is said of those that are none."""

import pint
import pytest

from workflow.answers.quantities import KIND_OF, STROKES, UNITS, named, read, split
from workflow.study.errors import StudyError

LENGTH = 300.0
OURS = {"pressure": "MPa", "force": "N"}
MASSES = {"kg", "g", "lb"}  # that hang from the muscle
PINT = {"N/mm2": "N/mm^2", "mbar": "millibar"}


@pytest.mark.parametrize("unit", [u for u, kind in KIND_OF.items() if kind in OURS])
def test_units_are_those_of_pint(unit):
    registry = pint.UnitRegistry()
    expected = registry(f"2.5 {PINT.get(unit, unit)}" + " * g_0" * (unit in MASSES))
    kind, value = read(f"2.5{unit}", LENGTH)
    assert value == pytest.approx(expected.to(OURS[kind]).magnitude, rel=1e-12)


@pytest.mark.parametrize("unit", STROKES)
def test_a_length_is_a_contraction_of_the_muscle(unit):
    in_mm = pint.UnitRegistry()(f"1.5 {unit}").to("mm").magnitude
    assert read(f"1.5 {unit}", LENGTH) == ("contraction", pytest.approx(in_mm / LENGTH))


@pytest.mark.parametrize(
    ("text", "kind", "value"),
    [
        ("12%", "contraction", 0.12),
        ("12 %", "contraction", 0.12),
        ("-3%", "contraction", -0.03),
        ("2.5bar", "pressure", 0.25),
        ("250 kPa", "pressure", 0.25),
        ("2.5e5Pa", "pressure", 0.25),
        (".3MPa", "pressure", 0.3),
        ("5kg", "force", 49.03325),
        ("0.2kN", "force", 200.0),
        ("30mm", "contraction", 0.1),
        ("10percent", "contraction", 0.1),
        ("2.5 Bar", "pressure", 0.25),
        ("2.5bars", "pressure", 0.25),
        ("5Kg", "force", 49.03325),
        ("20 Newton", "force", 20.0),
    ],
)
def test_a_quantity_is_the_decimal_that_was_written(text, kind, value):
    """To the last bit: 12 % has the state of 0.12 in a study file."""
    assert read(text, LENGTH) == (kind, value)


@pytest.mark.parametrize(
    ("text", "kind", "said"),
    [
        ("0.25", "", "has no unit"),
        ("0.12", "", "perhaps 12%"),
        ("12", "", "perhaps 12%"),
        ("0,25MPa", "", "perhaps 0.25MPa"),
        ("0,25MPa", "", "the decimal sign is a point"),
        ("fast", "", "is no quantity"),
        ("", "", "is no quantity"),
        ("5apples", "", "no such unit"),
        ("3Mpa", "pressure", "nearest: MPa"),
        ("12%", "pressure", "no pressure"),
        ("0.3MPa", "force", "no force"),
        ("300", "pressure", "300 kPa, that is 0.3 MPa"),
        ("12", "contraction", "12 %, that is 0.12"),
        ("1e999N", "", "is no quantity"),
        ("1e-30%", "", "is no quantity"),
        ("nan%", "", "is no quantity"),
        ("0x5N", "", "no such unit"),
    ],
)
def test_what_is_none_is_refused_with_what_would_be(text, kind, said):
    with pytest.raises(StudyError, match=r"\n  ") as refused:
        read(text, LENGTH, kind)
    assert said in str(refused.value)


def test_a_number_without_unit_is_of_the_study_file_where_its_kind_is_known():
    assert read("0.25", LENGTH, "pressure") == ("pressure", 0.25)
    assert read("0.12", LENGTH, "contraction") == ("contraction", 0.12)
    assert read("200", LENGTH, "force") == ("force", 200.0)


def test_words_of_one_quantity_are_joined():
    assert split(["0.25", "MPa", "12%"]) == ["0.25MPa", "12%"]
    assert split(["5", "kg", "3", "cm"]) == ["5kg", "3cm"]
    assert split(["5", "12%"]) == ["5", "12%"]
    assert split(["2.5", "Bars", "0,5", "kN"]) == ["2.5Bars", "0,5kN"]


def test_a_quantity_may_be_named():
    assert named(["stroke", "20", "mm", "p=2.5", "bar"]) == [
        ("contraction", "20mm"), ("pressure", "2.5bar"),
    ]  # fmt: skip
    assert named(["0.3", "MPa", "Load:5kg"]) == [("", "0.3MPa"), ("force", "5kg")]
    assert named(["0.3", "force", "5"]) == [("", "0.3"), ("force", "5")]
    assert named(["5kg", "stroke"]) == [("", "5kg"), ("", "stroke")]


def test_every_kind_has_units():
    assert all(UNITS.values())
