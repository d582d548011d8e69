"""Files of this project that a program depends on: all that it imports, and the data of that.

A job runs again when one of its sources changes, so the list must be neither too short (a stale
result) nor too long (work for nothing). It follows the import statements, those inside functions
too, and what a module says of itself::

    DATA = ("workflow/plan/mesh_error.csv",)   files that it reads, as patterns from the checkout

What is found by name at run time (the figure of a scene, an analysis, a model) no import statement
names: whoever asks names that module as well; ``of_mesh`` and ``of_solve`` do.
"""

import ast
import hashlib
import json
import os
import tomllib
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

from geometry.files import RESULTS, atomic_write
from solver.models import MODELS
from solver.rubber import LAWS, default

ROOT = Path(__file__).parents[1]
PACKAGES = ("geometry", "solver", "workflow")
MEMORY = RESULTS / "sources" / "closures.txt"
DECLARATION = "DATA"  # name of the constant


_found: dict[str, list[str]] = {}  # by this process


def sources(*modules: str) -> list[str]:
    """Files that these modules are made of, themselves among them; from the checkout, sorted.

    Raises
    ------
    ModuleNotFoundError
        If there is no such module, or a module imports one of this project that is not there.
    FileNotFoundError
        If a module declares data of which there is none.
    """
    asked = " ".join(sorted(modules))
    if asked not in _remembered():
        found: set[str] = set()
        for module in closure(modules):
            found.add(_file(module).relative_to(ROOT).as_posix())
            found.update(_data(module))
        _found[asked] = sorted(found)
        return sorted(found)
    return _remembered()[asked]


def remember() -> None:
    """Keep what was found, until a file of the checkout changes: parsing takes half a second."""
    if _found:
        text = json.dumps(_remembered() | _found, sort_keys=True)
        with atomic_write(MEMORY, sealed=False) as beside:
            beside.write_text(f"{_stamp(text)}\n{text}")


@cache
def _remembered() -> dict[str, list[str]]:
    """What was found by another process with the same files."""
    try:
        stamp, _, text = MEMORY.read_text().partition("\n")
    except (OSError, ValueError):
        return {}
    return dict(json.loads(text)) if stamp == _stamp(text) else {}


def _stamp(text: str) -> str:
    """Digest of a text, of the names of all files, and of all Python there is."""
    found = hashlib.sha256(text.encode())
    for folder in (*PACKAGES, "config"):
        for place, _, names in sorted(os.walk(ROOT / folder)):
            for name in sorted(names):
                path = os.path.join(place, name)
                if name.endswith(".pyc"):
                    continue
                found.update(f"\n{os.path.relpath(path, ROOT)}\n".encode())
                if name.endswith(".py"):
                    found.update(Path(path).read_bytes())
    return found.hexdigest()


@cache
def of_mesh(kind: str) -> tuple[str, ...]:
    """Files that make a kind of mesh, or the whole muscle."""
    return tuple(sources("geometry.__main__", f"geometry.{kind}"))


@cache
def of_solve(model: str, law: str = "") -> tuple[str, ...]:
    """Files that decide the result of a case by a model with a rubber, its mesh's among them.

    ``law`` is the rubber's; without, the one that materials need not name.
    """
    own, law = MODELS[model], law or default().law()
    own_modules = f"solver.models.{model}.model", f"solver.rubber.{law}.law"
    files = set(sources("solver.__main__", *own_modules))
    files.difference_update(f"solver/rubber/{name}/law.py" for name in LAWS if name != law)
    if own.mesh is not None:
        files.update(of_mesh(own.mesh))
    if own.solve is None:
        folders = (*own.includes, *LAWS[law].includes())
        programs = (p for folder in folders for p in folder.glob("*.[ei]dp"))
        files.update(path.relative_to(ROOT).as_posix() for path in programs)
    return tuple(sorted(files))


@cache
def digest(files: tuple[str, ...]) -> str:
    """Digest of names and contents of files of the checkout."""
    text = "".join(f"{file}\n{_text(ROOT / file)}" for file in files)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


@cache
def _text(path: Path) -> str:
    """What stands in a file; programs share most of theirs."""
    return path.read_text()


@cache
def version() -> str:
    """Version of the software, that of pyproject.toml.

    It stands in what is made and decides nothing: another version with the same sources makes the
    same results, so it is no part of a digest.
    """
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return str(project["version"])


def closure(modules: Iterable[str]) -> set[str]:
    """These modules and all of this project that they import, directly or not."""
    found: set[str] = set()
    ahead = list(modules)
    while ahead:
        module = ahead.pop()
        if module not in found:
            found.add(module)
            ahead += _imported(module)
    return found


@cache
def _imported(module: str) -> tuple[str, ...]:
    """Modules of this project that a module imports, and the packages that it lies in."""
    package = module.rpartition(".")[0]
    names = set(_names(module)) | ({package} if package and _is_module(package) else set())
    return tuple(sorted(names))


def _names(module: str) -> Iterator[str]:
    for node in _statements(_tree(module)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if _is_ours(alias.name))
        elif isinstance(node, ast.ImportFrom):
            if node.level:
                raise ImportError(f"{module}: imports are written from the checkout, not with dots")
            if node.module and _is_ours(node.module):
                yield node.module
                inner = (f"{node.module}.{alias.name}" for alias in node.names)
                yield from filter(_is_module, inner)


def _statements(node: ast.AST) -> Iterator[ast.stmt]:
    """All statements in a module or statement, but those that only a type checker reads."""
    parts = ["body", "orelse", "handlers", "finalbody", "cases"]
    if isinstance(node, ast.If) and getattr(node.test, "id", "") == "TYPE_CHECKING":
        parts.remove("body")
    for part in parts:
        for inner in getattr(node, part, ()):
            if isinstance(inner, ast.stmt):
                yield inner
            yield from _statements(inner)


def _data(module: str) -> set[str]:
    """Files that a module declares."""
    patterns: tuple[str, ...] = ()
    for node in _tree(module).body:
        if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == DECLARATION:
            patterns = ast.literal_eval(node.value)
    found: set[str] = set()
    for pattern in patterns:
        files = {p.relative_to(ROOT).as_posix() for p in ROOT.glob(pattern) if p.is_file()}
        if not files:
            raise FileNotFoundError(f"{module} declares {pattern}, and there is no such file")
        found |= files
    return found


@cache
def _tree(module: str) -> ast.Module:
    return ast.parse(_file(module).read_bytes())


def _is_ours(name: str) -> bool:
    return name.partition(".")[0] in PACKAGES


def _is_module(name: str) -> bool:
    try:
        _file(name)
    except ModuleNotFoundError:
        return False
    return True


@cache
def _file(module: str) -> Path:
    """The file of a module, or that of a package."""
    path = ROOT.joinpath(*module.split("."))
    for file in (path.with_suffix(".py"), path / "__init__.py"):
        if file.is_file():
            return file
    raise ModuleNotFoundError(f"{module}: no such module in this project", name=module)
