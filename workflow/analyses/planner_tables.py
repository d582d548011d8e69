"""From a table of an analysis to one of the planner: few digits, and where it is from."""

import csv
import time
from collections.abc import Sequence
from pathlib import Path

from geometry.files import atomic_write
from solver import record
from solver.models import MODELS
from workflow.study.errors import StudyError

DIGITS = ".3g"
Row = dict[str, str]


def read(table: Path, analysis: str) -> list[Row]:
    """Rows of a table of an analysis.

    Raises
    ------
    StudyError
        If the analysis has not been evaluated.
    """
    if not table.exists():
        raise StudyError(f"{table}: there is no such table; run snakemake {analysis}")
    with table.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def write(path: Path, rows: Sequence[Row], analysis: str) -> None:
    """A table for the planner, whole or not at all; its first line names the analysis."""
    with atomic_write(path) as beside, beside.open("w", newline="", encoding="utf-8") as out:
        out.write(f"# analysis of {analysis} of {time.strftime('%Y-%m-%d')}, ")
        out.write(f"code {record.code_digest(*MODELS)}\n")
        writer = csv.DictWriter(out, rows[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows({n: _shortened(n, value) for n, value in row.items()} for row in rows)


def _shortened(name: str, value: str) -> str:
    """A number with few digits; texts and whole numbers as they are."""
    try:
        return value if name == "curve" else f"{float(value):{DIGITS}}"
    except ValueError:
        return value
