"""The analysis of time: its cases, the three elements, the formula of a sleeve, its tables."""

from pathlib import Path

import numpy as np
import pytest

from solver import net
from workflow.analyses.time import cases, sleeve, table
from workflow.analyses.time.three_elements import ThreeElements
from workflow.study.study import load

from .solutions import made_up

CONFIG = Path(__file__).parents[3] / "config" / "config.yaml"


@pytest.fixture(scope="module")
def study():
    return load(CONFIG)


def test_cases_are_of_the_muscle_of_the_paper_and_each_of_its_own(study):
    asked = cases.cases(study)
    assert len({one.case.key for one in asked}) == len(asked)
    for one in asked:
        assert one.case.muscle == study.muscles["dmsp20"].muscle
        assert one.case.rubber == study.muscles["dmsp20"].rubber


def test_three_elements_are_found_again(study):
    muscle = study.muscles["dmsp20"].muscle
    e = np.linspace(0, 0.2, 41)
    rate = np.where(np.arange(41) % 2, 0.1, -0.1)
    pressure = np.full(41, 0.3)
    force = net.force(muscle, pressure, e) - 50 - 300 * e - 40 * rate
    found = ThreeElements.fitted(muscle, pressure, e, rate, force)
    assert (found.offset, found.spring, found.damper) == pytest.approx((50, 300, 40))
    np.testing.assert_allclose(found.force(pressure, e, rate), force)
    assert found.width(0.1) == pytest.approx(8)
    assert found.width(1.0) == pytest.approx(80)


def test_half_the_width_of_a_sleeve(study):
    """2.1 to 4.2 N at 0.3 MPa, 10 %."""
    muscle = study.muscles["dmsp20"].muscle
    found = [sleeve.width(muscle, 0.3, 0.1, 15.05, contact) / 2 for contact in sleeve.CONTACTS]
    assert found == pytest.approx([2.1, 4.2], abs=0.05)


def test_tables(study):
    tables = table.tables(study, [made_up(one) for one in cases.cases(study)])
    rows = tables["time"]
    loops = rows[rows["set"].isin(["rate", "pressure"])]
    assert loops["width"].to_list() == pytest.approx([8.0] * len(loops), abs=0.5)
    by_rate = rows[rows["set"] == "rate"]["three elements, width [N]"].to_numpy()
    np.testing.assert_allclose(by_rate[1:] / by_rate[:-1], 10)  # a damper
    assert set(tables["time_curves"]["set"]) == {"rate", "pressure", "frequency", "step"}
    assert len(tables["time_vibrations"]) == 3 * len(cases.VIBRATIONS)


def test_a_loop_that_was_not_solved_has_no_numbers(study):
    solved = [made_up(one) for one in cases.cases(study)]
    for values in solved[1].solution.states.values():
        values[:] = np.nan
    rows = table.tables(study, solved)["time"]
    assert np.isnan(rows.loc[1, "width"])
    assert rows["three elements, width [N]"].isna().all()
