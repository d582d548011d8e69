"""A table of measured data as people have it: its separator, decimal sign, header and units found.

What is read is said (``Table.said``), so that a person sees what was understood; what cannot be
read is refused in one line with the guess what it may be. Numbers are in the units of the project.
"""

import csv
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from workflow.data import headers, wide
from workflow.data.headers import Header, Word
from workflow.study import user_file
from workflow.study.errors import StudyError, printable, shown

Array = NDArray[np.float64]
Cells = list[str]
LARGEST = 20_000_000  # bytes of a file: a million rows of a time series
COMMENTS = ("#", "%", "//", "!", "*")
SEPARATORS = {"\t": "tabs", ";": "semicolons", "|": "bars", ",": "commas", " ": "spaces"}
MISSING = {"", "nan", "na", "n/a", "#n/a", "null", "none", "-", "--", "?", "nil", "missing"}
SPACES = "\u00a0\u2007\u2009\u202f"  # that group digits
GROUPS = rf"\d{{1,3}}(?:[ '\u2019{SPACES}]\d{{3}})+"
NUMBER = re.compile(
    rf"(?P<sign>[+\-\u2212]?)(?P<digits>(?:{GROUPS}|\d[\d.,]*|[.,]\d+)(?:[.,]\d+)*)"
    r"(?P<power>[eE][+\-]?\d+)?\s*(?P<unit>[^\d\s.,;+\-][^\s;]{0,9})?"
)
SIGNS = {",": "comma", ".": "point"}  # before decimals
FEWEST = 2  # numbers of a row of data
SHOWN_LINES = 5


@dataclass(frozen=True)
class Column:
    """A column that is read: its place, and what its header says."""

    place: int
    header: Header

    @property
    def name(self) -> str:
        """As messages call it."""
        return shown(self.header.text.strip())


@dataclass(frozen=True)
class Table:
    """The rows of a file, as text, and its columns by quantity.

    Attributes
    ----------
    rows, lines : cells of the rows of data, and the line that each stands in
    decimal : sign before the decimals
    columns : by quantity
    unused : headers that mean nothing here
    how : how it is written, in words
    """

    path: Path
    rows: list[Cells]
    lines: list[int]
    decimal: str
    columns: dict[str, Column]
    unused: tuple[str, ...]
    how: str

    def texts(self, quantity: str) -> list[str]:
        """Cells of a column, as they are."""
        place = self.columns[quantity].place
        return [row[place].strip() if place < len(row) else "" for row in self.rows]

    def numbers(self, quantity: str) -> Array:
        """A column in the unit of the project; NaN where it has no value.

        Raises
        ------
        StudyError
            If a cell is neither a number nor empty.
        """
        column = self.columns[quantity]
        factor, values = column.header.factor, []
        for cell, line in zip(self.texts(quantity), self.lines, strict=True):
            if cell.lower() in MISSING:
                values.append(np.nan)
                continue
            value, unit = _number(cell, self.decimal)
            if value is None:
                raise StudyError(
                    f"{self.path}:{line}: not all of it are numbers; {shown(cell)} stands under "
                    f"{column.name}, and decimals follow a {SIGNS[self.decimal]}"
                )
            values.append(value * self._factor(column, unit, cell, line, factor))
        return np.array(values)

    def _factor(self, column: Column, unit: str, cell: str, line: int, factor: float) -> float:
        """Size of the unit of a cell, which may have one of its own."""
        if not unit:
            return factor
        key, units = headers.unit_of(unit), headers.UNITS[column.header.dimension]
        if key not in units or (column.header.unit and units[key] != factor):
            raise StudyError(
                f"{self.path}:{line}: {shown(cell)} under {column.name} has a unit that is not of "
                "this column"
            )
        return units[key]

    def refuse(self, text: str, line: int | None = None) -> StudyError:
        """An error that names the file."""
        return StudyError(f"{self.path}{'' if line is None else f':{line}'}: {text}")

    def said(self, quantity: str, values: Array) -> str:
        """What was understood of a column, with its range."""
        header = self.columns[quantity].header
        unit = headers.OF_PROJECT.get(header.dimension, "")
        finite = values[np.isfinite(values)]
        low, high = (finite.min(), finite.max()) if finite.size else (np.nan, np.nan)
        units = {found["unit"] for c in self.texts(quantity) if (found := NUMBER.fullmatch(c))}
        of_cells = ", ".join(sorted(filter(None, units)))
        written = header.unit or of_cells
        given = f"in {written}" if written else f"without a unit, taken as {unit or '1'}"
        name = self.columns[quantity].name
        return f"{quantity}: {name} {given}; {low:.6g} to {high:.6g} {unit}".strip()


