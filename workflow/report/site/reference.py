"""Pages of reference, made of the code: keys of a study, commands, files."""

import argparse
import inspect
import os
import re
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

from solver import record, status
from solver.sources import ROOT
from workflow.analyses.registry import ANALYSES
from workflow.data import dataset, labelled, states, tidy
from workflow.study.schema import StudyFile

PROGRAMS = ROOT / "workflow/programs"
WIDTH = "96"  # of the help, in columns


def table(head: Iterable[str], rows: Iterable[Iterable[object]]) -> str:
    """A table in Markdown."""
    names = list(head)
    lines = [names, ["---"] * len(names), *([str(cell) for cell in row] for row in rows)]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines) + "\n"


def code(text: str) -> str:
    """Text as it stands."""
    return f"```text\n{text.strip()}\n```\n"


def keys() -> str:
    """Every key that a study file may have: what may stand there, and what stands there if not."""
    found = StudyFile.model_json_schema()
    parts = ["## The file\n", _entry(found)]
    for name, entry in sorted(found["$defs"].items(), key=lambda item: _called(item[0])):
        parts += [f"## {_called(name)}\n", _entry(entry)]
    return "\n".join(parts)


def _entry(entry: Mapping[str, Any]) -> str:
    required = entry.get("required", ())
    rows = (
        (f"`{key}`", _allowed(value), "must be given" if key in required else _default(value))
        for key, value in entry["properties"].items()
    )
    return table(("key", "what may stand there", "if left out"), rows)


def _called(name: str) -> str:
    """Name of an entry as a heading: what it is an entry of."""
    plain = name.removesuffix("Entry").removesuffix("_entry")
    if plain.startswith("Material_"):
        return f"Material, {plain.removeprefix('Material_')}"
    return {"Free": "Free of a design", "Bounds": "Bounds of a calibration"}.get(
        plain, plain.capitalize()
    )


def _allowed(value: Mapping[str, Any]) -> str:
    """What may stand at a key, from its JSON schema."""
    if "$ref" in value:
        called = _called(value["$ref"].rpartition("/")[2])
        return f"[{called}](#{re.sub('[^a-z0-9_ -]', '', called.lower()).replace(' ', '-')})"
    if "enum" in value:
        return ", ".join(f"`{word}`" for word in value["enum"])
    if "const" in value:
        return f"`{value['const']}`"
    options = value.get("anyOf") or value.get("oneOf")
    if options:
        texts = (_allowed(each) for each in options if each.get("type") != "null")
        return "; or ".join(dict.fromkeys(texts))
    kind = value.get("type")
    if kind == "array":
        if "prefixItems" in value:
            return f"a list of {len(value['prefixItems'])} numbers"
        return f"a list of: {_allowed(value.get('items', {}))}"
    if kind == "object":
        inner = value.get("additionalProperties")
        return f"by name: {_allowed(inner)}" if isinstance(inner, Mapping) else "a mapping"
    limits = {"exclusiveMinimum": ">", "minimum": ">=", "exclusiveMaximum": "<", "maximum": "<="}
    limits |= {"gt": ">", "ge": ">=", "lt": "<", "le": "<="}
    bounds = [f"{sign} {value[name]}" for name, sign in limits.items() if name in value]
    words = {"number": "number", "integer": "integer", "string": "text", "boolean": "true, false"}
    return ", ".join([words.get(str(kind), "any"), *bounds])


def _default(value: Mapping[str, Any]) -> str:
    found = value.get("default")
    if found is None or found in ({}, [], ""):
        return ""
    if isinstance(found, Mapping):
        return "as its keys say"
    return f"`{found}`"


def commands() -> str:
    """Every program of ``muscle`` as it says it itself; found by its file, as a program is."""
    parts = []
    for file in sorted(PROGRAMS.glob("*.py")):
        program = import_module(f"workflow.programs.{file.stem}")
        if not hasattr(program, "run"):
            continue
        name = file.stem.replace("_", "-")
        parser = argparse.ArgumentParser(prog=f"muscle {name}", description=program.__doc__)
        program.add_arguments(parser)
        parts += [f"## {name}\n", code(_help(parser))]
    return "\n".join(parts)


