"""The analysis of time: its cases, the three elements, the sleeve, its tables."""

from pathlib import Path

import numpy as np
import pytest

from solver import net
from workflow.analyses.accuracy import benchmark as accuracy_benchmark
from workflow.analyses.time import benchmark, cases, table
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
        tube = study.muscles["dmsp20"].muscle
        assert one.case.muscle == (cases.sleeved(tube) if one.tags["set"] == "sleeve" else tube)
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


def test_the_sleeve_has_the_threads_of_the_muscle(study):
    muscle = study.muscles["dmsp20"].muscle
    found = cases.sleeved(muscle)
    assert found.braid.layer_angles[0] == pytest.approx(muscle.braid.angle)
    assert found.braid.threads == (muscle.braid.threads,)
    rubbing = [one.case for one in cases.cases(study) if one.tags["set"] == "sleeve"]
    assert {case.friction.contact for case in rubbing} == set(cases.CONTACTS)
    assert not any(case.remembers for case in rubbing)


def test_what_a_step_costs_leaves_out_the_start(study):
    """3 ms a step of an elastic muscle and 4 with memory, beside 0.2 s of start and mesh."""
    asked = benchmark.cases(study)
    assert [one.case.remembers for one in asked[:4]] == [False, False, True, True]
    per_step = {"elastic": 0.003, "memory": 0.004}
    costs = [0.2 + 100 * one.tags["cycles"] * per_step[one.tags["rubber"]] for one in asked]
    rows = benchmark.table(asked, costs)
    assert rows["model"].to_list() == ["membrane", "cylinder", "solid"]
    np.testing.assert_allclose(rows["step, elastic [ms]"], 3)
    np.testing.assert_allclose(rows["ratio [1]"], 4 / 3)
    np.testing.assert_allclose(rows["difference [ms]"], 1)
    np.testing.assert_allclose(rows["three cycles, memory [s]"], 1.4)


def test_tables(study):
    tables = table.tables(study, [made_up(one) for one in cases.cases(study)])
    rows = tables["time"]
    loops = rows[rows["set"].isin(["rate", "pressure", "wall", "sleeve"])]
    assert loops["width"].to_list() == pytest.approx([8.0] * len(loops), abs=0.5)
    by_rate = rows[rows["set"] == "rate"]["three elements, width [N]"].to_numpy()
    np.testing.assert_allclose(by_rate[1:] / by_rate[:-1], 10)  # a damper
    assert set(tables["time_curves"]["set"]) == {
        *("rate", "pressure", "frequency", "step"),
        *("wall", "sleeve"),
    }
    assert len(tables["time_vibrations"]) == 3 * len(cases.VIBRATIONS)


def test_a_loop_that_was_not_solved_has_no_numbers(study):
    solved = [made_up(one) for one in cases.cases(study)]
    for values in solved[1].solution.states.values():
        values[:] = np.nan
    rows = table.tables(study, solved)["time"]
    assert np.isnan(rows.loc[1, "width"])
    assert rows["three elements, width [N]"].isna().all()


def test_the_benchmark_solves_a_curve_of_26_states_on_two_meshes(study):
    once, twice = accuracy_benchmark.of_solid(study, 1).values()
    assert 0 < once < twice < 60