def read(path: Path, words: tuple[Word, ...]) -> Table:
    """The table of a file, with the columns that some words name.

    Raises
    ------
    StudyError
        If it cannot be read, or its columns are not named or named twice.
    """
    name = printable(str(path))
    lines = user_file.text_of(path, LARGEST).splitlines()
    written = [(n, line) for n, line in enumerate(lines, 1) if line.strip()]
    plain = [(n, line) for n, line in written if not _is_comment(line)]
    plain = [(n, line) for n, line in plain if not re.fullmatch(r"(?i)sep=.", line.strip())]
    separator = _separator([line for _, line in plain])
    if separator is None:
        raise StudyError(f"{name}: nothing measured is in it: no line has two numbers")
    split = [(n, _cells(line, separator)) for n, line in plain]
    lines_of_file = split
    if words is headers.OF_MUSCLES:
        split = wide.lengthened(name, split, words, _is_number)
    rows_of_numbers = (
        k for k, (_, cells) in enumerate(split) if _share(cells) == 1 or _is_data(cells)
    )
    first = next(rows_of_numbers, None)
    if first is None:
        raise StudyError(
            f"{name}: nothing measured is in it: no line below the headers has numbers"
        )
    comments = [(n, _uncommented(line)) for n, line in written if _is_comment(line)]
    above = [(n, cells) for n, cells in split[:first]]
    found, how_named = _columns(name, above, comments, separator, words, split[first])
    rows, numbers, text_lines = _rows(name, split[first:], max(place for place, _ in found) + 1)
    heads = [header.text.strip() for _, header in found]
    columns = _of_quantities(name, found)
    decimal = _decimal(name, rows, numbers, separator)
    used = {column.place for column in columns.values()}
    unused = tuple(h for (place, _), h in zip(found, heads, strict=True) if place not in used and h)
    how = f"{SEPARATORS[separator]}, decimal {SIGNS[decimal]}, {how_named}"
    if split is not lines_of_file:
        how += "; forces in a column for each pressure or contraction"
    if text_lines:
        how += f"; lines of words between the numbers: {listed(text_lines)}"
    return Table(path, rows, numbers, decimal, columns, unused, how)


def _rows(
    name: str, lines: Sequence[tuple[int, Cells]], width: int
) -> tuple[list[Cells], list[int], list[int]]:
    """Cells of the rows of numbers, the lines they stand in, and lines of words between them."""
    rows, numbers, text_lines = [], [], []
    for n, cells in lines:
        if not any(_is_number(cell) for cell in cells):
            text_lines.append(n)  # a header again, or words between the rows
            continue
        if len(cells) > width:
            raise StudyError(
                f"{name}:{n}: there are {len(cells)} values for {width} columns; are decimal "
                "commas between commas? Write decimal points, or separate by semicolons"
            )
        rows.append(cells)
        numbers.append(n)
    return rows, numbers, text_lines


def listed(lines: Iterable[int]) -> str:
    """Some line numbers, the first few."""
    every = list(lines)
    more = f" and {len(every) - SHOWN_LINES} more" if len(every) > SHOWN_LINES else ""
    return ", ".join(map(str, every[:SHOWN_LINES])) + more


# --- text --------------------------------------------------------------------------------------


