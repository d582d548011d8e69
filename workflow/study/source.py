"""The text of a study file: what stands in it, and every refusal with its line."""

from collections.abc import Callable, Collection, Iterator, Mapping, Set
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar, get_args

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from geometry.refusal import Refusal
from workflow.study import library, plain_yaml, units, user_file
from workflow.study.errors import Findings, StudyError, choices, printable, shown
from workflow.study.folders import DEFAULT
from workflow.study.plain_yaml import Node, UnreadableText
from workflow.study.schema import (
    INEXPRESSIBLE,
    LONGEST_NAME,
    MATERIALS,
    NAME_RULE,
    NOT_SWEPT,
    Entry,
    StudyFile,
    is_path,
    law_of,
)

T = TypeVar("T")
Keys = tuple[str | int, ...]
UNNAMED = (  # said where the study of this project is not there
    "\n  allowed: a study that is named, snakemake --config study=FILE or muscle ... --study FILE; "
    "without a name it is that of the checkout, in whose folder to run"
)
# Sections of entries by name
NAMED = ("materials", "muscles", "variants", "scenes", "calibration", "design", "map", "pair")


@dataclass(frozen=True)
class Source:
    """A file and what stands in it.

    Attributes
    ----------
    plain : dicts, lists and scalars, with the entries of the library that are named
    root : the same with line numbers
    library : which entries, by section and name, stand in the library and not in the file
    groups : names of the muscles of a sweep or table, by that of their entry
    files : tables in which muscles stand, by the muscle's name
    """

    path: Path
    plain: Any
    root: Node
    library: Set[Keys] = frozenset()
    groups: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    files: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def read(cls, path: Path, also: Collection[str] = ()) -> "Source":
        """Parse a file; a duplicate key is an error. ``also``: muscles of the library."""
        try:
            text = user_file.text_of(path)
        except StudyError as error:
            if path != DEFAULT or path.exists():
                raise
            raise StudyError(f"{error}{UNNAMED}") from None
        try:
            root = plain_yaml.read(text)
        except UnreadableText as error:
            findings = Findings()
            for line, problem in error.problems:
                where = printable(str(path)) + (f":{line}" if line else "")
                findings.add(StudyError(f"{where}: {problem}", line or 0))
            raise findings.error() from None
        root, taken = library.completed(path, root, also)
        return cls(path, root.plain(), root, taken)

    @classmethod
    def of_library(cls) -> "Source":
        """All entries of the library, as if a study had them."""
        root = library.whole()
        taken = {(s, name) for s in library.SECTIONS for name in library.names(s)}
        return cls(Path(library.FOLDER), root.plain(), root, taken)

    def validated(self, findings: Findings) -> StudyFile:
        """The entries that fit the schema; of the others, and of what has no value, the errors."""
        if not isinstance(self.plain, dict):
            sections = ", ".join(StudyFile.model_fields)
            text = f"{printable(str(self.path))}: is no study\n  allowed: a mapping with {sections}"
            raise StudyError(text)
        empty = list(_without_value(self.plain))
        places: list[Keys] = []
        unknown: list[Keys] = []  # keys without which an entry is sound
        left = self.plain
        while True:  # some errors are seen only when others are gone
            try:
                file = StudyFile.model_validate(left)
                break
            except ValidationError as errors:
                before = len(places), len(unknown)
                for error in errors.errors(include_url=False):
                    error["loc"] = _as_written(error["loc"])
                    alone = error["type"] == "extra_forbidden" and len(error["loc"]) == 3
                    to = unknown if alone else places
                    if error["loc"] not in to:
                        findings.add(self._of_schema(error))
                        to.append(error["loc"])
                if before == (len(places), len(unknown)):
                    raise findings.error() from None
            left = self._without(places, unknown)
        for keys in empty:
            if keys not in places:
                findings.add(self.refuse(keys, None, "a value; or leave the key out"))
                places.append(keys)
        return StudyFile.model_validate(self._without(places, unknown)) if empty else file

    def refuse(self, keys: Keys, value: object, allowed: str) -> StudyError:
        """The error for the value of a key (None: the key is missing)."""
        given = "is missing" if value is None else f"= {shown(value)} is refused"
        text = f"{self.place(keys)} {given}\n  allowed: {allowed}"
        guess = units.guess(next((k for k in reversed(keys) if isinstance(k, str)), ""), value)
        if guess:
            text += f"\n  perhaps: {guess}"
        return StudyError(text, self.line(keys) or 0, keys)

    def place(self, keys: Keys) -> str:
        """``file:line: key.path``; the line is that of the last key that is there."""
        line, file = self.line(keys), str(self.path)
        if keys[0] == "muscles" and len(keys) > 1:
            file = self.files.get(str(keys[1]), file)
        name = printable(file)
        if keys[:2] in self.library:
            name = library.file(str(keys[0]))
        where = f"{name}:{line}" if line is not None else name
        return f"{where}: {'.'.join(_readable(key) for key in keys)}"

    def line(self, keys: Keys) -> int | None:
        """Of the last key that is there."""
        node, line = self.root, None
        for key in keys:
            if isinstance(node.value, dict):
                alike = (k for k in node.value if str(k) == key)
                own = key if key in node.value else next(alike, None)
                if own not in node.value:
                    break
                line, node = node.lines[own], node.value[own]
            elif isinstance(node.value, list) and isinstance(key, int) and key < len(node.value):
                node = node.value[key]
                line = node.line
            else:
                break
        return line

    def has(self, keys: Keys) -> bool:
        """Whether a key was written there."""
        found = self.plain
        for key in keys:
            if not isinstance(found, dict) or key not in found:
                return False
            found = found[key]
        return True

    def file(self, name: str) -> str:
        """The path of a file that the study names, or the name of a map as it is."""
        return user_file.named_by(self.path, name) if is_path(name) else name

    def owner(self, muscle: str, key: str) -> str:
        """The muscle that wrote what a muscle has for a key; the root of its bases if none has."""
        muscles = self.plain["muscles"]
        for _ in muscles:  # no longer than that, should they go in a circle
            base = muscles[muscle].get("base")
            if key in muscles[muscle] or not isinstance(muscles.get(base), dict):
                break
            muscle = base
        return muscle

    def names(self, section: str) -> list[str]:
        """Names of the entries of a section, right or wrong."""
        found = self.plain.get(section)
        return [name for name in found if isinstance(name, str)] if isinstance(found, dict) else []

    def choices(self, section: str, value: object) -> str:
        """The names of a section and of the library, with the nearest one."""
        own = [name for name in self.names(section) if (section, name) not in self.library]
        said = choices(value, own)
        others = [name for name in library.names(section) if name not in own]
        if not others:
            return said
        _, near, nearest = choices(value, others).partition("(nearest: ")
        if near and "(nearest: " not in said:
            return f"{said} or, of the library, {nearest.rstrip(')')}"
        return f"{said} or one of the library (muscle list)"

    def checked(
        self,
        keys: Keys,
        build: Callable[..., T],
        values: Mapping[str, Any],
        renamed: Mapping[str, str] | None = None,
    ) -> T:
        """``build(**values)``, where a refusal names the key below ``keys``.

        ``renamed`` says what the study file calls a value that is called otherwise elsewhere.
        """
        try:
            return build(**values)
        except Refusal as refusal:
            name = (renamed or {}).get(refusal.field, refusal.field)
            raise self.refuse((*keys, name), refusal.value, refusal.allowed) from None

    def _known_keys(self, keys: Keys) -> list[str]:
        """Keys that there are at a place of the file."""
        if keys[:1] == ("materials",) and len(keys) > 1:
            law = law_of(_named(self.plain["materials"], keys[1]))
            return _schema_keys(keys[2:], MATERIALS[str(law)])
        return _schema_keys(keys)

    def _without(self, places: list[Keys], unknown: list[Keys]) -> dict[str, Any]:
        """What stands in the file without the entries, or else sections, of these places."""
        left = {
            key: dict(value) if key in NAMED and isinstance(value, dict) else value
            for key, value in self.plain.items()
        }
        for section, name, key in unknown:
            if section in NAMED:
                entry = {k: v for k, v in _named(left[section], name).items() if k != key}
                others = {k: v for k, v in left[section].items() if str(k) != str(name)}
                left[section] = others | {name: entry}
            else:
                left.pop(section, None)
        for place in places:
            section = place[0]
            if section not in NAMED or len(place) == 1 or not isinstance(left.get(section), dict):
                left = {key: value for key, value in left.items() if str(key) != section}
            else:
                entries = left[section]
                left[section] = {k: v for k, v in entries.items() if str(k) != str(place[1])}
        needed = [key for key, f in StudyFile.model_fields.items() if f.is_required()]
        return {key: {} for key in needed} | left

    def _of_schema(self, error: ErrorDetails) -> StudyError:
        keys = error["loc"]
        line = self.line(keys) or 0
        allowed = error["msg"].removeprefix("Input should be ")
        if keys and keys[-1] == "[key]":
            if keys[-2] in INEXPRESSIBLE:
                return self.refuse(keys[:-1], error["input"], INEXPRESSIBLE[str(keys[-2])])
            allowed = allowed if error["type"] == "refused" else NAME_RULE
            return StudyError(
                f"{self.place(keys[:-1])} is no name here\n  allowed: {allowed}", line
            )
        if error["type"] in ("union_tag_invalid", "union_tag_not_found"):
            law = self.plain["materials"][keys[-1]]["law"]
            return self.refuse((*keys, "law"), law, choices(law, list(MATERIALS)))
        if error["type"] in ("extra_forbidden", "invalid_key"):
            if keys[-1] in INEXPRESSIBLE:
                return self.refuse(keys, error["input"], INEXPRESSIBLE[str(keys[-1])])
            allowed = choices(keys[-1], self._known_keys(keys[:-1]))
            if keys[-2:-1] == ("sweep",) and keys[-1] in NOT_SWEPT:
                allowed = NOT_SWEPT[str(keys[-1])]
            return StudyError(
                f"{self.place(keys)} is no key here\n  allowed: {allowed}", line, keys
            )
        if error["type"] == "missing":
            return self.refuse(keys, None, "this key must be given")
        if error["type"] in ("model_type", "dict_type"):
            allowed = "a mapping, key: value"
        if error["type"] in ("too_short", "too_long"):  # "... have X after validation"
            allowed = allowed.split(" have ")[-1].split(" after ")[0]
        if error["input"] is None:
            text = f"{self.place(keys)} = None is refused\n  allowed: {allowed}"
            return StudyError(text, line, keys)
        return self.refuse(keys, error["input"], allowed)


