"""The rule of deviations, on curves whose deviation is known."""

import numpy as np
import pandas as pd
import pytest

from workflow.data import deviation, reference
from workflow.data.deviation import ALL, CONTRACTIONS, RELATIVE, SHARE
from workflow.data.reference import ForceMap
from workflow.data.states import STOP, Table

STEPS = np.round(np.arange(0, 0.26, 0.05), 2)
LINE = np.array([(p, e, 1000 * p - 1000 * p / 0.2 * e) for p in (0.2, 0.3) for e in STEPS])
MAP = ForceMap("line", "line", LINE, np.empty((0, 3)))  # no force at 20 %


def curves(share=0.0, shift=0.0, status="converged"):
    """The map's own force, changed by a share of it and by a constant [N]."""
    names = ["muscle", "model", "variant", "path", "held"]
    pressures = (0.2, 0.3)
    named = [("one", "solid", "default", "isobaric", pressure) for pressure in pressures]
    states = [
        {"curve": k, "point": STOP, "pressure": p, "contraction": e, "status": status}
        | {"force": float(MAP.force(e, p)) * (1 + share) + shift}
        for k, p in enumerate(pressures)
        for e in STEPS
    ]
    muscles = pd.DataFrame(index=["one"])
    return Table(muscles, pd.DataFrame(named, columns=names), pd.DataFrame(states))


def rows(found, **maps):
    table = deviation.table(found, {"one": maps or {"line": MAP}})
    return table[table["interpolation"] == "pchip"].set_index("pressure [MPa]")


@pytest.mark.parametrize("share", [-0.1, 0.0, 0.2])
def test_a_relative_deviation_is_found_with_its_sign(share):
    found = rows(curves(share)).loc[ALL]
    assert found["mean_relative [1]"] == pytest.approx(share)
    assert found["largest_relative [1]"] == pytest.approx(share)
    assert found["mean_of_largest_force [1]"] == pytest.approx(share / 2)  # mean of 1 ... 0


def test_small_references_count_only_against_the_largest_force():
    found = rows(curves(shift=-30)).loc[0.3]
    assert found["states"] == 5
    assert found["states_relative"] == 4
    assert found["left_out_small_reference"] == 1
    assert found["mean_of_largest_force [1]"] == pytest.approx(-0.1)
    expected = np.mean([-30 / 300, -30 / 225, -30 / 150, -30 / 75])
    assert found["mean_relative [1]"] == pytest.approx(expected)
    assert found["largest_relative [1]"] == pytest.approx(-0.4)


def test_what_is_not_converged_or_outside_the_map_is_left_out():
    assert rows(curves(status="invalid_state")).loc[ALL, "left_out_not_solved"] == 10
    short = ForceMap("short", "short", LINE[LINE[:, 1] < 0.12], np.empty((0, 3)))
    found = rows(curves(), short=short).loc[0.2]
    assert (found["states"], found["left_out_outside_the_map"]) == (3, 2)


def test_interpolations_agree_at_the_points_and_differ_between_them():
    sim = reference.musclesim()
    at = sim.points[sim.points[:, 0] == 0.3]
    forces = {}
    for how in deviation.INTERPOLATIONS:
        found = deviation.interpolated(sim, how)
        if how != "surface":
            np.testing.assert_allclose(found.force(at[:, 1], 0.3), at[:, 2], atol=1e-9)
        forces[how] = found.force(CONTRACTIONS, 0.3)
        assert np.isnan(found.force([0.5], 0.3)).all()
        assert np.isnan(found.force([0.1], 0.7)).all()
    for a, b in ((a, b) for a in forces for b in forces if a < b):
        assert 1 < np.abs(forces[a] - forces[b]).max() < 60, (a, b)


def test_a_muscle_without_maps_is_compared_with_none():
    assert deviation.table(curves(), {}).empty
    assert deviation.table(curves(), {"another": {"line": MAP}}).empty


def test_states_hold_both_measures():
    found = deviation.states(MAP, curves(0.1).states)
    assert found[RELATIVE].count() == 8
    assert found[SHARE].count() == 10
