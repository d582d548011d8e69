"""A figure is one file, an analysis one folder: added, run, taken away, named nowhere else."""

import shutil

import pytest

from .project import FIGURE, PARTS, STUDY, Project

ANALYSIS = {
    "__init__.py": '"""A question that nobody asks."""\n',
    "analysis.py": '''\
"""What it writes."""

from workflow.analyses.analysis import Analysis

ANALYSIS = Analysis(
    name="dummy",
    title="A dummy",
    chapter="6 Dummies",
    muscles=("one",),
    tables={"dummy": None, "dummy_notes": "%.3g"},
    figures=("dummy",),
    page=("dummy_notes",),
    in_dataset=True,
)
''',
    "cases.py": '''\
"""Two cases, of which one has no equilibrium."""

from solver.case import Case
from solver.load_path import LoadPath
from workflow.analyses.analysis import AnalysisCase


def cases(study):
    """A curve by the cylinder, and one that is pulled by far more than it can bear."""
    one = study.muscles["one"]
    paths = {
        "easy": LoadPath(kind="isobaric", held=0.2, stops=(0.0, 0.1)),
        "hard": LoadPath(kind="isotonic", held=-1e7, stops=(0.01, 0.02)),
    }
    return [
        AnalysisCase(
            Case(
                muscle=one.muscle, rubber=one.rubber, thread=one.thread, path=path,
                model="cylinder",
            ),
            f"dummy, {name}",
            {"name": name},
        )
        for name, path in paths.items()
    ]
''',
    "table.py": '''\
"""A row per case."""

import pandas as pd


def tables(study, solved):
    rows = [s.asked.tags | {"status": s.solution.status.value} for s in solved]
    table = pd.DataFrame(rows)
    return {"dummy": table, "dummy_notes": table.head(1)}
''',
    "figures.py": '''\
"""A picture of nothing."""

from matplotlib.figure import Figure


def draw(solved, tables):
    return {"dummy": Figure()}
''',
    "caption.rst": "Nothing is shown.\n",
}
SCENE = """\
  fig92:
    path: isobaric
    muscles: [one]
    pressure: [0.2]
    contraction: [0, 0.05]
    models: [geometric]
"""
TARGETS = ("dummy", "results/report/dummy.html", "results/report/fig92.html", "results/dataset.nc")


@pytest.fixture(scope="module")
def extended(tmp_path_factory):
    """A project with both, in which they have run; nothing but models without a mesh."""
    project = Project(tmp_path_factory.mktemp("extended") / "copy")
    before = files(project)
    scenes = STUDY.partition("  fig91:")[0]
    project.write("config/config.yaml", scenes + SCENE)
    project.write("workflow/figures/fig92.py", FIGURE)
    (project.folder / "workflow/analyses/dummy").mkdir()
    for name, text in ANALYSIS.items():
        project.write(f"workflow/analyses/dummy/{name}", text)
    status, project.said = project.run(*TARGETS)
    assert status == 0, project.said
    return project, before


def files(project):
    """All source files with their texts."""
    found = (
        p for part in PARTS for p in [project.folder / part, *project.folder.glob(f"{part}/**/*")]
    )
    return {
        str(path.relative_to(project.folder)): path.read_bytes()
        for path in found
        if path.is_file() and "__pycache__" not in path.parts
    }


def test_they_run(extended):
    project, _ = extended
    results = project.folder / "results"
    assert (results / "figures/fig92.png").exists()
    assert (results / "figures/dummy.svg").exists()
    assert "Nothing is shown." in project.read("results/report/dummy.html")
    assert "hard" not in project.read("results/tables/dummy_notes.csv")


def test_a_failed_case_of_an_analysis_stands_among_the_failures(extended):
    project, _ = extended
    (row,) = project.read("results/tables/failures.csv").splitlines()[1:]
    assert row.split(",")[1] == '"dummy'
    assert row.endswith(",dummy")
    status, said = project.run("failures", program=("workflow",))
    assert status == 0
    assert "analysis dummy: 1 " in said


def test_their_programs_know_them(extended):
    project, _ = extended
    assert "\n  dummy" in project.run("list", program=("workflow",))[1]
    assert "dummy, easy" in project.run("cases", "--name", "dummy", program=("workflow",))[1]


def test_an_edited_part_runs_the_analysis_again_and_no_other(extended):
    project, _ = extended
    kept = project.read("workflow/analyses/dummy/table.py")
    project.write("workflow/analyses/dummy/table.py", kept + "# edited\n")
    status, output = project.run(*TARGETS, "--dry-run", "--quiet", "host")
    project.write("workflow/analyses/dummy/table.py", kept)
    assert status == 0, output
    assert "Evaluating the analysis dummy" in output
    assert "Gathering" not in output
    assert "Solving" not in output


def test_taken_away_nothing_names_them(extended):
    project, before = extended
    copy = project.copy(project.folder.with_name("without"))
    shutil.rmtree(copy.folder / "workflow/analyses/dummy")
    (copy.folder / "workflow/figures/fig92.py").unlink()
    after = files(copy)
    assert after.keys() == before.keys()
    changed = {name for name in after if after[name] != before[name]}
    assert changed == {"config/config.yaml"}
    assert [n for n, text in after.items() if b"dummy" in text and n not in changed] == []
    code = {name: text for name, text in after.items() if not name.startswith("config/")}
    assert [name for name, text in code.items() if b"fig92" in text] == []
    copy.write("config/config.yaml", STUDY.partition("  fig91:")[0])
    status, output = copy.run("--dry-run")
    assert status == 0, output
    status, output = copy.run("--dry-run", "dummy")
    assert status != 0
