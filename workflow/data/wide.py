"""Tables with a column of forces for each pressure, or for each contraction, made long.

Such as ``contraction [%]; 1 bar; 2 bar`` or ``F at 0.3 bar``, a line of pressures above a line of
names, and ``h [%] | p [bar]; 1; 2`` with one corner for both. Every force becomes a row of its own,
in the line in which it stands; what columns mean is then read as in any other table.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass

from workflow.data import headers
from workflow.data.headers import PRESSURE, UNITS, Word
from workflow.study.errors import StudyError

Cells = list[str]
Lines = list[tuple[int, Cells]]
PLACES = {"contraction", "stroke", "length", "strain", "extension", "stretch"}
NUMBER = r"[+\-]?\d+(?:[.,]\d+)?"
_UNITS = "|".join(sorted(map(re.escape, UNITS[PRESSURE]), key=len, reverse=True))
SETTINGS = {  # what columns may be for, and how one says so
    "pressure": re.compile(rf"(?<![\d.,])({NUMBER})\s*({_UNITS})(?![A-Za-z/])", re.IGNORECASE),
    "contraction": re.compile(rf"(?<![\d.,])({NUMBER})\s*(%)"),
}
ALONG = {"pressure": PLACES, "contraction": {"pressure"}}  # what rows are then for
LINK = r"(?i)(?<![a-z])(at|bei|for|und|@)(?![a-z])"  # a word that is no unit here
AROUND = {"p", "=", "pressure", "druck", "contraction", "h", ":", "-"}  # that say nothing more
CORNER = r"\s*[\\|]\s*|\s+/\s+|\s+(?:vs\.?|over|against)\s+"


@dataclass(frozen=True)
class _Head:
    """The line, or two, above such a table: where forces stand, at what, and what rows are for."""

    setting: str
    upper: int  # index of the line with the settings
    lower: int  # of that with the names of the rows
    at: dict[int, str]  # setting by column of force
    names: Cells  # of all columns
    unit: str  # of the forces, as far as the head says


def lengthened(
    name: str, lines: Lines, words: tuple[Word, ...], is_number: Callable[[str], bool]
) -> Lines:
    """The same lines, of a wide table as a long one; others as they are.

    Raises
    ------
    StudyError
        If a line has more values than there are columns; ``name`` is that of the file.
    """
    head = next(filter(None, (_head(lines, k, words, is_number) for k in range(len(lines)))), None)
    if head is None:
        return lines
    along = [k for k, name in enumerate(head.names) if k not in head.at and name]
    rows = [k for k in along if headers.read(head.names[k], words).quantity in ALONG[head.setting]]
    others = [k for k in along if k not in rows]
    unit, found = head.unit, list(lines[: head.upper])
    names = [head.names[k] for k in (*others, rows[0])]
    head_at = len(found)
    found.append((lines[head.lower][0], []))
    curves: dict[int, Lines] = {k: [] for k in head.at}
    for number, cells in lines[head.lower + 1 :]:
        filled = [cell for cell in cells if cell]
        here = cells + [""] * (len(head.names) - len(cells))
        if not any(curves.values()) and filled and all(map(headers.unit_of, filled)):
            unit = unit or next((here[k] for k in head.at if here[k]), "")
            names[-1] = _with_unit(names[-1], here[rows[0]])
            continue
        if not any(map(is_number, filled)):
            found.append((number, cells))  # words, which the reader names
            continue
        if len(cells) > len(head.names):
            raise StudyError(
                f"{name}:{number}: there are {len(cells)} values for {len(head.names)} columns; "
                "are decimal commas between commas?"
            )
        for k, setting in head.at.items():
            if here[k]:
                row = max((r for r in rows if r < k), default=rows[0])
                long = [*(here[o] for o in others), here[row], setting, here[k]]
                curves[k].append((number, long))
    found[head_at] = (
        found[head_at][0],
        [*names, head.setting, f"force [{unit.strip('[]()') or 'N'}]"],
    )
    return found + [row for curve in curves.values() for row in curve]


def _with_unit(name: str, unit: str) -> str:
    return f"{name} [{unit.strip('[]()')}]" if unit else name


def _head(
    lines: Lines, k: int, words: tuple[Word, ...], is_number: Callable[[str], bool]
) -> _Head | None:
    """The head of a wide table, if its settings stand in a line."""
    cells = lines[k][1]
    for setting in SETTINGS:
        found = _settings(cells, setting, words, is_number)
        if found is None:
            continue
        at, corner, unit = found
        for lower in (k, k + 1):
            if lower >= len(lines):
                continue
            names = list(lines[lower][1])
            if lower == k:
                names = ["" if j in at else name for j, name in enumerate(names)]
                if corner is not None:
                    names[corner[0]] = corner[1]
            elif not _is_below(names, setting, words, is_number):
                continue
            else:
                read = [headers.read(name, words) for name in names]
                forces = [j for j, each in enumerate(read) if each.quantity == "force"]
                at = {j: s for j in forces if (s := _left(at, j))}
                unit = unit or (read[forces[0]].unit if forces else "")
            names += [""] * (max(at, default=0) + 1 - len(names))
            keys = [
                headers.read(name, words).quantity for j, name in enumerate(names) if j not in at
            ]
            if ALONG[setting].intersection(keys) and "force" not in keys and at:
                return _Head(setting, k, lower, at, names, unit)
    return None


def _is_below(
    names: Cells, setting: str, words: tuple[Word, ...], is_number: Callable[[str], bool]
) -> bool:
    """Whether a line names the columns of the settings above it."""
    found = {headers.read(name, words).quantity for name in names if name}
    return "force" in found and setting not in found and not any(map(is_number, names))


def _left(at: dict[int, str], column: int) -> str:
    """The setting above a column, or the nearest to the left of it: cells may be joined."""
    return next((at[j] for j in range(column, -1, -1) if j in at), "")


def _settings(
    cells: Cells, setting: str, words: tuple[Word, ...], is_number: Callable[[str], bool]
) -> tuple[dict[int, str], tuple[int, str] | None, str] | None:
    """Settings by column with their unit, what is left of a corner, and a unit of force."""
    at: dict[int, str] = {}
    unit, of_force = "", False
    for k, cell in enumerate(cells):
        match = SETTINGS[setting].search(cell)
        if match is None:
            continue
        rest = headers.read(re.sub(LINK, " ", cell.replace(match[0], " ")), words)
        left = set(re.split(r"[\s_,()\[\]]+", rest.text.lower())) - AROUND - {""}
        if left and rest.quantity != "force" and not all(map(headers.unit_of, left)):
            return None
        at[k], unit = f"{match[1]} {match[2]}", unit or rest.unit
        of_force |= rest.quantity == "force"
    others = [k for k, cell in enumerate(cells) if cell and k not in at]
    if at:
        is_head = (of_force or len(at) > 1) and not any(is_number(cells[k]) for k in others)
        return (at, None, unit) if is_head else None
    return _by_corner(cells, setting, words, is_number)


def _by_corner(
    cells: Cells, setting: str, words: tuple[Word, ...], is_number: Callable[[str], bool]
) -> tuple[dict[int, str], tuple[int, str] | None, str] | None:
    """The same where bare numbers stand beside a corner that says what they are."""
    named = [k for k, cell in enumerate(cells) if cell and not is_number(cell)]
    bare = [k for k, cell in enumerate(cells) if cell and is_number(cell)]
    if len(named) != 1 or len({cells[k] for k in bare}) < 2 or min(bare) < named[0]:
        return None
    parts = [part for part in re.split(CORNER, cells[named[0]]) if part]
    read = [headers.read(part, words) for part in parts]
    key = next((each for each in read if each.quantity == setting and each.unit), None)
    if key is None:
        return None
    rest = [part for part, each in zip(parts, read, strict=True) if each is not key]
    at = {k: f"{cells[k]} {key.unit}" for k in bare}
    return at, (named[0], rest[0] if rest else ""), ""
