"""What Snakemake runs: once each, again only for a reason, and everything that can be run.

A small copy of the project with its own study and two figures of a few points.
"""

import fcntl
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PARTS = ("Snakefile", "config", "geometry", "profiles", "solver", "workflow")
STUDY = """\
materials:
  nbr: {c10: 0.345083, c01: 0.083805}
  silicone: {c10: 0.028, c01: 0.018}
muscles:
  one:
    inner_diameter: 20
    wall_thickness: 2
    length: 60
    layer_depths: [0.3, 0.9]
    threads: 60
    lead: 144
    thread_stiffness: 315
    material: nbr
  soft: {base: one, material: silicone}
numerics:
  section: {cap_step: 2, growth: 2}
limits: {wall_time: 60, memory: 2000}
scenes:
  fig90:
    path: isobaric
    muscles: [one, soft]
    pressure: [0.2]
    contraction: [0, 0.05]
    models: [geometric, cylinder]
  fig91:
    path: isobaric
    muscles: [one]
    pressure: [0.2]
    contraction: [0, 0.05]
    models: [membrane, solid]
"""
FIGURE = '''\
"""Some points."""
import pandas as pd
from matplotlib.figure import Figure


def table(data):
    return pd.DataFrame([(model, held) for _, model, _, held, _, _ in data.solutions])


def draw(table):
    return Figure()
'''
FIG90 = {"Solving one geometric isobaric 0.2 MPa (and 1 more)"} | {
    f"Solving {muscle} cylinder isobaric 0.2 MPa" for muscle in ("one", "soft")
}
MEMBRANE = {"Solving one membrane isobaric 0.2 MPa"}
SOLID = {"Solving one solid isobaric 0.2 MPa"}
GATHER = {"Gathering the records of all cases"}
CHECK = "Checking that no case failed"  # at the end of every run
DRAW90, DRAW91 = {"Drawing fig90"}, {"Drawing fig91"}
AFTER = GATHER | DRAW90 | DRAW91
MESHED = MEMBRANE | SOLID


class Project:
    """A copy of the project."""

    def __init__(self, folder):
        self.folder = folder
        folder.mkdir(parents=True)
        for part in PARTS:
            ignored = shutil.ignore_patterns("fig[0-9]*", "__pycache__")
            source = ROOT / part
            if source.is_dir():
                shutil.copytree(source, folder / part, ignore=ignored)
            else:
                shutil.copy(source, folder / part)
        for name in ("fig90", "fig91"):
            self.write(f"workflow/figures/{name}.py", FIGURE)
        self.write("config/config.yaml", STUDY)

    def write(self, path, text):
        (self.folder / path).write_text(text)

    def read(self, path):
        return (self.folder / path).read_text()

    def start(self, *arguments, program=("snakemake", "--cores", "2")):
        return subprocess.Popen(
            [sys.executable, "-m", *program, *arguments],
            cwd=self.folder,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )

    def run(self, *arguments, **options):
        """Exit status and output."""
        process = self.start(*arguments, **options)
        output, _ = process.communicate(timeout=300)
        return process.returncode, output

    def planned(self):
        """What would run, by the messages of the jobs; meshes without their digest."""
        status, output = self.run("--dry-run")
        assert status == 0, output
        jobs = re.findall(r"^Job \d+: (.*)$", output, re.MULTILINE)
        assert jobs or "Nothing to be done" in output, output
        return {
            re.sub(r"^Meshing \w+", "Meshing", job) for job in jobs if not job.startswith("All is")
        }


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    """A project in which everything has run."""
    made = Project(tmp_path_factory.mktemp("project") / "a folder with 'quotes'")
    status, output = made.run()
    assert status == 0, output
    made.said = output
    return made


@pytest.fixture
def edited(project):
    """Edits files and puts them back."""
    kept = {}

    def edit(path, change):
        kept.setdefault(path, project.read(path))
        text = change(project.read(path))
        assert text != project.read(path)
        project.write(path, text)

    yield edit
    for path, text in kept.items():
        project.write(path, text)


