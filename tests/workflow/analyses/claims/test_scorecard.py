"""What the scorecard makes of several datasets."""

import math

import numpy as np
import pytest
import xarray as xr

from workflow.analyses.claims.judge import CLAIMS
from workflow.analyses.claims.scorecard import SHARE, scorecard, shifted

from . import made_up
from .made_up import group

EQUATION, NARROW = np.array(made_up.EQUATION), np.array(made_up.FORCE)
WIDE = 4 * NARROW


def dataset(wide=WIDE, narrow=NARROW, model="membrane"):
    forces = {("dmsp20_d40", model, 0.3): wide, ("dmsp20", model, 0.3): narrow}
    equations = {("dmsp20_d40", "geometric", 0.3): EQUATION, ("dmsp20", "geometric", 0.3): EQUATION}
    curves = {
        key: {"force": force, "inner_diameter_inflated": np.full(5, 30.0)}
        for key, force in (forces | equations).items()
    }
    return xr.DataTree.from_dict({"isobaric": group("isobaric", curves, (0, 0.05, 0.1, 0.15, 0.2))})


def row(name, trees, stiffness=315.0):
    return scorecard(trees, stiffness).set_index("id").loc[name]


def test_every_claim_has_a_row_with_a_reason():
    found = scorecard({315.0: dataset()}, 315.0)
    assert list(found["id"]) == [claim.name for claim in CLAIMS]
    assert len(set(found["id"])) == len(found)
    assert {name.rstrip("abcdefg") for name in found["id"]} == {f"C{k}" for k in range(1, 11)}
    assert found["why"].str.len().min() > 0


def test_the_range_by_stiffness_holds_all_numbers():
    found = row("C7a", {315.0: dataset(), 50.0: dataset(WIDE + 100), 650.0: dataset(WIDE - 10)})
    last = [(4 * 27 - 27 + shift) / (3 * 670 + shift) for shift in (0, 100, -10)]
    assert found["ours"] == pytest.approx(last[0])
    assert (found["lowest_by_EA"], found["highest_by_EA"]) == pytest.approx((min(last), max(last)))
    assert found["EA_with_this_verdict"] == "50 650"


def test_what_only_one_stiffness_reproduces_is_reproduced_partly():
    rises = NARROW * np.array([1.1, 2, 4, 8, 50])
    assert row("C7a", {315.0: dataset()})["verdict"] == "reproduced"
    found = row("C7a", {315.0: dataset(), 50.0: dataset(rises)})
    assert found["verdict"] == "partly"
    assert "with 50 N" in found["why"]
    assert found["EA_with_this_verdict"] == ""
    found = row("C7a", {315.0: dataset(rises), 50.0: dataset()})
    assert found["verdict"] == "not reproduced"


def test_the_fullest_model_gives_the_number():
    both = xr.DataTree.from_dict(
        {
            "isobaric": xr.concat(
                [
                    dataset(model=model, wide=wide)["isobaric"].to_dataset().sel(model=[model])
                    for model, wide in (("membrane", WIDE), ("solid", WIDE * 1.1))
                ],
                "model",
            )
        }
    )
    found = row("C7c", {315.0: both})
    assert (found["model"], found["ours"]) == ("solid", pytest.approx(4.4))


def test_the_discretisation_error_is_that_of_shifted_curves():
    found = row("C7e", {315.0: dataset()})
    small = NARROW[-1] / NARROW[0]  # a shift of SHARE changes the last force by SHARE / small
    assert 0.5 * 4 * SHARE / small < found["discretisation"] < 3 * 4 * SHARE / small


def test_shifted_curves_keep_their_shape_and_equation_one():
    tree = dataset()
    for copy in shifted(tree):
        change = (copy["isobaric"].force - tree["isobaric"].force).sel(contraction=[0, 0.2])
        assert (change.sel(model="geometric") == 0).all()
        np.testing.assert_allclose(
            np.abs(change.sel(model="membrane", muscle="dmsp20")).squeeze(), 670 * SHARE
        )
    changes = [float(c["isobaric"].force[0, -1, 0, 0, 0]) for c in shifted(tree)]
    assert len(set(changes)) == 2  # up and down
    assert changes == [float(c["isobaric"].force[0, -1, 0, 0, 0]) for c in shifted(tree)]


def test_the_error_is_that_of_the_dataset_where_it_tells():
    data = dataset()["isobaric"].to_dataset()
    told = data.assign(force_error=0 * data.force + 7.0)
    for copy in shifted(xr.DataTree.from_dict({"isobaric": told})):
        change = (copy["isobaric"].force - data.force).sel(model="membrane")
        np.testing.assert_allclose(np.abs(change), 7)


def test_nothing_testable_has_no_number():
    found = row("C10", {315.0: dataset()})
    assert found["verdict"] == "not testable"
    assert math.isnan(found["ours"])
    assert found["paper"] == "27"
