"""What the report opens with: read from tables, and what is missing is named with its command."""

import re
from pathlib import Path

import pandas as pd
import pytest
from jinja2 import Environment

from workflow.analyses.registry import ANALYSES
from workflow.plan.plan import read
from workflow.report import opening, pages

ROOT = Path(__file__).parents[3]
CLAIMS = """\
id,figure,claim,unit,paper,ours,discretisation,lowest_by_EA,highest_by_EA,verdict,why,model
C1,fig04,force falls,1,always,1.0,0.0,1.0,1.0,reproduced,because,solid
C8,fig12,best wall {{ of all }},mm,2,1.5,0.0,1.5,1.5,not reproduced,it <falls>,membrane
"""
DEVIATION = """\
model,variant,reference,interpolation,pressure [MPa],mean_relative [1]
membrane,default,festo_musclesim,pchip,all,-0.2
solid,default,festo_musclesim,pchip,all,-0.12345
solid,default,martens2017,pchip,all,0.3
solid,default,festo_musclesim,linear,all,0.4
"""


@pytest.fixture
def results(tmp_path):
    (tmp_path / "tables").mkdir()
    (tmp_path / "tables/failures.csv").write_text("case,status\n")
    return tmp_path


def test_before_the_analyses_it_says_how_to_run_them(results):
    text = opening.text(results, list(ANALYSES.values()))
    for each in ANALYSES.values():
        assert f"<code>.venv/bin/snakemake --cores 2 {each.target or each.name}</code>" in text
    assert "<table>" not in text


def test_the_verdict_is_that_of_the_tables(results):
    (results / "tables/claims.csv").write_text(CLAIMS)
    (results / "tables/deviation.csv").write_text(DEVIATION)
    text = opening.text(results, list(ANALYSES.values()))
    assert "<b>-12.3 %</b> (the paper: -9.9 %)" in text
    assert "Of 2 claims: 1 reproduced, 1 not reproduced." in text
    assert '<tr class="not-reproduced"><td>C8: best wall {{ of all }}</td><td>2 mm</td>' in text
    assert "it &lt;falls&gt;" in text
    assert "snakemake --cores 2 claims<" not in text
    shown = Environment().from_string(text).render()
    assert "best wall {{ of all }}" in shown


def test_a_study_of_something_else_has_no_verdict(results):
    text = opening.text(results, [])
    assert "Does the paper hold" not in text
    assert "every case reached all its states" in text


def test_accuracy_is_by_model_with_its_cost(monkeypatch):
    rows = pd.DataFrame(
        {
            "set": ["mesh", "mesh", "mesh", "tube"],
            "model": ["cylinder", "solid", "solid", "solid"],
            "mesh": [None, "1/1", "1/2", "1/1"],
            "case": ["a", "b", "c", "d"],
            "total_error [1]": [0.006, 0.00014, 0.1, 0.1],
        }
    )
    spent = pd.DataFrame({"solve [s]": [0.13], "memory [MB]": [33.0]}, index=["a"])
    monkeypatch.setattr(opening.costs, "of_cases", lambda cases: spent)
    found = opening.by_model(rows)
    assert found["error [%]"].tolist() == pytest.approx([0.6, 0.014])
    assert found["solve [s]"].tolist()[0] == 0.13
    assert found["solve [s]"].isna().tolist() == [False, True]


def test_pages_that_are_ready_are_written(results):
    """After a usual run: those of its figures and tables, and none of an analysis."""
    plan = read(ROOT / "config/smoke/study.yaml")
    (results / "figures").mkdir()
    (results / "figures/fig04.png").write_bytes(b"picture")
    asked = pages.of_study(plan, results, ["fig04", "fig08"], [results / "tables/failures.csv"])
    ready = [page for page in asked if page.is_ready]
    assert [page.name for page in ready] == ["fig04", "failures"]
    written = opening.prepare(plan, results, ready)
    assert {path.name for path in (results / "report").iterdir()} == {
        "fig04.html",
        "failures.html",
        "opening.rst",
    }
    assert re.match(r"{% raw %}\n\.\. raw:: html", written.read_text())
