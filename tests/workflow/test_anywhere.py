"""The same bytes wherever a study runs: in batches, in any environment, whatever the dates."""

import os
import re
import signal
import time

import pytest

from solver.freefem import Limits
from solver.load_path import LoadPath
from solver.process import fork
from workflow.analyses.analysis import AnalysisCase
from workflow.run import batches

from .project import STUDY, Project
from .test_faults import fake

SCENES = """\
scenes:
  fig90:
    path: isobaric
    muscles: [one, soft]
    pressure: {from: 0.1, to: 0.3, step: 0.1}
    contraction: [0, 0.05]
    models: [geometric, cylinder]
"""
LIMITS = Limits(wall_time=300, memory=4000)
HOSTILE = {
    "MPLBACKEND": "module://matplotlib_inline.backend_inline",  # of a notebook, not installed here
    "PYTHONSAFEPATH": "1",
    "OMP_NUM_THREADS": "no number",
}


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    """A project of models without a mesh, and the bytes of its results."""
    project = Project(tmp_path_factory.mktemp("anywhere") / "copy")
    project.write("config/config.yaml", STUDY.partition("scenes:")[0] + SCENES)
    status, said = project.run()
    assert status == 0, said
    return project, results(project)


def results(project):
    """All but the stamps of batches, which are as many as there are batches."""
    return {name: text for name, text in project.results().items() if "solved/" not in name}


@pytest.fixture
def foreign(tmp_path):
    """A folder of somebody else's modules that have the names of ours."""
    for name in ("solver", "workflow", "geometry"):
        (tmp_path / "foreign" / name).mkdir(parents=True)
        (tmp_path / "foreign" / name / "__init__.py").write_text("raise SystemExit('foreign')\n")
    return tmp_path / "foreign"


def test_batches_in_a_hostile_environment_from_files_of_the_future(
    plain, foreign, tmp_path, monkeypatch
):
    project, expected = plain
    copy = project.copy(tmp_path / "project; with 'all' of it")
    copy.clear()
    tomorrow = time.time() + 86400
    for path in copy.folder.rglob("*"):
        os.utime(path, (tomorrow, tomorrow))
    for name, value in (HOSTILE | {"PYTHONPATH": str(foreign)}).items():
        monkeypatch.setenv(name, value)
    status, output = copy.run("--config", "batches=3")
    assert status == 0, output
    assert len(re.findall(r"of3\.txt", " ".join(copy.results()))) > 1
    assert results(copy) == expected
    for path in copy.folder.rglob("*"):
        os.utime(path, (tomorrow, tomorrow))
    status, output = copy.run("--config", "batches=3")
    assert status == 0, output
    assert "Nothing to be done" in output


def test_ctrl_c_ends_with_one_sentence(project, tmp_path):
    copy = project.copy(tmp_path / "project")
    copy.clear()
    run = copy.start(path=fake(tmp_path, membrane="sleep 600", solid="sleep 600"))
    log = copy.folder / "results/logs"
    end = time.monotonic() + 120
    while not any("begins" in path.read_text() for path in log.glob("solved/**/*.log")):
        assert run.poll() is None
        assert time.monotonic() < end
        time.sleep(0.1)
    os.killpg(run.pid, signal.SIGINT)
    output, _ = run.communicate(timeout=60)
    assert run.returncode != 0
    assert output.rstrip().splitlines()[-1].endswith("the next run goes on from there.")
    assert output.count("Stopped.") == 1
    assert "Traceback" not in output
    assert "rror" not in output
    assert not list((copy.folder / "results").rglob(".*.h5"))


def test_two_studies_that_solve_the_same_case_at_once_do_no_harm(make_case, tmp_path, monkeypatch):
    """Each sees a record or none, and in the end there is what either would have written."""
    monkeypatch.chdir(tmp_path)
    paths = [LoadPath(kind="isobaric", held=p, stops=(0.0, 0.1)) for p in (0.1, 0.2, 0.3)]
    cases = [make_case(model="cylinder", path=path) for path in paths]
    cases.append(make_case(model="membrane", path=paths[0]))
    asked = {case.key: AnalysisCase(case, case.model) for case in cases}

    def study(number):
        return batches.solve(asked, 2, LIMITS, tmp_path / f"logs/{number}.log")

    def records():
        return {path.name: path.read_bytes() for path in (tmp_path / "results/cases").iterdir()}

    runs = [fork(lambda number=number: study(number)) for number in range(2)]
    assert [os.waitpid(run, 0)[1] for run in runs] == [0, 0]
    assert batches.to_solve(asked) == {}
    found = records()
    assert len(found) == len(asked)
    for name in found:
        (tmp_path / "results/cases" / name).unlink()
    assert study("alone") == 0
    assert records() == found
