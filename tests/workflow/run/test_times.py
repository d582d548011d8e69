"""Where the time of whole runs goes, by a Snakemake that takes no time."""

import csv
import sys

import pytest

from workflow.run import times
from workflow.study.errors import StudyError

# What a run leaves: what its programs took, what FreeFEM took of that, a dataset.
SNAKEMAKE = """\
#!{python}
import json, os, pathlib, sys
place = pathlib.Path(sys.argv[sys.argv.index("--directory") + 1])
name = pathlib.Path(sys.argv[-1].removeprefix("study=")).stem
results, cost = place / "results/studies" / name, place / "results/cost"
results.mkdir(parents=True, exist_ok=True)
cost.mkdir(exist_ok=True)
with open(os.environ["MUSCLE_TIMES"], "a") as notes:
    notes.write("solve 0.003\\ngather 0.002\\ndraw 0.001\\ngather 0.001\\n")
if name == "failing":
    sys.exit("this was wrong")
(results / "dataset.nc").touch()
(cost / "a.json").write_text(json.dumps({{"freefem_cpu_seconds": 0.002}}))
(cost / "b.json").write_text(json.dumps({{"solve_cpu_seconds": 1}}))
sys.exit(name == "other")  # of a study with a case that fails
"""


@pytest.fixture
def measure(tmp_path, monkeypatch):
    """Measures a study; rows by their names, and what was said."""
    program = tmp_path / "bin/snakemake"
    program.parent.mkdir()
    program.write_text(SNAKEMAKE.format(python=sys.executable))
    program.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(program.with_name("python")))

    def measured(name):
        study, table, said = tmp_path / name, tmp_path / "times.csv", []
        times.make(study, 2, 4, {"known": 1.5}, table, ["a machine", "a day"], said.append)
        lines = table.read_text().splitlines()
        assert lines[:2] == ["# a machine", "# a day"]
        return {row["what"]: row for row in csv.DictReader(lines[2:])}, said

    return measured


@pytest.mark.parametrize("name", ["some.yaml", "other.yaml"])
def test_parts_of_a_run_are_the_whole_of_it(measure, name):
    rows, said = measure(name)
    spent = {what: float(row["processor_s"]) for what, row in rows.items()}
    whole = spent["the study from scratch"]
    assert spent["  FreeFEM"] == 0.002
    assert spent["  Python and meshes of the solves"] == 0.001
    assert spent["  dataset"] == 0.003
    assert spent["  figures"] == 0.001
    assert spent["  Snakemake and the rest"] == pytest.approx(whole - 0.007, abs=1e-3)
    assert spent["times FreeFEM [1]"] == pytest.approx(whole / 0.002, rel=0.01)
    assert 0 < 4 * spent["4 curves by the membrane, each"] < 2 * whole
    assert spent["known"] == 1.5
    walls = [what for what, row in rows.items() if row["wall_s"]]
    nothing = "the study with nothing to do"
    assert walls == ["the study from scratch", nothing, "4 curves by the membrane, each"]
    assert all(any(what in line for line in said) for what in rows)


def test_a_run_that_fails_is_refused(measure):
    with pytest.raises(StudyError, match=r"failing.yaml: the run failed\nthis was wrong"):
        measure("failing.yaml")


def test_the_sweep_has_as_many_muscles_as_asked(tmp_path):
    from workflow.plan.plan import read

    study = tmp_path / "many.yaml"
    study.write_text(times.SWEEP.format(last=200.3))
    assert len(read(study).cases) == 4
    assert {len(each.case.path.stops) for each in read(study).cases.values()} == {21}