def _as_written(keys: Keys) -> Keys:
    """The place of an error without the law by which the schema of a material was chosen."""
    chosen = len(keys) > 2 and keys[0] == "materials" and keys[2] in MATERIALS
    return keys[:2] + keys[3:] if chosen else keys


def _without_value(node: Any, keys: Keys = ()) -> Iterator[Keys]:
    if isinstance(node, Mapping):
        for key, value in node.items():
            yield from [(*keys, key)] if value is None else _without_value(value, (*keys, key))


def _readable(key: str | int) -> str:
    plain = isinstance(key, str) and key.isprintable() and len(key) <= 2 * LONGEST_NAME
    return str(key) if plain else shown(key)


def _named(entries: Mapping[Any, Any], name: str | int) -> Any:
    """An entry by its name, which the schema has as text where the file has a number."""
    return next(entry for key, entry in entries.items() if str(key) == str(name))


def _schema_keys(keys: Keys, schema: Any = StudyFile) -> list[str]:
    """Keys that the schema, or the part of it that is given, has at a place."""
    for key in keys:
        if isinstance(schema, type) and issubclass(schema, Entry):
            schema = schema.model_fields[str(key)].annotation
            entry = [a for a in get_args(schema) if isinstance(a, type) and issubclass(a, Entry)]
            if entry and not _is_dict(schema):
                schema = entry[0]  # optional
        elif isinstance(key, int):
            schema = _entry_within(schema)  # of a list that may be left out
        else:
            schema = get_args(schema)[1]  # of dict[name, entry]
    return [field.alias or key for key, field in schema.model_fields.items()]


def _entry_within(schema: Any) -> Any:
    """The entry of which a list is."""
    if isinstance(schema, type) and issubclass(schema, Entry):
        return schema
    found = (_entry_within(part) for part in get_args(schema))
    return next((entry for entry in found if entry is not None), None)


def _is_dict(schema: Any) -> bool:
    return getattr(schema, "__origin__", None) is dict
