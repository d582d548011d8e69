"""The way of every kind of path, and the paths that make no sense."""

import math
from dataclasses import replace

import numpy as np
import pytest

from solver import load_path
from solver.load_path import RAMP_STEPS, ZERO_FORCE, Control, LoadPath, PathKind
from solver.refusal import UnsolvableCase

EPS, P, F = Control.CONTRACTION, Control.PRESSURE, Control.FORCE


def path(kind: str, held: float, *stops: float, **more) -> LoadPath:
    return LoadPath(kind=kind, held=held, stops=stops, **more)


def targets(way) -> list[tuple]:
    """Each waypoint as {control: target} and its stop."""
    return [
        ({w.first: pytest.approx(w.first_target), w.second: pytest.approx(w.second_target)}, w.stop)
        for w in way
    ]


def recorded(way) -> list[tuple]:
    return [(seen, stop) for seen, stop in targets(way) if stop is not None]


def ramp(way) -> list[dict]:
    return [seen for seen, stop in targets(way)[: -len(recorded(way))] if stop is None]


def test_isobaric_way():
    (way,) = path("isobaric", 0.4, 0.0, 0.1, 0.2).ways()
    assert ramp(way) == [{EPS: 0, P: 0.1}, {EPS: 0, P: 0.2}, {EPS: 0, P: 0.3}, {EPS: 0, P: 0.4}]
    assert recorded(way) == [
        ({P: 0.4, EPS: 0.0}, 0),
        ({P: 0.4, EPS: 0.1}, 1),
        ({P: 0.4, EPS: 0.2}, 2),
    ]


def test_isobaric_way_extends_first_and_returns():
    """Longer, further each time, then home and shorter: nothing is skipped."""
    (way,) = path("isobaric", 0.4, -0.1, -0.05, 0.0, 0.1).ways()
    contractions = [w.second_target for w in way[RAMP_STEPS:]]
    assert contractions == [-0.05, -0.1, 0.0, 0.0, 0.1]
    assert [w.stop for w in way[RAMP_STEPS:]] == [1, 0, None, 2, 3]


@pytest.mark.parametrize("kind", ["isobaric", "isometric"])
def test_the_state_of_zero_force_changes_no_way(kind):
    """It is looked for when the stops are done."""
    plain, curve = (path(kind, 0.1, 0.0, 0.2, zero_force=zero) for zero in (False, True))
    assert (plain.states, curve.states) == (2, 3)
    assert plain.ways() == curve.ways()


def test_without_pressure_the_unloaded_muscle_is_on_the_curve():
    (way,) = path("isobaric", 0.0, 0.1, 0.2, zero_force=True).ways()
    assert targets(way)[0] == ({P: 0, EPS: 0}, None)


def test_without_pressure_there_is_no_ramp():
    (way,) = path("isobaric", 0.0, 0.0, 0.1).ways()
    assert [w.stop for w in way] == [0, 1]


def test_isometric_way_falls_from_the_highest_pressure():
    falling = path("isometric", 0.1, 0.0, 0.2, 0.4).ways()[0]
    assert targets(falling)[RAMP_STEPS - 1] == ({EPS: 0, P: 0.4}, None)
    assert targets(falling)[2 * RAMP_STEPS - 1] == ({EPS: 0.1, P: 0.4}, None)
    assert recorded(falling) == [
        ({EPS: 0.1, P: 0.4}, 2),
        ({EPS: 0.1, P: 0.2}, 1),
        ({EPS: 0.1, P: 0.0}, 0),
    ]


def test_isometric_second_way_rises():
    """For what lies below a highest pressure that cannot be reached."""
    _, rising = path("isometric", 0.1, 0.0, 0.2, 0.4).ways()
    assert targets(rising)[RAMP_STEPS - 1] == ({EPS: 0.1, P: 0}, None)
    assert [stop for _, stop in recorded(rising)] == [0, 1, 2]


def test_isometric_way_at_the_initial_length_does_not_contract():
    falling = path("isometric", 0.0, 0.1, 0.2).ways()[0]
    assert len(falling) == RAMP_STEPS + 2


def test_isotonic_way():
    (way,) = path("isotonic", 200.0, 0.0, 0.3).ways()
    assert ramp(way) == [{P: 0, F: 50}, {P: 0, F: 100}, {P: 0, F: 150}, {P: 0, F: 200}]
    assert recorded(way) == [({F: 200, P: 0}, 0), ({F: 200, P: 0.3}, 1)]


