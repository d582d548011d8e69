"""What is measured, how often, and what becomes of it; no seconds of this machine."""

import argparse
from pathlib import Path

import pandas as pd
import pytest

from workflow.analyses.accuracy import benchmark, costs
from workflow.analyses.accuracy.analysis import ANALYSIS, BENCHMARK
from workflow.programs import benchmark as program
from workflow.study.errors import StudyError
from workflow.study.study import load

ROOT = Path(__file__).parents[3]
CONFIG = ROOT / "config" / "config.yaml"


@pytest.fixture(scope="module")
def curves():
    return benchmark.chosen(CONFIG)


@pytest.fixture
def measured(curves, monkeypatch):
    """Three runs of which the second of each case takes ten seconds; and what was said."""
    runs, said = {}, []

    def cost(_, asked):
        number = runs[asked.case.key] = runs.get(asked.case.key, 0) + 1
        start = {"start [s]": 0.1} | dict.fromkeys(("assembly [s]", "factor [s]"), 1.0)
        size = {costs.UNKNOWNS: 100.0, costs.MEMORY: 30.0}
        return {costs.SOLVE: 10.0 if number == 2 else number + 0.0} | start | size

    monkeypatch.setattr(benchmark.Bench, "cost", cost)
    return benchmark.run(curves, 3, said.append), said


def test_long_curves_are_run_once_and_others_have_medians(curves, measured):
    table, _ = measured
    assert len(table) == len(curves) == len(set(table["case"]))
    long = [benchmark.expected_seconds(one.case) > benchmark.LONG for one in curves]
    assert set(table["model"][long]) == {"cell", "solid"}
    assert (table["runs"] == [1 if one else 3 for one in long]).all()
    assert (table["solve [s]"] == [1 if one else 3 for one in long]).all()


def test_time_left_is_said_when_it_is_known_and_falls_to_none(measured):
    _, said = measured
    assert "left" not in said[0]
    assert "left" in said[-1]


def test_a_curve_is_expected_to_take_longer_on_finer_meshes(curves):
    for model in ("membrane", "solid", "cell"):
        own = [one for one in curves if one.case.model == model and one.tags["set"] == "mesh"]
        by_mesh = {one.tags["mesh"]: benchmark.expected_seconds(one.case) for one in own}
        finer = "finer" if model == "cell" else "1/6"
        assert by_mesh["1/1"] < by_mesh[finer]


def test_accuracy_is_drawn_again_when_costs_were_measured(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    study = load(CONFIG)
    assert ANALYSIS.inputs(study) == []
    BENCHMARK.parent.mkdir()
    benchmark.write(pd.DataFrame({"case": ["a"], "solve [s]": [0.25]}), BENCHMARK)
    assert ANALYSIS.inputs(study) == [str(BENCHMARK)]
    assert costs.of_cases(["a", "b"])["solve [s]"].to_dict() == {"a": 0.25}


def test_a_study_without_the_muscles_of_the_paper_is_measured_with_those_of_the_default_one():
    smoke = ROOT / "config/smoke/study.yaml"
    assert program._papers(CONFIG, load(CONFIG)) == CONFIG
    assert program._papers(smoke, load(smoke)).resolve() == CONFIG


@pytest.mark.parametrize("name", ["cores", "muscles", "runs"])
def test_nothing_to_measure_is_refused(name):
    given = {"study": CONFIG, "cores": 1, "muscles": 1, "runs": 1} | {name: 0}
    with pytest.raises(StudyError, match=f"--{name} 0 is refused\n  allowed: 1 or more"):
        program.run(argparse.Namespace(**given))