def _is_comment(line: str) -> bool:
    text = line.strip().lstrip('"')
    return text.startswith(COMMENTS) and not re.match(r"%\s*[;,\t]", text)


def _uncommented(line: str) -> str:
    return line.strip().strip('"').lstrip("#%/!* ")


def _cells(line: str, separator: str) -> Cells:
    """Cells of a line without those that are empty at its end."""
    if separator == " ":
        parts = re.split(r"\s{2,}|\t", line.strip())
        cells = parts if len(parts) > 1 else line.split()
        if not all(map(_is_number, cells)) and _is_number(line.split()[0]):
            cells = line.split()
    else:
        cells = next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])
    cells = [cell.strip() for cell in cells]
    while cells and not cells[-1]:
        cells.pop()
    return cells


def _is_number(cell: str) -> bool:
    return NUMBER.fullmatch(cell.strip()) is not None


def _share(cells: Cells) -> float:
    """Share of the cells that are numbers, if these are enough."""
    filled = [cell for cell in cells if cell.lower() not in MISSING]
    count = sum(map(_is_number, filled))
    return count / len(filled) if count >= FEWEST else 0.0


def _is_data(cells: Cells) -> bool:
    """Whether a row is of numbers, though a date or a name may stand beside them."""
    return _share(cells) > 0.5


def _separator(lines: list[str]) -> str | None:
    """The one by which most rows are of numbers only, all with as many cells."""
    best, most = None, 0.0
    for separator in SEPARATORS:
        rows = [cells for cells in (_cells(line, separator) for line in lines) if _is_data(cells)]
        if not rows:
            continue
        width = Counter(map(len, rows)).most_common(1)[0][0]
        score = sum(_share(cells) for cells in rows if len(cells) == width)
        if width >= FEWEST and score > most * (1 + 1e-9):
            best, most = separator, score
    return best


def _grouped(by: str, decimal: str) -> str:
    """Pattern of digits in groups of three."""
    return rf"\d{{1,3}}({re.escape(by)}\d{{3}})+({re.escape(decimal)}\d*)?"


def _number(cell: str, decimal: str) -> tuple[float | None, str]:
    """Value of a cell, and a unit that stands behind it."""
    found = NUMBER.fullmatch(cell)
    if found is None:
        return None, ""
    digits = re.sub(rf"[ '\u2019{SPACES}]", "", found["digits"])
    other = "." if decimal == "," else ","
    if other in digits and not re.fullmatch(_grouped(other, decimal), digits):
        return None, ""  # of the other decimal sign
    digits = digits.replace(other, "").replace(decimal, ".")
    sign = "-" if found["sign"] in ("-", "\u2212") else ""
    try:
        return float(sign + digits + (found["power"] or "")), found["unit"] or ""
    except ValueError:  # two decimal signs
        return None, ""


def _decimal(name: str, rows: list[Cells], lines: list[int], separator: str) -> str:
    """The decimal sign of all numbers of a file, which is one."""
    doubtful = None
    for cells, line in zip(rows, lines, strict=True):
        for cell in cells:
            found = NUMBER.fullmatch(cell)
            digits = found["digits"] if found else ""
            if re.fullmatch(r"\d{1,4}([.,])\d{1,2}\1\d{2,4}", digits):
                continue  # a date
            if "," in digits and "." in digits:
                return max(",.", key=digits.rindex)
            if "," in digits:
                if re.fullmatch(r"[1-9]\d{0,2}(,\d{3})+", digits):
                    doubtful = doubtful or (cell, line)
                    if digits.count(",") > 1:
                        return "."
                else:
                    return ","
            elif "." in digits and not re.fullmatch(r"[1-9]\d{0,2}(\.\d{3})+", digits):
                return "."
            elif digits.count(".") > 1:
                return ","
    if doubtful and separator != ",":
        cell, line = doubtful
        value = cell.replace(",", ".")
        raise StudyError(
            f"{name}:{line}: {cell} may be {value} or {cell.replace(',', '')}; write it without "
            "commas between thousands, or with decimal points"
        )
    return "."


