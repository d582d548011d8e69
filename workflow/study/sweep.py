"""Many muscles of one entry: a sweep over values of its keys, or the rows of a table.

Each of them becomes an entry of its own whose ``base`` is the entry that says so. A value that is
refused is named where it was written, in the sweep or in the row.
"""

import csv
import itertools
import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from workflow.study import plain_yaml, user_file
from workflow.study.errors import Findings, StudyError, choices, printable, shown
from workflow.study.plain_yaml import Node
from workflow.study.schema import (
    NAME,
    NAME_RULE,
    SWEPT,
    MuscleEntry,
    StudyFile,
    SweepEntry,
)
from workflow.study.source import Source

MOST = 10_000  # muscles of one entry: more is a typing error in a grid
NAMES = "name"  # column of a table
WORDS = ("base", "angle_of", "material")  # columns of names
LISTS = ("layer_depths", "reference")  # columns of several values, with spaces between
NESTED = ("sweep", "table", "layers")  # keys that are no columns
COLUMNS = (NAMES, *(key for key in MuscleEntry.model_fields if key not in NESTED))


def spread(source: Source, file: StudyFile, findings: Findings) -> tuple[Source, StudyFile]:
    """A study in which every muscle of a sweep or table is an entry, and scenes name these."""
    made = _Spread(source, file)
    for name, entry in file.muscles.items():
        if entry.sweep is not None or entry.table is not None:
            made.groups[name] = ()
            with findings.gathering():
                made.add(name, entry, findings)
    if not made.groups:
        return source, file
    scenes = {
        name: scene.model_copy(update={"muscles": tuple(sorted(set(made.single(scene.muscles))))})
        for name, scene in file.scenes.items()
    }
    return made.source(), file.model_copy(update={"muscles": made.entries, "scenes": scenes})


class _Spread:
    """Entries, those of the file and the new ones; where each value of the new ones stands."""

    def __init__(self, source: Source, file: StudyFile) -> None:
        self._source = source
        self.entries: dict[str, MuscleEntry] = dict(file.muscles)
        self.groups: dict[str, tuple[str, ...]] = {}  # names by that of their entry
        self._plain: dict[str, dict[str, Any]] = {}
        self._nodes: dict[str, Node] = {}
        self._files: dict[str, str] = {}  # of the rows of tables

    def single(self, names: tuple[str, ...]) -> Iterator[str]:
        """Names of single muscles; of an entry that was refused its own."""
        for name in names:
            yield from self.groups.get(name) or (name,)

    def source(self) -> Source:
        """The text as if all entries stood there."""
        plain, root = self._source.plain, self._source.root
        muscles = root.value["muscles"]
        nodes = replace(
            muscles,
            value={**muscles.value, **self._nodes},
            lines={**muscles.lines, **{name: node.line for name, node in self._nodes.items()}},
        )
        return replace(
            self._source,
            plain={**plain, "muscles": {**plain["muscles"], **self._plain}},
            root=replace(root, value={**root.value, "muscles": nodes}),
            groups=self.groups,
            files=self._files,
        )

    def add(self, name: str, entry: MuscleEntry, findings: Findings) -> None:
        """The muscles of an entry."""
        keys = ("muscles", name)
        if entry.sweep is not None and entry.table is not None:
            raise self._source.refuse((*keys, "table"), entry.table, "either sweep or table")
        if entry.sweep is not None:
            self._add_sweep(name, entry, entry.sweep)
        else:
            self._add_table(name, str(entry.table), findings)

    def _add_sweep(self, name: str, entry: MuscleEntry, sweep: SweepEntry) -> None:
        keys = ("muscles", name, "sweep")
        values = {key: getattr(sweep, key) for key in SWEPT if getattr(sweep, key) is not None}
        if not values:
            raise self._source.refuse(keys, {}, f"values of some of {', '.join(SWEPT)}")
        for key in values:
            if getattr(entry, key) is not None:
                allowed = "this key in the sweep, or here"
                raise self._source.refuse(("muscles", name, key), getattr(entry, key), allowed)
        count = math.prod(map(len, values.values()))
        if count > MOST:
            most = max(values, key=lambda key: len(values[key]))
            allowed = f"at most {MOST} muscles of one entry, not {count}"
            raise self._source.refuse((*keys, most), f"{len(values[most])} values", allowed)
        node = self._source.root.value["muscles"].value[name].value["sweep"]
        lines = {key: node.lines[key] for key in values}
        found = {}
        for chosen in itertools.product(*values.values()):
            own = dict(zip(values, chosen, strict=True))
            parts = [f"{SWEPT[key]}{_text(value)}" for key, value in own.items()]
            new = "-".join([name, *parts])
            if not NAME.fullmatch(new):
                allowed = f"a name of this entry with which {new} has {NAME_RULE}"
                raise self._source.refuse(keys[:2], name, allowed)
            if new in found or new in self._source.plain["muscles"] or new in self.entries:
                allowed = f"muscles whose names are free; there is a {new} already"
                raise self._source.refuse(keys, list(values), allowed)
            found[new] = own
        for new, own in found.items():
            self._note(name, new, own, lines, lines[next(iter(own))])
            self.entries[new] = MuscleEntry.model_construct({"base", *own}, base=name, **own)
        self.groups[name] = tuple(found)

    def _add_table(self, name: str, table: str, findings: Findings) -> None:
        """Rows of a CSV file; each is refused alone."""
        found: list[str] = []
        study = self._source.path
        table = user_file.named_by(study, table)
        try:
            rows = _rows(table)
        except StudyError as said:
            by = f"\n  named by {self._source.place(('muscles', name, 'table'))}"
            raise StudyError(f"{said}{user_file.sought(study, table)}{by}", said.line) from None
        for line, row in rows:
            new = row.pop(NAMES, None)
            place = f"{printable(table)}:{line}"
            try:
                self._check_name(place, new)
                entry = MuscleEntry.model_validate({"base": name} | row)
            except ValidationError as errors:
                for error in errors.errors(include_url=False):
                    key, allowed = error["loc"][0], error["msg"].removeprefix("Input should be ")
                    text = f"{place}: {key} = {shown(row.get(str(key)))} is refused"
                    findings.add(StudyError(f"{text}\n  allowed: {allowed}", line))
                continue
            except StudyError as error:
                findings.add(error)
                continue
            self._note(name, str(new), row, dict.fromkeys(row, line), line)
            self._files[str(new)] = table
            self.entries[str(new)] = entry
            found.append(str(new))
        self.groups[name] = tuple(found)

    def _check_name(self, place: str, name: object) -> None:
        """Refuse what is no name, or one that is taken."""
        if not isinstance(name, str) or not NAME.fullmatch(name):
            given = "is missing" if name is None else f"= {shown(name)} is refused"
            raise StudyError(f"{place}: {NAMES} {given}\n  allowed: {NAME_RULE}")
        if name in self.entries or name in self._source.plain["muscles"]:
            text = f"{place}: {NAMES} = {shown(name)} is refused"
            raise StudyError(f"{text}\n  allowed: a name that no other muscle has")

    def _note(
        self, name: str, new: str, own: Mapping[str, Any], lines: dict[Any, int], line: int
    ) -> None:
        """What stands where."""
        self._plain[new] = {"base": name} | {k: _plain(value) for k, value in own.items()}
        nodes = {key: Node(_plain(value), lines[key]) for key, value in own.items()}
        self._nodes[new] = Node(nodes, line, lines)


