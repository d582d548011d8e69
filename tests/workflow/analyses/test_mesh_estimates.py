"""Reported errors of meshes against true ones: by made-up curves whose errors are known."""

import numpy as np
import pytest

from solver.record import unreached
from workflow.analyses.analysis import Solved
from workflow.analyses.mesh_estimates import table
from workflow.analyses.mesh_estimates.cases import REFINEMENTS, cases
from workflow.plan import mesh_error
from workflow.study.study import load

from ..synthetic import converged

FIRST = 3  # curves: one of every kind of path
STOPS = 9 + 8 + 8  # of these


@pytest.fixture
def asked():
    return cases(load("config/smoke/study.yaml"))[: FIRST * len(REFINEMENTS)]


@pytest.fixture
def solved(asked, monkeypatch):
    """The default mesh is off by 1 %, of second order; of it 1.5 % are estimated, or less."""

    def estimated(case, solution, name, finer=None):
        if finer is not None:
            return mesh_error.OF_PAIR * np.abs(solution.states[name] - finer.states[name])
        values = np.abs(solution.states[name])
        shares = np.full(case.path.states, 0.015)
        shares[len(case.path.stops) - 1] = 0.005
        return shares * values.max()

    monkeypatch.setattr(table.mesh_error, "error", estimated)

    def solution(each):
        off = 0.01 / each.tags["refinement"] ** 2
        values = np.linspace(1, 0.1, each.case.path.states) + off
        names = ("force", "contraction", "pressure", "inner_diameter_inflated", "volume")
        states = unreached(each.case.path.states)
        return converged(states | {name: values.copy() for name in names})

    return [Solved(each, solution(each)) for each in asked]


def test_all_curves_have_600_states_and_three_meshes():
    asked = cases(load("config/smoke/study.yaml"))
    assert sum(len(each.case.path.stops) for each in asked) == 600 * len(REFINEMENTS)
    assert len({each.key for each in asked}) == len(asked)
    for model, part in (("solid", "section"), ("membrane", "meridian")):
        own = [each.case for each in asked if each.case.model == model]
        found = [getattr(case.numerics, part).refinement for case in own[:3]]
        assert found == [1, 2, 4]
        assert {case.path.kind.value for case in own} == {"isobaric", "isometric", "isotonic"}
        assert all(c.path.zero_force == (c.path.kind.value == "isometric") for c in own)


def test_what_is_covered_is_counted_by_what_is_reported(solved):
    found = table.tables(None, solved)["mesh_estimates_summary"]
    assert set(found["quantity"]) == {
        "force and contraction",
        "force",
        "contraction",
        "inner_diameter",
        "volume",
        "threshold_pressure",
    }
    assert set(found.loc[found["quantity"] == "force", "path"]) == {"isobaric", "isometric"}
    found = found.set_index(["model", "quantity", "path", "reported"])
    for model in ("all", "solid"):
        guessed, measured = (
            found.loc[model, "force and contraction", "all", by] for by in ("estimated", "measured")
        )
        of = (guessed["states"], guessed["curves"], guessed["not judged"], guessed["not known"])
        assert of == (STOPS, FIRST, 0, 0)
        assert guessed["covered [1]"] == pytest.approx(1 - FIRST / STOPS)
        assert guessed["median overestimate [1]"] == pytest.approx(1.6 * 1.01, rel=1e-6)
        assert measured["covered [1]"] == 1
        twice = 2 * 0.75 / (1 - 1 / 16)
        assert measured["median overestimate [1]"] == pytest.approx(twice, rel=1e-6)
    zero = found.loc["solid", "threshold_pressure", "all", "measured"]
    assert (zero["states"], zero["curves"], zero["covered [1]"]) == (1, 1, 1)


def test_a_state_that_a_mesh_has_not_is_counted_and_not_judged(solved):
    meshes = dict(zip(REFINEMENTS, solved, strict=False))
    meshes[4].solution.state_status[0] = "invalid_state"
    rows = list(table.of_curve(meshes))
    assert {row["state"] for row in rows if np.isnan(row["true [1]"])} == {0}
    found = table.summary(table.tables(None, solved)["mesh_estimates"]).iloc[0]
    assert (found["states"], found["not judged"]) == (STOPS - 1, 1)
