"""A model is one folder: added to a copy of the tree, solved with, gathered, and removed again."""

import json
import re
import shutil
import subprocess
import sys

import pytest

from solver.models import MODELS

from .project import TRACE, Project

DUMMY = '''\
"""A piston of the mean braid diameter: for tests."""

from solver.case import Case
from solver.models.model import Model
from solver.record import Solution


def flags(_case: Case) -> dict[str, str | float]:
    return {}


def solve(case: Case) -> Solution:
    from solver.models.dummy.piston import curve

    return curve(case)


MODEL = Model(
    name="dummy",
    rank=6,
    label="piston",
    switches=("threads",),
    effects=("slackening",),
    quantities=("force", "contraction"),
    solve=solve,
)
'''
PISTON = """\
import numpy as np

from solver.case import Case
from solver.record import Solution, unreached
from solver.status import CaseStatus, StateStatus


def curve(case: Case) -> Solution:
    states = unreached(case.path.states)
    states["contraction"] = np.array(case.path.stops)
    states["pressure"] = np.full(len(case.path.stops), case.path.held)
    area = np.pi * case.muscle.inner_radius**2
    states["force"] = case.path.held * area * (1 - states["contraction"])
    status = [StateStatus.CONVERGED] * case.path.states
    return Solution(status=CaseStatus.CONVERGED, reason="", states=states, state_status=status)
"""
SCENE = """\
  fig90:
    path: isobaric
    muscles: [one]
    pressure: [0.2]
    contraction: [0, 0.05]
    models: [geometric, dummy]
"""
TRACER = (
    TRACE
    + """\
root = pathlib.Path.cwd()
from solver.__main__ import main
status = main(sys.argv[1:])
files = opened | {m.__file__ for m in list(sys.modules.values()) if getattr(m, "__file__", None)}
inside = {p.resolve() for p in map(pathlib.Path, files) if p.resolve().is_relative_to(root)}
print(json.dumps([status, sorted(str(p.relative_to(root)) for p in inside)]))
"""
)
TELL = """\
import json
from solver.models import MODELS
from solver.record import code_digest
from solver.sources import of_solve
print(json.dumps({name: [code_digest(name), of_solve(name)] for name in MODELS}))
"""
OURS = ("geometry/", "solver/")


@pytest.fixture(scope="module")
def tree(tmp_path_factory):
    """A copy of the tree; nothing has run there."""
    made = Project(tmp_path_factory.mktemp("project") / "tree")
    made.folder = made.folder.resolve()
    return made


@pytest.fixture
def with_dummy(tree):
    folder = tree.folder / "solver/models/dummy"
    folder.mkdir()
    study = tree.read("config/config.yaml")
    (folder / "__init__.py").touch()
    (folder / "model.py").write_text(DUMMY)
    (folder / "piston.py").write_text(PISTON)
    head = study[: study.index("  fig90:")]
    tree.write("config/config.yaml", head + SCENE)
    yield tree
    tree.write("config/config.yaml", study)
    shutil.rmtree(folder)


def python(tree, *arguments):
    """Exit status and output of Python in the tree."""
    done = subprocess.run(
        [sys.executable, *arguments],
        cwd=tree.folder,
        capture_output=True,
        text=True,
        timeout=300,
    )
    return done.returncode, done.stdout + done.stderr


def told(tree):
    """Digest and sources of every model."""
    status, said = python(tree, "-c", TELL)
    assert status == 0, said
    return json.loads(said)


def test_a_model_is_added_and_removed_by_one_folder(with_dummy):
    tree = with_dummy
    status, said = tree.run("results/figures/fig90.png", "results/dataset.nc")
    assert status == 0, said
    assert "Solving one dummy isobaric 0.2 MPa" in said or "cases solved" in said
    status, said = python(tree, "-m", "workflow", "cases")
    assert status == 0
    assert re.search(r"converged +one dummy isobaric 0.2 MPa", said)
    status, said = python(tree, "-m", "workflow", "explain")
    assert status == 0
    assert re.search("> dummy +not weighed", said)
    status, said = python(
        tree,
        "-c",
        "import xarray as xr\n"
        "data = xr.open_datatree('results/dataset.nc')['isobaric'].to_dataset()\n"
        "print(*data.model.values)\n"
        "print(float(data.force.sel(model='dummy', contraction=0.05).squeeze()))",
    )
    assert status == 0, said
    models, force = said.split("\n")[:2]
    assert models == "geometric dummy"
    assert float(force) == pytest.approx(0.2 * 3.141592653589793 * 100 * 0.95)
    shutil.rmtree(tree.folder / "solver/models/dummy")
    status, said = python(tree, "-m", "workflow", "cases")
    assert status != 0
    assert "dummy" in said
    assert "Traceback" not in said
    (tree.folder / "solver/models/dummy").mkdir()


