"""Materials and muscles that a study may name without writing them: config/library.

An entry is as in a study file, with what is known of it beside (``ABOUT``). A study takes those
that it names and does not have itself, with what these name in turn.
"""

import csv
from collections.abc import Collection, Iterator
from functools import cache
from pathlib import Path
from typing import Any

from workflow.study import plain_yaml, user_file
from workflow.study.errors import StudyError, printable
from workflow.study.plain_yaml import Node

CHECKOUT = Path(__file__).parents[2]
FOLDER = "config/library"
DATA = ("config/library/*.yaml",)
SECTIONS = ("materials", "muscles")
ABOUT = ("mark", "source", "range", "assumed", "note")  # in this order where they are listed
NAMING = {"base": "muscles", "angle_of": "muscles", "material": "materials"}  # keys of muscles
Entry = tuple[str, str]  # section and name


@cache
def _root(section: str) -> Node:
    root = plain_yaml.read((CHECKOUT / file(section)).read_text())
    found: Node = root.value[section]
    return found


def file(section: str) -> str:
    """Where the entries of a section stand, from the checkout."""
    return f"{FOLDER}/{section}.yaml"


def names(section: str) -> list[str]:
    """Of the entries of a section."""
    return [*_root(section).value] if section in SECTIONS else []


def about(section: str, name: str) -> dict[str, str]:
    """What is known of an entry beside its values."""
    entry = _root(section).value[name].value
    return {key: str(entry[key].value) for key in ABOUT if key in entry}


def values(section: str, name: str) -> dict[str, Any]:
    """What a study file would have of an entry."""
    plain: dict[str, Any] = _entry(section, name).plain()
    return plain


def _entry(section: str, name: str) -> Node:
    whole = _root(section).value[name]
    own = {key: node for key, node in whole.value.items() if key not in ABOUT}
    return Node(own, whole.line, {key: whole.lines[key] for key in own})


def whole() -> Node:
    """All entries, as the mapping of a study without scenes."""
    sections = {}
    for section in SECTIONS:
        known = names(section)
        places = {name: _root(section).lines[name] for name in known}
        sections[section] = Node({name: _entry(section, name) for name in known}, 1, places)
    return Node(sections | {"scenes": Node({}, 1)}, 1, dict.fromkeys((*SECTIONS, "scenes"), 1))


def completed(path: Path, root: Node, also: Collection[str] = ()) -> tuple[Node, set[Entry]]:
    """The mapping of a study file with what it names of the library, and which entries these are.

    ``also`` are names of muscles that are wanted beside.

    Raises
    ------
    StudyError
        If the study has an entry of its own by a name that one from the library needs.
    """
    if not isinstance(root.value, dict):
        return root, set()
    taken: set[Entry] = set()
    ahead = [*_named(root.plain(), path), *(("muscles", name) for name in also)]
    while ahead:
        section, name = entry = ahead.pop()
        if entry in taken or name in _own(root, section) or name not in names(section):
            continue
        taken.add(entry)
        needed = (
            _named({"muscles": {name: values(section, name)}}, path) if section == "muscles" else []
        )
        for of, other in needed:
            if other in _own(root, of):
                line = root.value[of].lines[other]
                raise StudyError(
                    f"{printable(str(path))}:{line}: {of}.{other} is no name here\n  allowed: "
                    f"another name; {name} of {file('muscles')} needs the library's {other}",
                    line,
                )
            ahead.append((of, other))
    if not taken:
        return root, taken
    sections, lines = dict(root.value), dict(root.lines)
    for section in SECTIONS:
        own = root.value.get(section, Node({}, 1))
        found = {name: _entry(section, name) for of, name in sorted(taken) if of == section}
        if found and isinstance(own.value, dict):
            places = {name: _root(section).lines[name] for name in found}
            sections[section] = Node(own.value | found, own.line, own.lines | places)
            lines.setdefault(section, 1)
    return Node(sections, root.line, lines), taken


def _own(root: Node, section: str) -> dict[str, Node]:
    found = root.value.get(section)
    return found.value if found is not None and isinstance(found.value, dict) else {}


def _named(plain: dict[str, Any], study: Path) -> Iterator[Entry]:
    """Muscles and materials that entries name; what is no name is refused later."""
    for entry in _mappings(plain, "scenes"):
        listed = entry.get("muscles")
        for name in listed if isinstance(listed, list) else [listed]:
            yield from _entry_of("muscles", name)
    for entry in _mappings(plain, "calibration"):
        yield from _entry_of("muscles", entry.get("muscle"))
    for entry in _mappings(plain, "map"):
        yield from _entry_of("muscles", entry.get("muscle"))
    for entry in _mappings(plain, "design"):
        yield from _entry_of("muscles", entry.get("base"))
        free = entry.get("free")
        for key, section in (("muscle", "muscles"), ("material", "materials")):
            listed = free.get(key) if isinstance(free, dict) else None
            for name in listed if isinstance(listed, list) else [listed]:
                yield from _entry_of(section, name)
    for entry in _mappings(plain, "muscles"):
        swept = entry.get("sweep")
        for row in (entry, *_rows(entry.get("table"), study)):
            for key, section in NAMING.items():
                yield from _entry_of(section, row.get(key))
        materials = swept.get("material") if isinstance(swept, dict) else None
        for name in materials if isinstance(materials, list) else [materials]:
            yield from _entry_of("materials", name)


def _rows(table: object, study: Path) -> list[dict[str, str]]:
    """Rows of a table of muscles; none of one that cannot be read, which is refused later."""
    if not isinstance(table, str):
        return []
    try:
        file = Path(user_file.named_by(study, table))
        return list(csv.DictReader(user_file.text_of(file).splitlines()))
    except (StudyError, csv.Error):
        return []


def _mappings(plain: dict[str, Any], section: str) -> Iterator[dict[str, Any]]:
    entries = plain.get(section)
    if isinstance(entries, dict):
        yield from (entry for entry in entries.values() if isinstance(entry, dict))


def _entry_of(section: str, name: object) -> Iterator[Entry]:
    if isinstance(name, str):
        yield section, name
