"""What the solver says is said to an engineer in words, with the numbers that it has."""

import re
from pathlib import Path

import pytest

from solver import judge
from workflow.answers import words

ROOT = Path(__file__).parents[3]


def test_why_there_is_no_state():
    said = words.no_state(
        "crumpling of a wall without bending stiffness, compressed along its meridian, at "
        "contraction 0.0544922, pressure 0.1 MPa, force -3.25383 N"
    )
    assert said.endswith("crumples on the way there (5.4 %, 0.1 MPa)")
    nowhere = "overhang of a wall without bending stiffness, at contraction -0, pressure 0.2 MPa"
    assert "(0 %, 0.2 MPa)" in words.no_state(nowhere)
    assert "turned inside out" in words.no_state("turned inside out: the smallest margin is -1")
    assert words.no_state("a model of one's own has another") == "a model of one's own has another"


def test_every_kind_of_limit_and_of_lost_state_has_words():
    for reason in (*judge.LIMITS, judge.LOST):
        assert words.no_state(reason) != reason


@pytest.mark.parametrize("pattern", words.NOTES)
def test_notes_are_those_that_the_solver_has(pattern):
    """A note that is worded anew there would not be understood here."""
    sources = (ROOT / "solver/judge.py", ROOT / "solver/smoothing.py")
    text = re.sub(r"\{[^{}]*\}", "X", "".join(path.read_text() for path in sources))
    assert re.search(pattern, text)


def test_what_a_note_says_stays():
    note = (
        "the smoothing of slack threads adds -0.2 N, 5 % of it; a slack.width of 4e-05 brings that"
    )
    assert words.of_state(note) == (
        "threads go slack over a small strain and not at once, which adds -0.2 N, 5 % of it; "
        "numerics: {slack: {width: 4e-05}} in the study brings that"
    )
    two = words.of_state("2 unstable modes at fixed contraction and pressure; threads stretched")
    assert two.startswith("it would buckle or bulge here, in 2 ways")
    assert two.endswith("; threads stretched")
