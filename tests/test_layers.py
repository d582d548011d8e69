"""Imports point one way: a room knows its own modules and the rooms below it, never those above."""

import ast
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
LAYERS = (  # rooms of one layer know nothing of each other
    ("geometry",),
    ("solver",),
    ("workflow.study",),
    ("workflow.plan",),
    ("workflow.run", "workflow.data"),
    ("workflow.figures",),
    ("workflow.analyses",),
    ("workflow.answers",),
    ("workflow.report",),
    ("workflow.programs",),
    ("workflow.__main__",),
)
LEVEL = {room: level for level, rooms in enumerate(LAYERS) for room in rooms}
ABOVE = {"matplotlib", "pandas", "snakemake", "xarray"}  # packages for what is made of records
SHUT = {"geometry": ABOVE | {"h5py"}, "solver": ABOVE | {"gmsh", "meshio"}}


def modules() -> dict[str, ast.Module]:
    """Syntax trees of the project by name of the module."""
    found = {}
    for package in ("geometry", "solver", "workflow"):
        for path in (ROOT / package).rglob("*.py"):
            name = ".".join(path.relative_to(ROOT).with_suffix("").parts)
            found[name.removesuffix(".__init__")] = ast.parse(path.read_text(encoding="utf-8"))
    return found


def imports(tree: ast.Module) -> set[str]:
    """All that a module imports, also late or by name: ``a.b.c`` for ``c`` of ``a.b``."""
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and ast.unparse(node.func).endswith("import_module"):
            found |= {a.value for a in node.args if isinstance(a, ast.Constant)}
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert not node.level, "imports name the whole path"
            found |= {f"{node.module}.{alias.name}" for alias in node.names}
    return found


def room_of(name: str) -> str | None:
    """The room of a module; None of one of another package, and of ``workflow`` itself."""
    parts = name.split(".")
    room = ".".join(parts[:2]) if parts[0] == "workflow" else parts[0]
    if parts[0] == "workflow" and len(parts) > 1:
        assert room in LEVEL, f"{name}: its room has no place in LAYERS"
    return room if room in LEVEL else None


MODULES = modules()


@pytest.mark.parametrize("room", LEVEL)
def test_a_room_imports_only_from_below(room):
    inside = {name: tree for name, tree in MODULES.items() if room_of(name) == room}
    assert inside
    upward = [
        f"{name} imports {wanted}"
        for name, tree in inside.items()
        for wanted in imports(tree)
        if (other := room_of(wanted)) and other != room and LEVEL[other] >= LEVEL[room]
    ]
    assert not upward


@pytest.mark.parametrize("room", SHUT)
def test_lower_rooms_know_no_tables_and_no_drawing(room):
    found = [
        f"{name} imports {wanted}"
        for name, tree in MODULES.items()
        if room_of(name) == room
        for wanted in imports(tree)
        if wanted.split(".")[0] in SHUT[room]
    ]
    assert not found


def test_no_circle_of_imports():
    graph = {}
    for name, tree in MODULES.items():
        wanted = imports(tree)
        near = {w if w in MODULES else w.rpartition(".")[0] for w in wanted}
        graph[name] = (near & MODULES.keys()) - {name}
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        pytest.fail(" -> ".join(error.args[1]))