# --- columns -----------------------------------------------------------------------------------


def _columns(
    name: str,
    above: list[tuple[int, Cells]],
    comments: list[tuple[int, str]],
    separator: str,
    words: tuple[Word, ...],
    first: tuple[int, Cells],
) -> tuple[list[tuple[int, Header]], str]:
    """Headers by place, and where they stand; units may stand in a line of their own."""
    units: tuple[int, Cells] | None = None
    best: tuple[int, int, list[Header]] | None = None
    near = [(n, _cells(text, separator)) for n, text in comments if n < first[0]]
    for number, cells in [*reversed(above), *reversed(near)]:
        filled = [cell for cell in cells if cell]
        if filled and units is None and best is None and all(map(headers.unit_of, filled)):
            units = number, cells
            continue
        read = [headers.read(cell, words) for cell in _joined(cells, separator, len(first[1]))]
        count = sum(bool(header.quantity) for header in read)
        if count > (best[1] if best else 0):
            best = number, count, read
    if best is None and units is not None:
        number, cells = units
        read = [headers.read(cell, words) for cell in cells]
        if any(header.quantity for header in read):
            best, units = (number, 1, read), None
    if best is None:
        if any(headers.read(cell, words).quantity for cell in first[1]):
            raise StudyError(
                f"{name}:{first[0]}: numbers stand among the names of columns; in a table with a "
                "column for each pressure these have their unit, as 1 bar, beside a column of "
                "contraction, stroke or length"
            )
        seen = above[-1][1] if above else []
        there = f"there are {', '.join(map(printable, seen))}" if seen else "there are only numbers"
        raise StudyError(
            f"{name}: no line above the numbers names the columns; {there}; "
            "write one such as pressure_MPa,contraction,force_N"
        )
    number, _, read = best
    how = f"header in line {number}"
    if units is not None:
        how += f", units in line {units[0]}"
        read = [
            _with_unit(header, units[1][k] if k < len(units[1]) else "", words)
            for k, header in enumerate(read)
        ]
    return list(enumerate(read)), how


def _joined(cells: Cells, separator: str, width: int) -> Cells:
    """Between spaces a unit in brackets belongs to the word before it."""
    if separator != " " or len(cells) == width:
        return cells
    found: Cells = []
    for cell in " ".join(cells).split():
        if found and (cell[0] in "[(" or found[-1].count("[") > found[-1].count("]")):
            found[-1] += f" {cell}"
        else:
            found.append(cell)
    return found


def _with_unit(header: Header, unit: str, words: tuple[Word, ...]) -> Header:
    """A header whose unit stands below it."""
    if header.unit or not unit.strip("[]() "):
        return header
    return replace(headers.read(f"{header.text} [{unit.strip('[]() ')}]", words), text=header.text)


def _of_quantities(name: str, found: list[tuple[int, Header]]) -> dict[str, Column]:
    """The column of every quantity; of a set and a measured one, the measured."""
    written = Counter(header.text.strip() for _, header in found if header.quantity)
    for text, count in written.items():
        if count > 1:
            raise StudyError(f"{name}: {count} columns are called {shown(text)}; leave one of them")
    columns: dict[str, Column] = {}
    for place, header in found:
        if not header.quantity or (header.unknown and header.quantity == "time"):
            continue
        if header.unknown:
            raise StudyError(
                f"{name}: the unit {shown(header.unknown)} of {shown(header.text)} is not known; "
                f"allowed: {', '.join(headers.UNITS[header.dimension])}"
            )
        other = columns.get(header.quantity)
        if other is not None and other.header.is_set == header.is_set:
            raise StudyError(
                f"{name}: both {other.name} and {shown(header.text)} may be the "
                f"{header.quantity}; leave one of them"
            )
        if other is None or other.header.is_set:
            columns[header.quantity] = Column(place, header)
    return columns
