"""What is made of climbs on random muscles: misses, cost and overestimate, of made-up curves."""

from dataclasses import replace
from math import inf

import numpy as np
import pandas as pd
import pytest

from geometry.braid import LayeredBraid
from solver.load_path import PathKind
from solver.record import unreached
from workflow.analyses import random_muscles
from workflow.analyses.analysis import Solved
from workflow.analyses.ladder import table as ladder
from workflow.analyses.ladder.cases import RUNGS, SETUPS
from workflow.analyses.promise import figures, table
from workflow.analyses.promise.cases import TOLERANCES, cases
from workflow.plan import likeness
from workflow.study.schema import PromiseEntry
from workflow.study.study import load

from ..synthetic import converged

OFF = {  # share by which each rung is off
    "cylinder": 0.08,
    "membrane": 0.015,
    "solid, coarser": 0.004,
    "solid": 0.001,
    "solid, finer": 0.0001,
}
SECONDS = dict(zip(OFF, (0.1, 0.3, 0.5, 0.6, 1.5), strict=True))
TAKEN = {0.05: "membrane", 0.02: "membrane", 0.01: "solid, coarser", 0.005: "membrane"}


@pytest.fixture
def study():
    found = load("config/smoke/study.yaml")
    return replace(found, promise=PromiseEntry(seed=3, muscles=1))


@pytest.fixture
def solved(study, monkeypatch):
    """One curve; within 0.5 % a membrane was promised, which is three times as far off."""
    asked = cases(study)
    names = {each.case.key: str(each.tags["setup"]) for each in asked if each.promise is None}
    ends = {
        each.promise.key: {
            "rung": TAKEN[each.promise.tolerance],
            "holds": True,
            "by": "made up",
            "error": 2 * OFF[TAKEN[each.promise.tolerance]],
            "seconds": {each.promise.rungs["membrane"].key: 0.3},
            "own_seconds": 0.01,
        }
        for each in asked
        if each.promise
    }
    monkeypatch.setattr(table.settled, "outcome", ends.get)
    monkeypatch.setattr(table, "seconds", lambda key: SECONDS[names[key]])

    def solution(each):
        off = OFF.get(names.get(each.case.key, ""), 0.0)
        force = np.linspace(100, 10, each.case.path.states) + 100 * off
        found = unreached(each.case.path.states)
        return converged(found | {"force": force, "contraction": force / 500})

    return [Solved(each, solution(each)) for each in asked]


def test_every_muscle_has_its_rungs_and_four_climbs_that_know_of_each_other(study):
    asked = cases(study)
    climbs = [each for each in asked if each.promise]
    assert [each.tags["setup"] for each in asked if not each.promise] == list(RUNGS)
    assert [each.promise.tolerance for each in climbs] == list(TOLERANCES)
    assert climbs[0].promise.after == ()
    assert climbs[3].promise.after == tuple(each.key for each in climbs[:3])
    assert len({each.key for each in asked}) == len(asked)


def test_misses_cost_and_overestimate_are_counted_together(study, solved):
    found = table.tables(study, solved)
    choices, summary = found["promise"], found["promise_summary"].set_index("choices")
    true = choices.set_index("tolerance [1]")["true_error [1]"]
    assert true[0.02] == pytest.approx(0.015, rel=0.1)
    assert list(choices["hindsight"]) == [
        "membrane",
        "membrane",
        "solid, coarser",
        "solid, coarser",
    ]
    assert summary.loc["all", "count"] == 4
    assert summary.loc["all", "missed"] == 1
    assert summary.loc["all", "worst [1]"] == pytest.approx(3.0, rel=0.1)
    assert summary.loc["all", "median_overestimate [1]"] == pytest.approx(2.0, rel=0.1)
    assert summary.loc["all", "hindsight_seconds [s]"] == pytest.approx(0.8)
    assert summary.loc["all", "seconds [s]"] == pytest.approx(0.3 + 4 * 0.01)
    assert summary.loc["dearest with hindsight a solid", "curves"] == 1
    assert summary.loc["dearest with hindsight another", "curves"] == 0
    drawing = figures.draw(solved, found)["promise"]
    said = " ".join(text.get_text() for text in drawing.texts)
    assert "4 choices, 1 missed" in said


def test_a_rung_that_loses_states_is_not_exact_enough(solved):
    rungs = {str(s.asked.tags["setup"]): s for s in solved if not s.asked.promise}
    membrane = rungs["membrane"].solution
    lost = replace(membrane, state_status=["invalid_state", *membrane.state_status[1:]])
    rungs["membrane"] = replace(rungs["membrane"], solution=lost)
    rows = pd.DataFrame(ladder.of_curve(rungs)).set_index("rung")
    assert rows.loc["membrane", "follows"] == inf
    assert rows.loc["membrane", "lost"] == 1
    assert rows.loc["solid", "lost"] == 0


def test_the_limit_of_two_meshes_is_extrapolated_by_third_order(solved):
    rungs = {str(s.asked.tags["setup"]): s for s in solved if not s.asked.promise}
    limit = ladder.limit(rungs).states["force"]
    fine, coarse = (rungs[n].solution.states["force"] for n in ("solid, finer", "solid"))
    np.testing.assert_allclose(limit, fine + (fine - coarse) / 7)


def test_random_muscles_are_of_all_kinds_and_the_same_for_any_count():
    many = list(random_muscles.curves(24, 7))
    few = list(random_muscles.curves(5, 7))
    assert [c.case("solid").key for c in few] == [c.case("solid").key for c in many[:5]]
    assert {c.path.kind for c in many} == set(PathKind)
    assert {c.rubber.law() for c in many} == {"mooney_rivlin", "yeoh"}
    sleeved = [isinstance(c.muscle.braid, LayeredBraid) for c in many]
    assert 0 < sum(sleeved) < len(many)
    for curve in many:
        for setup in SETUPS.values():
            assert setup.case(curve).key
        groups = likeness.groups(curve.case("solid"))
        assert 0.05 <= groups["wall"] <= 0.16
        assert 0 < groups["pressure"] <= 2
