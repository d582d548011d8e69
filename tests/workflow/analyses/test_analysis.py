"""Cases of an analysis by name: listed, and tried again only where they failed and when asked."""

import pytest

from solver import record, solve
from solver.status import CaseStatus
from workflow.__main__ import main
from workflow.analyses import analysis
from workflow.analyses.analysis import AnalysisCase
from workflow.data import records


@pytest.fixture
def failed(make_case, tmp_path, monkeypatch):
    """An analysis of three cases: one damaged, one without a mesh, one with an answer."""
    paths = [make_case(model=model) for model in ("geometric", "membrane", "solid")]
    cases = tuple(AnalysisCase(case, f"a {case.model}") for case in paths)
    monkeypatch.chdir(tmp_path)
    known = analysis.Analysis(name="some", title="", chapter="", tables={"some": None})
    monkeypatch.setattr(analysis, "named", {"some": known}.__getitem__)
    monkeypatch.setattr(analysis.Analysis, "solves_cases", True)
    monkeypatch.setattr(analysis, "cases", lambda name, _: cases if name == "some" else None)
    for folder in (records.FOLDER, tmp_path / "results/meshes"):
        folder.mkdir(parents=True)
    status = CaseStatus.CONVERGED, CaseStatus.MESH_FAILED, CaseStatus.LIMIT_POINT
    for case, ended in zip(paths, status, strict=True):
        record.write(records.path_of(case.key), case, solve.failure(case, ended, "why"))
    (tmp_path / "results/meshes" / cases[1].mesh).touch()
    records.path_of(paths[0].key).write_bytes(b"rubbish")
    return cases


def test_failed_cases_of_an_analysis_are_tried_again_when_asked(failed, tmp_path, capsys):
    assert main(["cases", "--name", "some"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert [line.split()[1] for line in said] == ["damaged", "mesh_failed", "limit_point"]
    assert main(["retry", "--name", "some"]) == 0
    assert len(capsys.readouterr().out.splitlines()) == 2
    assert [p.stem for p in records.FOLDER.iterdir()] == [failed[2].case.key]
    assert list((tmp_path / "results/meshes").iterdir()) == []
    assert main(["retry", "--name", "some"]) == 0
    assert capsys.readouterr().out == ""


def test_an_analysis_that_is_not_there(capsys):
    assert main(["retry", "--name", "robustnes"]) == 1
    assert "nearest: robustness" in capsys.readouterr().err


def test_a_damaged_record_of_an_analysis_is_named(failed, tmp_path, capsys):
    table = tmp_path / "results/tables/some.csv"
    assert main(["analysis", "--name", "some"]) == 1
    said = capsys.readouterr().err
    assert f"{records.path_of(failed[0].case.key)}: should hold a geometric" in said
    assert not table.exists()
