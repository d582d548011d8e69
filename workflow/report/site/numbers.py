"""Numbers of the documentation: each has a source, and is what that says.

A number with a unit, or alone in the cell of a table, must be one of these:

- of a table that the pipeline has made, which a comment names in the same paragraph, list or table
  or on the line above it; rows are chosen by their columns. It is compared to its last digit, a
  share also as per cent::

      <!-- source: claims.csv id=C3a; accuracy.csv set=mesh model=solid -->

- given, with where from: for all of a paragraph, for some numbers of it, for a page, or in
  docs/numbers/given.csv for all pages::

      <!-- given: the data sheet of the maker -->
      <!-- given 0.13 33: measured on an idle machine, 2026-11-26 -->
      <!-- given on this page: measured when it was decided -->

- an input of the default study (config/config.yaml).

Tables are copies in docs/numbers of what a run writes to results/tables; ``muscle numbers`` takes
them over.
"""

import re
import shlex
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd

from solver.sources import ROOT
from workflow.report import tables

FOLDER = ROOT / "docs/numbers"
GIVEN = FOLDER / "given.csv"  # value, unit, reference
PAGES = ("README.md", "docs/*.md", "docs/howto/*.md", "docs/decisions/*.md", "docs/reference/*.md")
DIGITS = r"[−-]?\d+(?:[ ,]\d{3}(?!\d))*(?:\.\d+)?"
UNITS = (
    *("%", "N/mm", "N", "MPa", "kPa", "bar", "mm", "ms", "s", "min", "h", "MB", "kB", "GB"),
    *("seconds", "minutes", "hours"),
)
COSTS = ("ms", "s", "min", "h", "MB", "kB", "GB", "seconds", "minutes", "hours")
NUMBER = re.compile(
    rf"(?<![\w.,/-])({DIGITS})(?:\s?\(({DIGITS})\))?\s?({'|'.join(map(re.escape, UNITS))})(?![\w/])"
)
MORE = re.compile(rf"(?<![\w.])({DIGITS})(?:,| to| and| or|, and)? $")  # before one with a unit
CELL = re.compile(r"[\d.,()%±−\s-]*(?:(?:to|and)[\d.,()%±−\s-]*)*")
COMMENT = re.compile(r"<!--\s*(.*?)\s*-->", re.S)


@dataclass(frozen=True)
class Number:
    """A number as it is written, and its unit if it has one."""

    text: str
    unit: str = ""

    @property
    def value(self) -> float:
        """Its size; signs are a matter of words."""
        return abs(float(re.sub("[ ,]", "", self.text.replace("−", "-"))))

    @property
    def half(self) -> float:
        """Half of its last digit."""
        return 0.5 * 10.0 ** -len(self.text.partition(".")[2])

    def is_of(self, values: Sequence[float]) -> bool:
        """Whether it is one of these to its last digit, as it stands or as per cent."""
        near = self.half * (1 + 1e-9)
        found = np.abs(np.asarray(values, dtype=float))
        shown = [found, 100 * found] if self.unit in ("", "%") else [found]
        return any(bool((np.abs(each - self.value) <= near).any()) for each in shown)

    def __str__(self) -> str:
        return f"{self.text} {self.unit}".strip()


def problems(file: str, text: str) -> list[str]:
    """What is wrong with the numbers of a page, each with its line."""
    found = []
    page_is_given = re.search(r"<!--\s*given on this page: \S", text) is not None
    for line, block in blocks(text):
        sourced: list[float] = []
        own: list[float] = []
        is_given = page_is_given
        try:
            for comment in COMMENT.findall(block):
                sourced += list(_sourced(comment))
                if match := re.fullmatch(r"given([\d. ]*): \S.*", comment, re.S):
                    own += map(float, match[1].split())
                    is_given = is_given or not match[1].strip()
        except ValueError as error:
            found.append(f"{file}:{line}: {error}")
            continue
        for number in numbers(block):
            ways = number.is_of(sourced), number.value in own, is_input(number), is_given
            if not any(ways):
                why = "is not in the table named as its source" if sourced else "has no source"
                found.append(f"{file}:{line}: {number} {why} (workflow/report/site/numbers.py)")
    return found


def blocks(text: str) -> Iterator[tuple[int, str]]:
    """Paragraphs, lists and tables with the line they begin in; comments stand with what follows.

    Code, formulas, headings and the targets of links have no numbers of ours; they are blanked.
    """
    for pattern in (r"^```.*?^```", r"\$\$.*?\$\$"):
        text = re.sub(pattern, _blanked, text, flags=re.S | re.M)
    text = re.sub(r"^    .*$", _blanked, text, flags=re.M)
    text = re.sub(r"`[^`\n]*`|\$[^$\n]*\$|\]\([^)\n]*\)|^#.*$", _blanked, text, flags=re.M)
    line, held = 1, ""
    start = 1
    for part in re.split(r"(\n[ \t]*\n)", text):
        if not held:
            start = line + len(part) - len(part.lstrip("\n"))
        held += part
        if COMMENT.sub("", held).strip() and not part.isspace():
            yield start, held
            held = ""
        line += part.count("\n")