def _plain(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value


def _text(value: float | str) -> str:
    """A value as part of a name: 10, 0.5, nbr."""
    return value if isinstance(value, str) else f"{value:.12g}"


def _rows(table: str) -> list[tuple[int, dict[str, Any]]]:
    """The rows of a table with their lines; what is empty is not there."""
    name = printable(table)
    reader = csv.reader(user_file.text_of(Path(table)).splitlines(keepends=True), strict=True)
    try:
        columns = [column.strip() for column in next(reader, [])]
        for column in columns:
            if column not in COLUMNS:
                allowed = f"columns, separated by commas: {choices(column, COLUMNS)}"
                raise StudyError(f"{name}:1: {shown(column)} is no column\n  allowed: {allowed}", 1)
        twice = next((c for c in columns if columns.count(c) > 1), None)
        if twice or NAMES not in columns:
            wrong = f"the column {twice} is there twice" if twice else f"no column {NAMES}"
            raise StudyError(f"{name}:1: {wrong}\n  allowed: every column once, with {NAMES}", 1)
        found = []
        for cells in reader:
            if not any(cell.strip() for cell in cells):
                continue
            line = reader.line_num
            if len(cells) != len(columns):
                text = f"{name}:{line}: {len(cells)} values\n  allowed: one for each of"
                raise StudyError(f"{text} {len(columns)} columns, if only an empty one", line)
            pairs = zip(columns, map(str.strip, cells), strict=True)
            found.append((line, {key: _value(key, cell) for key, cell in pairs if cell}))
            if len(found) > MOST:
                raise StudyError(f"{name}: more than {MOST} muscles\n  allowed: {MOST}", line)
    except csv.Error as error:
        raise StudyError(f"{name}:{reader.line_num}: cannot be read ({error})") from None
    if not found:
        raise StudyError(f"{name}: no muscle stands there\n  allowed: at least one row")
    return found


def _value(key: str, cell: str) -> Any:
    """A cell as it would stand in a study file."""
    if key == NAMES or key in WORDS:
        return cell
    if key in LISTS:
        return [plain_yaml.scalar(part) for part in cell.split()]
    return plain_yaml.scalar(cell)
