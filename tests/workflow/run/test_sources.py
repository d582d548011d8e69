"""Which files a program depends on, by small packages and by what programs really open."""

import json
import subprocess
import sys

import pytest

from solver import sources as module
from solver.rubber import LAWS
from solver.sources import of_solve, sources

from ..project import TRACE

TRACER = (
    TRACE
    + """\
root = pathlib.Path(sys.argv[1])
from workflow.__main__ import main
status = main(sys.argv[2:])
data = {name for name in opened if not name.endswith(".py")}  # Python is read for its digest too
files = data | {m.__file__ for m in list(sys.modules.values()) if getattr(m, "__file__", None)}
inside = {p.resolve() for p in map(pathlib.Path, files) if p.resolve().is_relative_to(root)}
print(json.dumps([status, sorted(str(p.relative_to(root)) for p in inside)]))
"""
)
OURS = ("geometry/", "solver/", "workflow/", "config/reference/")
DISPATCH = "workflow/__main__.py"  # finds a program by its name and does nothing else


@pytest.fixture
def packages(tmp_path, monkeypatch):
    """A function that writes the modules of a project of its own."""

    def write(**files):
        for name, text in files.items():
            path = tmp_path.joinpath(*name.split("__"))
            path = path.with_suffix(".py") if path.suffix == "" else path
            for folder in [path.parent, *path.parent.parents]:
                if folder == tmp_path:
                    break
                folder.mkdir(parents=True, exist_ok=True)
                (folder / "__init__.py").touch()
            path.write_text(text)
        return tmp_path

    monkeypatch.setattr(module, "ROOT", tmp_path)
    caches = module._imported, module._tree, module._file
    for cached in caches:
        cached.cache_clear()
    yield write
    for cached in caches:
        cached.cache_clear()


def test_imports_are_followed_wherever_they_stand(packages):
    packages(
        workflow__a="import workflow.b\n\n\ndef f():\n    from workflow.deep import c\n",
        workflow__b="try:\n    import solver.d\nexcept ImportError:\n    from solver import e\n",
        workflow__deep__c="import os, numpy\n",
        workflow__unread="import solver.f\n",
        solver__d="",
        solver__e="class A:\n    from solver.f import name\n",
        solver__f="name = 1\n",
    )
    own = {"workflow/a.py", "workflow/b.py", "workflow/deep/c.py"}
    inits = {"solver/__init__.py", "workflow/__init__.py", "workflow/deep/__init__.py"}
    assert set(sources("workflow.a")) == own | inits | {"solver/d.py", "solver/e.py", "solver/f.py"}


def test_what_only_a_type_checker_imports_is_left_out(packages):
    packages(
        workflow__a=(
            "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    import workflow.b\n"
            "else:\n    import workflow.c\n"
        ),
        workflow__b="",
        workflow__c="",
    )
    assert set(sources("workflow.a")) == {"workflow/__init__.py", "workflow/a.py", "workflow/c.py"}


def test_circles_end(packages):
    packages(workflow__a="import workflow.b\n", workflow__b="import workflow.a\n")
    assert set(sources("workflow.a")) == {"workflow/__init__.py", "workflow/a.py", "workflow/b.py"}


def test_declared_data_belongs_to_whoever_imports_it(packages):
    root = packages(
        workflow__a="import workflow.b\n", workflow__b='DATA = ("config/*.csv", "config/one.txt")\n'
    )
    (root / "config").mkdir()
    for name in ("x.csv", "y.csv", "one.txt", "other.txt"):
        (root / "config" / name).touch()
    data = {name for name in sources("workflow.a") if name.startswith("config/")}
    assert data == {"config/x.csv", "config/y.csv", "config/one.txt"}


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("import workflow.missing\n", ModuleNotFoundError),
        ('DATA = ("config/*.csv",)\n', FileNotFoundError),
        ("from . import b\n", ImportError),
    ],
)
def test_what_is_not_there_is_an_error(packages, text, error):
    packages(workflow__a=text)
    with pytest.raises(error):
        sources("workflow.a")


@pytest.mark.parametrize(
    ("modules", "arguments"),
    [
        (
            ["workflow.programs.gather"],
            ["gather"],
        ),
        (
            ["workflow.programs.draw", "workflow.figures.figure", "workflow.figures.fig90"],
            ["draw", "--scene", "fig90"],
        ),
        (["workflow.programs.failures"], ["failures"]),
        (
            ["workflow.programs.page"],
            ["page", "--title", "t", "--caption", "workflow/report/unnamed.rst", "--output", "p"],
        ),
    ],
)
def test_programs_open_nothing_else(project, tmp_path, modules, arguments):
    """Every file of this project that a program opens or imports is one of its sources."""
    project = project.copy(tmp_path / "project")
    for path in (project.folder / "results/figures").iterdir():
        path.unlink()
    given = [str(tmp_path / a) if a == "p" else a for a in arguments]
    done = subprocess.run(
        [sys.executable, "-c", TRACER, str(project.folder.resolve()), *given],
        cwd=project.folder,
        capture_output=True,
        text=True,
        check=True,
    )
    status, opened = json.loads(done.stdout.splitlines()[-1])
    asked = subprocess.run(
        [sys.executable, "-c", f"from solver.sources import *; print(*sources(*{modules}))"],
        cwd=project.folder,
        capture_output=True,
        text=True,
        check=True,
    )
    known = set(asked.stdout.split()) | {DISPATCH}
    read = {name for name in opened if name.startswith(OURS) and "__pycache__" not in name}
    assert status == 0
    assert len(read) > 5
    assert read - {given[4] if "--caption" in given else ""} <= known


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("model", ["cylinder", "solid"])
def test_a_solve_has_the_files_of_its_own_law(model, law):
    rooms = {
        file.split("/")[2] for file in of_solve(model, law) if file.startswith("solver/rubber/")
    }
    assert rooms & set(LAWS) == {law}


@pytest.fixture
def forgotten(packages, monkeypatch, tmp_path):
    """Packages of which nothing is remembered; a function that makes this process another one."""
    monkeypatch.setattr(module, "MEMORY", tmp_path / "results/closures.txt")
    monkeypatch.setattr(module, "_found", {})

    def another():
        for cached in (module._remembered, module._imported, module._tree, module._file):
            cached.cache_clear()

    another()
    yield packages, another
    module._remembered.cache_clear()


def test_what_was_found_is_remembered_until_a_file_changes(forgotten, monkeypatch):
    packages, another = forgotten
    packages(workflow__a="import workflow.b\n", workflow__b="", workflow__c="")
    found = sources("workflow.a")
    module.remember()
    another()
    with monkeypatch.context() as patched:
        patched.setattr(module, "closure", None)  # not asked
        assert sources("workflow.a") == found
    packages(workflow__b="import workflow.c\n")
    another()
    assert sources("workflow.a") == [*found, "workflow/c.py"]
    module.remember()
    text = module.MEMORY.read_text()
    module.MEMORY.write_text(text.replace("workflow/c.py", "workflow/d.py"))
    another()
    assert sources("workflow.a") == [*found, "workflow/c.py"]
