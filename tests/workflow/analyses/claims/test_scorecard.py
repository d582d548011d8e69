"""What the scorecard makes of several tables of states."""

import math
from dataclasses import replace

import numpy as np
import pytest

from workflow.analyses.claims.judge import CLAIMS
from workflow.analyses.claims.scorecard import SHARE, scorecard, shifted

from . import made_up

EQUATION, NARROW = np.array(made_up.EQUATION), np.array(made_up.FORCE)
WIDE = 4 * NARROW


def states(**wide):
    """Of the narrow and of a wide muscle, the force of which is given by model."""
    forces = {("dmsp20_d40", model, 0.3): force for model, force in wide.items()}
    forces |= {("dmsp20", model, 0.3): NARROW for model in wide}
    equations = {("dmsp20_d40", "geometric", 0.3): EQUATION, ("dmsp20", "geometric", 0.3): EQUATION}
    curves = {
        key: {"force": force, "inner_diameter_inflated": np.full(5, 30.0)}
        for key, force in (forces | equations).items()
    }
    return made_up.data("isobaric", curves, (0, 0.05, 0.1, 0.15, 0.2))


def by_membrane(wide=WIDE):
    return states(membrane=wide)


def forces(data, muscle, model):
    return data.curve("isobaric", "force", 0.3, muscle, model).to_numpy()


def row(name, data, stiffness=315.0):
    return scorecard(data, stiffness).set_index("id").loc[name]


def test_every_claim_has_a_row_with_a_reason():
    found = scorecard({315.0: by_membrane()}, 315.0)
    assert list(found["id"]) == [claim.name for claim in CLAIMS]
    assert len(set(found["id"])) == len(found)
    assert {name.rstrip("abcdefg") for name in found["id"]} == {f"C{k}" for k in range(1, 11)}
    assert found["why"].str.len().min() > 0


def test_the_range_by_stiffness_holds_all_numbers():
    found = row(
        "C7a", {315.0: by_membrane(), 50.0: by_membrane(WIDE + 100), 650.0: by_membrane(WIDE - 10)}
    )
    last = [(4 * 27 - 27 + shift) / (3 * 670 + shift) for shift in (0, 100, -10)]
    assert found["ours"] == pytest.approx(last[0])
    assert (found["lowest_by_EA"], found["highest_by_EA"]) == pytest.approx((min(last), max(last)))
    assert found["EA_with_this_verdict"] == "50 650"


def test_what_only_one_stiffness_reproduces_is_reproduced_partly():
    rises = NARROW * np.array([1.1, 2, 4, 8, 50])
    assert row("C7a", {315.0: by_membrane()})["verdict"] == "reproduced"
    found = row("C7a", {315.0: by_membrane(), 50.0: by_membrane(rises)})
    assert found["verdict"] == "partly"
    assert "with 50 N" in found["why"]
    assert found["EA_with_this_verdict"] == ""
    found = row("C7a", {315.0: by_membrane(rises), 50.0: by_membrane()})
    assert found["verdict"] == "not reproduced"


def test_the_fullest_model_gives_the_number():
    both = states(membrane=WIDE, solid=WIDE * 1.1)
    found = row("C7c", {315.0: both})
    assert (found["model"], found["ours"]) == ("solid", pytest.approx(4.4))


def test_the_discretisation_error_is_that_of_shifted_curves():
    found = row("C7e", {315.0: by_membrane()})
    small = NARROW[-1] / NARROW[0]  # a shift of SHARE changes the last force by SHARE / small
    assert 0.5 * 4 * SHARE / small < found["discretisation"] < 3 * 4 * SHARE / small


def test_shifted_curves_keep_their_shape_and_equation_one():
    data, signs = by_membrane(), []
    for copy in shifted(data):
        equation = forces(copy, "dmsp20", "geometric") - forces(data, "dmsp20", "geometric")
        assert (equation == 0).all()
        change = forces(copy, "dmsp20", "membrane") - forces(data, "dmsp20", "membrane")
        np.testing.assert_allclose(np.abs(change), 670 * SHARE)
        signs.append(float(np.sign(change[0])))
    assert set(signs) == {-1, 1}
    again = [forces(copy, "dmsp20", "membrane")[0] - 670 for copy in shifted(data)]
    assert np.sign(again).tolist() == signs


def test_the_error_is_that_of_the_states_where_it_is_known():
    data = by_membrane()
    told = replace(data.table, states=data.table.states.assign(force_error=7.0))
    for copy in shifted(replace(data, table=told)):
        change = forces(copy, "dmsp20", "membrane") - forces(data, "dmsp20", "membrane")
        np.testing.assert_allclose(np.abs(change), 7)


@pytest.mark.parametrize("model", ["membrane", "solid"])
def test_a_threshold_moves_by_how_steep_the_force_is(model):
    data = made_up.isometric(0.15, model, force=lambda p: 1000 * (p - 0.15))
    data = replace(data, model=model)
    steepness = 250 / (0.4 - 0.15)
    for copy in shifted(data):
        moved = copy.zero_force("isometric", 0.1) - 0.15
        assert abs(moved) == pytest.approx(SHARE * 250 / steepness)
        force = copy.curve("isometric", "force", 0.1) - data.curve("isometric", "force", 0.1)
        assert np.sign(force.iloc[0]) == -np.sign(moved)


def test_a_loaded_muscle_moves_by_its_stiffness():
    data, angle = made_up.isotonic(lambda load, p: p - 0.1), np.radians(24.8)
    blocked = 0.3 * 100 * np.pi * (3 * np.cos(angle) ** 2 - 1) / np.sin(angle) ** 2
    for copy in shifted(data):
        moved = copy.curve("isotonic", "contraction", 200.0)
        moved = moved - data.curve("isotonic", "contraction", 200.0)
        assert abs(moved.loc[0.3]) == pytest.approx(SHARE * blocked / (10 * 300))


def test_nothing_testable_has_no_number():
    found = row("C10", {315.0: by_membrane()})
    assert found["verdict"] == "not testable"
    assert math.isnan(found["ours"])
    assert found["paper"] == "27"