def test_isotonic_way_without_rubber_falls_from_the_highest_pressure():
    """A net without rubber closes where there is no pressure."""
    (way,) = path("isotonic", 200.0, 0.1, 0.3).ways(rubber=False)
    loads = way[RAMP_STEPS : 2 * RAMP_STEPS]
    assert [(w.first_target, w.second_target) for w in loads] == [
        (0.3, 50),
        (0.3, 100),
        (0.3, 150),
        (0.3, 200),
    ]
    assert recorded(way) == [({F: 200, P: 0.3}, 1), ({F: 200, P: 0.1}, 0)]


@pytest.mark.parametrize("kind", PathKind)
def test_every_stop_is_on_every_way(kind):
    curve = path(kind, 0.1, 0.1, 0.2, 0.3)
    for way in curve.ways():
        assert sorted(w.stop for w in way if w.stop is not None) == list(range(curve.states))


@pytest.mark.parametrize(
    ("field", "arguments"),
    [
        ("stops", ("isobaric", 0.3)),
        ("stops", ("isobaric", 0.3, 0.1, 0.0)),
        ("stops", ("isobaric", 0.3, 0.1, 0.1)),
        ("stops", ("isobaric", 0.3, 0.7)),
        ("stops", ("isobaric", 0.3, -0.6)),
        ("stops", ("isobaric", 0.3, 10)),  # per cent
        ("stops", ("isobaric", 0.3, math.nan)),
        ("stops", ("isobaric", 0.3, "0.1")),
        ("stops", ("isobaric", 0.3, True)),
        ("held", ("isobaric", -0.3, 0.1)),
        ("held", ("isobaric", math.inf, 0.1)),
        ("held", ("isobaric", None, 0.1)),
        ("held", ("isometric", 10, 0.3)),
        ("stops", ("isometric", 0.1, -0.1)),
        ("stops", ("isotonic", 200, -0.1)),
        ("held", ("isotonic", math.nan, 0.1)),
    ],
)
def test_refused_path(field, arguments):
    with pytest.raises(UnsolvableCase) as refused:
        path(*arguments)
    assert refused.value.field == field


def test_a_muscle_may_be_pushed():
    assert path("isotonic", -50.0, 0.1).held == -50


def test_there_is_no_zero_force_under_a_load():
    with pytest.raises(UnsolvableCase, match="zero_force"):
        path("isotonic", 200.0, 0.1, zero_force=True)


@pytest.mark.parametrize("value", ["yes", 1, None])
def test_zero_force_is_true_or_false(value):
    with pytest.raises(UnsolvableCase, match="zero_force"):
        path("isobaric", 0.3, 0.1, zero_force=value)


def test_an_unknown_kind_is_refused():
    with pytest.raises(UnsolvableCase, match="isobaric, isometric, isotonic"):
        path("isochoric", 0.3, 0.1)


# --- what is said of a kind -----------------------------------------------------------------------


def test_words_of_every_kind():
    words = {kind: (kind.held.key, kind.swept.key, kind.follows) for kind in PathKind}
    assert words == {
        "isobaric": ("pressure", "contraction", "force"),
        "isometric": ("contraction", "pressure", "force"),
        "isotonic": ("load", "pressure", "contraction"),
    }
    assert ZERO_FORCE == {"free_contraction": "isobaric", "threshold_pressure": "isometric"}
    assert [P.text(0.3), EPS.text(0.1), F.text(200)] == ["0.3 MPa", "10 %", "200 N"]
    assert path("isotonic", 1.0, 0.1).units == {"held": "N", "stops": "MPa"}
    assert F.variable == "force"


def test_where_the_way_matters_stops_may_turn_round_and_repeat(
    monkeypatch, make_case, solve_case, mesh_of
):
    """States are told apart by their number; fields are of every state at the stop."""
    kind = PathKind.ISOBARIC
    with pytest.raises(UnsolvableCase, match="stops"):
        path(kind, 0.3, 0.0, 0.1, 0.05, 0.1)
    words = load_path.WORDS | {kind: replace(load_path.WORDS[kind], by_way=True)}
    monkeypatch.setattr(load_path, "WORDS", words)
    there_and_back = path(kind, 0.3, 0.0, 0.1, 0.05, 0.1)
    (way,) = there_and_back.ways()
    assert [w.second_target for w in way[RAMP_STEPS:]] == [0.0, 0.1, 0.05, 0.1]
    for model in ("cylinder", "membrane"):
        fields = (0.1,) if model == "membrane" else ()
        solution = solve_case(make_case(model=model, path=there_and_back, fields_at=fields))
        force = solution.states["force"]
        np.testing.assert_allclose(solution.states["contraction"], [0.0, 0.1, 0.05, 0.1])
        assert force[0] > force[2] > force[1]
        assert force[3] == pytest.approx(force[1], rel=1e-6)
        assert set(solution.fields) == ({1, 3} if fields else set())