def test_another_model_changes_no_digest(tree):
    before = told(tree)
    folder = tree.folder / "solver/models/dummy"
    folder.mkdir()
    (folder / "__init__.py").touch()
    (folder / "model.py").write_text(DUMMY)
    (folder / "piston.py").write_text(PISTON)
    with_it = told(tree)
    shutil.rmtree(folder)
    assert list(with_it) == [*before, "dummy"]
    assert {name: with_it[name] for name in before} == before
    assert "solver/models/dummy/piston.py" in with_it["dummy"][1]


@pytest.mark.parametrize(
    ("edited", "changes"),
    [
        ("solver/models/cell/cell_wall.idp", {"cell"}),
        ("solver/models/cell/model.py", {"cell"}),
        ("geometry/cell.py", {"cell"}),
        ("geometry/section.py", {"solid"}),
        ("geometry/whole.py", set()),
        ("solver/models/cylinder/curve.py", {"cylinder"}),
        ("solver/net.py", {"geometric", "geometric_layers"}),
        ("solver/path/walk.idp", {"membrane", "solid", "cell"}),
        ("solver/check.edp", set()),
        ("solver/case.py", set(MODELS)),
    ],
)
def test_a_digest_is_that_of_the_sources_of_its_own_model(tree, edited, changes):
    before = told(tree)
    text = tree.read(edited)
    tree.write(edited, text + ("# edited\n" if edited.endswith(".py") else "// edited\n"))
    after = told(tree)
    tree.write(edited, text)
    assert {name for name in before if before[name] != after[name]} == changes


@pytest.mark.parametrize("model", MODELS)
def test_a_solve_opens_nothing_else(tree, make_case, mesh_of, tmp_path, model):
    """Python's files by a tracer; FreeFEM's are the includes of the folders that it is given."""
    case = make_case(model=model)
    mesh = mesh_of(case)
    files = {name: str(tmp_path / name) for name in ("record", "cost", "log")}
    given = [f"--{name}={file}" for name, file in files.items()]
    given += ["--mesh", str(mesh)] if mesh else []
    status, said = python(tree, "-c", TRACER, "--case", case.canonical(), *given)
    assert status == 0, said
    status, opened = json.loads(said.splitlines()[-1])
    read = {name for name in opened if name.startswith(OURS) and "__pycache__" not in name}
    assert status == 0
    # the default law is looked for among all: those before it by name are asked whether they are it
    read -= {name for name in read if re.fullmatch(r"solver/rubber/\w+/law\.py", name)}
    assert read <= set(told(tree)[model][1])
    others = {name for name in MODELS if name != model}
    assert not {name for name in read if others & set(name.split("/"))}


ASK_FOR_SOME = (
    "solver/models/",
    "workflow/analyses/",
    "workflow/answers/",
    "workflow/programs/fit_memory.py",
    "workflow/programs/sheet.py",
)


def test_no_other_file_names_a_model(tree):
    """But analyses and answers, which ask for some, and the kind of mesh called cell."""
    names = "|".join(name for name in MODELS if name != "cell")
    quoted = re.compile(rf"""["']({names})["']""")
    found = []
    for path in [*tree.folder.rglob("*.py"), *tree.folder.rglob("*.smk")]:
        place = path.relative_to(tree.folder).as_posix()
        if place.startswith(ASK_FOR_SOME):
            continue
        lines = enumerate(path.read_text().splitlines(), 1)
        found += [f"{place}:{number}" for number, line in lines if quoted.search(line)]
    assert [place for place in found if not place.startswith("workflow/study/schema.py")] == []
    assert len(found) <= 2  # what a calibration and a map use where they name none