def _help(parser: argparse.ArgumentParser) -> str:
    """The help, as wide as on every machine."""
    before = os.environ.get("COLUMNS")
    os.environ["COLUMNS"] = WIDTH
    try:
        return parser.format_help()
    finally:
        os.environ.pop("COLUMNS")
        if before is not None:
            os.environ["COLUMNS"] = before


def targets() -> str:
    """Targets of Snakemake that are analyses."""
    rows = (
        (
            f"`{each.target or each.name}`",
            each.title,
            ", ".join(f"`{table}.csv`" for table in each.tables),
            ", ".join(f"`{picture}`" for picture in each.figures),
        )
        for each in ANALYSES.values()
    )
    return table(("target", "what it is", "in results/tables", "in results/figures"), rows)


def record_layout() -> str:
    """What a record holds."""
    numbers = record.VARIABLES | record.IN_TIME
    rows = ((f"`{name}`", unit, text) for name, (unit, text) in numbers.items())
    return code(inspect.getdoc(record) or "") + "\n" + table(("state", "unit", "what"), rows)


def dataset_layout() -> str:
    """What the dataset and the table in Parquet hold."""
    parts = [code(inspect.getdoc(dataset) or "")]
    for title, columns in {
        "Of a state": states.OF_STATE,
        "Of a curve": states.OF_CURVE,
        "Of a muscle": states.OF_MUSCLE,
    }.items():
        rows = ((f"`{name}`", unit, text) for name, (unit, text) in columns.items())
        parts += [f"### {title}\n", table(("column", "unit", "what"), rows)]
    parts += ["### Groups by path\n", code(inspect.getdoc(labelled) or "")]
    parts += ["### Parquet\n", code(inspect.getdoc(tidy) or "")]
    return "\n".join(parts)


def statuses() -> str:
    """What a case, a state and a flag can be, with the comments of solver/status.py."""
    said = dict(re.findall(r'^    \w+ = "(\w+)"  # (.+)$', inspect.getsource(status), re.M))
    titles = {
        status.CaseStatus: "Of a case",
        status.StateStatus: "Of a state",
        status.Flag: "Flags of a state",
    }
    return "\n".join(
        f"### {title}\n\n"
        + table(("word", "what it means"), ((f"`{word}`", said.get(word, "")) for word in kind))
        for kind, title in titles.items()
    )


PAGES_OF_FILES = {  # that are read on the way to the repository; where they stand on the site
    "config/README.md": "reference/study.md",
    "CONTRIBUTING.md": "contributing.md",
    "CHANGELOG.md": "changelog.md",
}


def page(file: str) -> str:
    """A file of the repository as a page."""
    text = (ROOT / file).read_text(encoding="utf-8")
    return with_links(text, (ROOT / file).parent, (ROOT / "docs" / PAGES_OF_FILES[file]).parent)


def with_links(text: str, folder: Path, here: Path) -> str:
    """A text that stands in a folder, its links turned into those of a page of the site."""

    def turned(match: re.Match[str]) -> str:
        target, mark, part = match[1].partition("#")
        if not target or re.match(r"[a-z]+:", target):
            return match[0]
        found = os.path.relpath(folder / target, ROOT)
        on_site = ROOT / "docs" / PAGES_OF_FILES[found] if found in PAGES_OF_FILES else ROOT / found
        return f"]({os.path.relpath(on_site, here)}{mark}{part})"

    return re.sub(r"\]\(([^()\s]+)\)", turned, text)


PARTS: Mapping[str, Callable[[], str]] = {
    "keys": keys,
    "commands": commands,
    "targets": targets,
    "record": record_layout,
    "dataset": dataset_layout,
    "statuses": statuses,
    **{file: partial(page, file) for file in PAGES_OF_FILES},
}