def test_everything_is_there_and_nothing_runs_again(project):
    results = project.folder / "results"
    for name in ("fig90", "fig91"):
        assert {p.suffix for p in results.glob(f"figures/{name}.*")} == {".png", ".svg", ".csv"}
    assert (results / "dataset.nc").exists()
    assert len((results / "tables/failures.csv").read_text().splitlines()) == 1
    assert len(list(results.glob("cases/*.h5"))) == 5
    assert project.planned() == set()


def test_the_run_said_how_it_went(project):
    assert "5 of 5 cases solved, 0 failed" in project.said
    assert "5 of 5 cases solved" in project.read("results/logs/progress.log")
    own = next((project.folder / ".snakemake/log").iterdir()).read_text()
    for chatter in ("Solving one solid isobaric 0.2 MPa", "Finished jobid"):
        assert chatter in own  # in Snakemake's log
    assert "Finished jobid" not in project.said


def test_nothing_runs_after_what_means_nothing(project, edited):
    for source in ("geometry", "solver", "workflow", "config"):
        for path in (project.folder / source).rglob("*.*"):
            path.touch()
    edited(
        "config/config.yaml",
        lambda text: (
            "# a comment\n"
            + text.replace("inner_diameter: 20\n", "inner_diameter: 20.0\n")
            .replace("    length: 60\n", "")
            .replace("    lead: 144\n", "    lead: 1.44e+2\n    length: 60\n")
            .replace("[0, 0.05]", "[0.050, 0.0]", 1)
            .replace("[one, soft]", "[soft, one]")
            .replace("wall_time: 60", "wall_time: 90")
        ),
    )
    assert project.planned() == set()


STUDY_CHANGES = [
    ("c10: 0.028", "c10: 0.03", {"Solving soft cylinder isobaric 0.2 MPa"} | GATHER | DRAW90),
    ("growth: 2}", "growth: 1.9}", {"Meshing.msh"} | SOLID | GATHER | DRAW91),
    ("models: [membrane, solid]", "models: [membrane]", GATHER | DRAW91),
    ("soft", "weak", GATHER | DRAW90),
]


@pytest.mark.parametrize(("old", "new", "expected"), STUDY_CHANGES)
def test_a_changed_study_runs_what_contains_the_change(project, edited, old, new, expected):
    edited("config/config.yaml", lambda text: text.replace(old, new))
    assert project.planned() == {*expected, CHECK}


def test_swapped_values_are_noticed(project, edited):
    """Names that change places leave all cases as they were, but not what is gathered and drawn."""
    edited(
        "config/config.yaml",
        lambda text: (
            text.replace("  one:", "  x:")
            .replace("  soft: {base: one", "  one: {base: x")
            .replace("[one, soft]", "[one, x]")
            .replace("[one]", "[x]")
            .replace("x", "soft")
        ),
    )
    assert project.planned() == {*AFTER, CHECK}


MESHES = {"Meshing.mesh", "Meshing.msh"}
EDITS = {
    # source: what runs again when it is edited
    "geometry/muscle.py": MESHES | FIG90 | MESHED | AFTER,
    "geometry/grading.py": MESHES | MESHED | GATHER | DRAW91,
    "geometry/section.py": {"Meshing.msh"} | SOLID | GATHER | DRAW91,
    "geometry/meridian.py": {"Meshing.mesh"} | MEMBRANE | GATHER | DRAW91,
    "geometry/whole.py": set(),
    "solver/case.py": FIG90 | MESHED | AFTER,
    "solver/geometric.py": {job for job in FIG90 if "geometric" in job} | GATHER | DRAW90,
    "solver/cylinder.py": {job for job in FIG90 if "cylinder" in job} | GATHER | DRAW90,
    "solver/edp/membrane.edp": MEMBRANE | GATHER | DRAW91,
    "solver/edp/solid.edp": SOLID | GATHER | DRAW91,
    "solver/edp/ends_clamp.idp": SOLID | GATHER | DRAW91,
    "solver/edp/newton.idp": MESHED | GATHER | DRAW91,
    "workflow/figures/fig90.py": DRAW90,
    "workflow/figures/style.py": DRAW90 | DRAW91,
    "workflow/dataset.py": AFTER,
    "config/reference/festo_musclesim_dmsp20.csv": AFTER,
}


