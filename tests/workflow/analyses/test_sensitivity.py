"""Sensitivities: what an input changes, roots of the cylinder, indices of known functions."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from solver.models.cylinder import curve
from solver.record import unreached
from workflow.analyses.analysis import AnalysisCase, Solved
from workflow.analyses.sensitivity import cases, figures
from workflow.analyses.sensitivity import table as tables
from workflow.analyses.sensitivity.cases import STEP, Normal
from workflow.analyses.sensitivity.table import DESIGN, OUTPUTS, UNCERTAIN
from workflow.study.study import load

from ..synthetic import converged

CONFIG = Path(__file__).parents[3] / "config" / "config.yaml"


@pytest.fixture(scope="module")
def normal():
    return Normal.of(load(CONFIG))


@pytest.fixture
def few(monkeypatch):
    monkeypatch.setattr(tables, "SAMPLES", 64)


def test_the_normal_condition_is_the_muscle_of_the_paper(normal):
    study = load(CONFIG).muscles["dmsp20"]
    for case in normal.cases({}, "solid"):
        assert (case.muscle, case.rubber, case.thread) == (study.muscle, study.rubber, study.thread)


def test_a_wider_bore_keeps_the_angle_and_the_depth_of_the_layers(normal):
    case, _ = normal.cases({"inner_diameter": 40.0}, "solid")
    assert case.muscle == load(CONFIG).muscles["dmsp20_d40"].muscle


def test_the_softest_rubber_is_silicone(normal):
    case, _ = normal.cases({"nbr": 0.0}, "cylinder")
    soft = load(CONFIG).muscles["dmsp20_silicone"].rubber
    assert (case.rubber.c10, case.rubber.c01) == (soft.c10, soft.c01)


@pytest.mark.parametrize("changes", [{}, {"thread_stiffness": 60.0}, {"contraction": 0.15}])
def test_roots_are_those_of_the_cylinder(normal, changes):
    asked = [AnalysisCase(case, "") for case in normal.cases(changes, "cylinder")]
    expected = tables.outputs(*(Solved(a, curve.solve(a.case)).states for a in asked))
    found = tables._by_cylinder(normal, changes)
    assert found == pytest.approx(expected, rel=1e-8)


def test_a_threshold_is_the_first_zero_of_force(normal):
    """The force of wide muscles vanishes once more, at several times their diameter."""
    wide = {"inner_diameter": 38.2, "lead": 197.1, "nbr": 0.4, "contraction": 0.112}
    found = tables._by_cylinder(normal, wide | {"pressure": 0.378})
    assert 0 < found["threshold_pressure"] < 0.1


def test_a_pushing_muscle_has_a_force_only(normal):
    found = tables._by_cylinder(normal, {"pressure": 0.05})
    assert found["force"] < 0
    assert np.isnan([found["threshold_pressure"], found["free_contraction"]]).all()


def test_every_input_has_both_neighbours(normal):
    asked = cases.cases(load(CONFIG))
    assert len(asked) == 2 * (1 + 2 * len(normal.inputs))
    assert set(UNCERTAIN) | set(DESIGN) == set(normal.point)


def power_law(normal, changes):
    """Outputs whose elasticities are known."""
    p = normal.point | changes
    return {
        "force": p["pressure"] ** 2 / p["c10"],
        "threshold_pressure": p["c01"],
        "free_contraction": p["c01"],
    }


def test_elasticities_and_shares_are_those_of_the_function(normal, few, monkeypatch):
    monkeypatch.setattr(tables, "_by_cylinder", power_law)
    monkeypatch.setattr(tables, "ANALYSES", {"known": {"c10": 0.2, "c01": 0.2}})
    asked = cases.cases(load(CONFIG))
    rows = tables.table(normal, [Solved(a, solution(a)) for a in asked])
    at = rows.set_index(["analysis", "model", "input", "output"])
    column = "percent per percent"
    assert at.loc[("local", "cylinder", "pressure", "force"), column] == pytest.approx(2)
    assert at.loc[("local", "cylinder", "c10", "force"), column] == pytest.approx(
        -1, rel=STEP**2 * 2
    )
    assert at.loc[("local", "cylinder", "lead", "force"), column] == 0
    assert at.loc[("local", "solid", "pressure", "force"), column] == pytest.approx(1)
    assert at.loc[("known", "cylinder", "c10", "force"), "total"] == pytest.approx(1, abs=0.1)
    assert at.loc[("known", "cylinder", "c01", "force"), "total"] == pytest.approx(0, abs=0.02)


def solution(asked):
    """Records in which the force is the pressure and nothing else changes."""

    path = asked.case.path
    states = unreached(path.states)
    pressure = path.held if path.kind == "isobaric" else path.stops[0]
    states["force"][:], states["pressure"][:], states["contraction"][:] = pressure, 0.1, 0.2
    return converged(states)


def test_the_seed_fixes_the_samples(normal, few, monkeypatch):
    monkeypatch.setattr(tables, "_by_cylinder", power_law)
    ranges = {"c10": 0.1, "c01": 0.1}  # every output changes with one of them
    first, again = (list(tables._global("x", normal, ranges)) for _ in range(2))
    assert first == again
    monkeypatch.setattr(tables, "SEED", tables.SEED + 1)
    assert list(tables._global("x", normal, ranges)) != first


def test_the_figure_has_a_row_per_analysis():
    rows = [
        {
            "analysis": "local",
            "model": model,
            "input": "c10",
            "output": output,
            "percent per percent": 1,
        }
        for model in ("cylinder", "solid")
        for output in OUTPUTS
    ] + [
        {"analysis": "known", "model": "cylinder", "input": "c10", "output": output}
        | {"first": 0.5, "total": 0.6, "total_95": 0.1}
        for output in OUTPUTS
    ]
    figure = figures.overview(pd.DataFrame(rows))
    assert len(figure.axes) == 6