def _blanked(match: re.Match[str]) -> str:
    return re.sub(r"[^\n]", "x", match[0])


def numbers(block: str) -> Iterator[Number]:
    """Those of a block that need a source."""
    words = COMMENT.sub("", block)
    for row in words.splitlines():
        if row.lstrip().startswith("|"):
            for cell in row.strip().strip("|").split("|"):
                if CELL.fullmatch(cell) and any(c.isdigit() for c in cell):
                    unit = "%" if "%" in cell else ""
                    yield from (Number(text, unit) for text in re.findall(DIGITS, cell))
                else:
                    yield from _in_words(cell)
    rest = "\n".join(row for row in words.splitlines() if not row.lstrip().startswith("|"))
    yield from _in_words(rest)


def _in_words(text: str) -> Iterator[Number]:
    flat = " ".join(text.split())
    for match in NUMBER.finditer(flat):
        unit = match[3]
        yield from (Number(each, unit) for each in match.groups()[:2] if each)
        before = flat[: match.start()]
        while more := MORE.search(before):
            yield Number(more[1], unit)
            before = before[: more.start()]


def _sourced(comment: str) -> Iterator[float]:
    """Numbers of the tables that a comment names.

    Raises
    ------
    ValueError
        If there is no such table, column or row.
    """
    kind, _, names = comment.partition(":")
    if kind != "source":
        return
    for name in names.split(";"):
        file, *chosen = shlex.split(name)
        rows = table(file)
        for each in chosen:
            column, _, wanted = each.partition("=")
            if column not in rows:
                raise ValueError(f"docs/numbers/{file} has no column {column}")
            rows = rows[rows[column].astype(str) == wanted]
        if rows.empty:
            raise ValueError(f"docs/numbers/{file} has no row {' '.join(chosen)}")
        for value in rows.to_numpy(dtype=object).ravel():
            if isinstance(value, str):  # also those of a sentence, as of why a claim is judged so
                yield from (Number(each).value for each in re.findall(DIGITS, value))
            elif isinstance(value, int | float) and np.isfinite(value):
                yield float(value)


@cache
def table(file: str) -> pd.DataFrame:
    """A table of docs/numbers; raises ValueError if there is none."""
    path = FOLDER / file
    if not path.is_file():
        raise ValueError(f"there is no docs/numbers/{file}")
    return tables.read(path, comment="#")


def is_input(number: Number) -> bool:
    """Whether it is a number of the default study, or listed as given."""
    if number.unit in COSTS:
        return (number.value, number.unit) in _listed()
    if (number.value, number.unit) in _listed():
        return True
    found = number.value / 100 if number.unit == "%" else number.value
    return round(found, 12) in _of_study()


@cache
def _listed() -> set[tuple[float, str]]:
    rows = table(GIVEN.name)
    return {(abs(float(row["value"])), str(row["unit"])) for row in rows.to_dict("records")}


@cache
def _of_study() -> set[float]:
    text = (ROOT / "config/config.yaml").read_text(encoding="utf-8")
    return {float(each) for each in re.findall(r"(?<![\w.])\d+(?:\.\d+)?", text)}


def of_all_pages() -> list[str]:
    """What is wrong with the numbers of all pages."""
    found = []
    for pattern in PAGES:
        for path in sorted(ROOT.glob(pattern)):
            name = path.relative_to(ROOT).as_posix()
            found += problems(name, path.read_text(encoding="utf-8"))
    return found


def copied(results: Path) -> Iterator[tuple[Path, Path]]:
    """Tables of docs/numbers, each with the one of a run that it is a copy of, if that is there."""
    for path in sorted(FOLDER.glob("*.csv")):
        made = results / "tables" / path.name
        if made.is_file():
            yield path, made


def outdated(results: Path, share: float = 1e-6) -> list[str]:
    """Tables of docs/numbers that are not those of a run."""
    found = []
    for path, made in copied(results):
        ours, theirs = table(path.name), tables.read(made)
        try:
            pd.testing.assert_frame_equal(ours, theirs, rtol=share, atol=1e-9, check_dtype=False)
        except AssertionError:
            name = path.relative_to(ROOT)
            found.append(f"{name} is not {made}: muscle numbers takes it over")
    return found