@pytest.mark.parametrize("source", EDITS)
def test_an_edited_source_runs_what_reads_it(project, edited, source):
    comment = {".py": "# edited\n", ".csv": "0.62,0.28,0,0\n"}
    edited(source, lambda text: text + comment.get(Path(source).suffix, "// edited\n"))
    assert project.planned() - {CHECK} == EDITS[source]


def test_a_deleted_record_is_solved_again(project):
    record = next((project.folder / "results/cases").glob("*.h5"))
    kept = record.rename(record.with_suffix(".kept"))
    planned = project.planned()
    kept.rename(record)
    assert sum(job.startswith("Solving") for job in planned) == 1


def test_a_wrong_study_stops_with_its_message(project, edited):
    edited("config/config.yaml", lambda text: text.replace("length: 60", "lenght: 60"))
    status, output = project.run("--dry-run")
    assert status == 1
    assert "config/config.yaml:8: muscles.one.lenght is no key here" in output
    assert "Traceback" not in output


def test_one_run_at_a_time(project, edited):
    edited("workflow/figures/fig90.py", lambda text: text + "# edited\n")
    with (project.folder / ".snakemake/run.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        lock.write("4711\n")
        lock.flush()
        status, output = project.run()
        assert status == 1
        assert "Another run works in this folder (process 4711)" in output
        assert "Traceback" not in output
        assert project.planned() == {*DRAW90, CHECK}  # a look is allowed
    status, output = project.run()  # the file is still there, its owner gone
    assert status == 0, output


def test_a_failed_case_stops_nothing_else(tmp_path):
    project = Project(tmp_path / "project")
    hopeless = "variants:\n  hopeless: {numerics: {newton: {iterations: 1}}}\n"
    text = STUDY.replace("numerics:", hopeless + "numerics:", 1)
    project.write("config/config.yaml", text + "    variants: [default, hopeless]\n")
    status, output = project.run()
    results = project.folder / "results"
    assert status == 1
    assert "one membrane hopeless isobaric 0.2 MPa: stalled" in output
    assert (results / "dataset.nc").exists()
    assert (results / "figures/fig91.png").exists()
    assert not (results / "complete.txt").exists()
    rows = (results / "tables/failures.csv").read_text().splitlines()
    assert len(rows) == 3
    assert project.planned() == {CHECK}  # failed cases are not tried again
    status, output = project.run("retry", program=("workflow",))
    assert (status, len(output.splitlines())) == (0, 2)
    solved = {job for job in project.planned() if job.startswith("Solving")}
    assert solved == {f"Solving one {m} hopeless isobaric 0.2 MPa" for m in ("membrane", "solid")}


def test_a_mesh_that_cannot_be_made_is_a_failed_case(tmp_path):
    project = Project(tmp_path / "project")
    program = project.read("geometry/__main__.py")
    broken = program.replace("section.write(", "raise MemoryError(", 1)
    assert broken != program
    project.write("geometry/__main__.py", broken)
    status, output = project.run()
    assert status == 1
    assert "one solid isobaric 0.2 MPa: mesh_failed" in output
    assert (project.folder / "results/dataset.nc").exists()
    project.write("geometry/__main__.py", program)
    project.run("retry", program=("workflow",))
    assert project.planned() == {*MESHES, *MESHED, *GATHER, *DRAW91, CHECK}


def test_a_killed_run_is_finished_by_the_next(project, tmp_path):
    killed = Project(tmp_path / "project")
    process = killed.start()
    cases = killed.folder / "results/cases"
    while not list(cases.glob("*.h5")):
        assert process.poll() is None
        time.sleep(0.02)
    os.killpg(process.pid, signal.SIGKILL)
    process.communicate()
    status, output = killed.run()
    assert status == 0, output
    for path in ("dataset.nc", "figures/fig90.csv", "figures/fig91.svg", "tables/failures.csv"):
        undisturbed = (project.folder / "results" / path).read_bytes()
        assert (killed.folder / "results" / path).read_bytes() == undisturbed
