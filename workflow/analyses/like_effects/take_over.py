"""What guesses of effects are made of, from the analysis: workflow/plan/like_effects.csv."""

import csv
import time
from pathlib import Path

from geometry.files import atomic_write
from solver import record
from solver.models import MODELS
from workflow.analyses.ladder.take_over import shortened
from workflow.plan.like_effects import FILE
from workflow.study.errors import StudyError


def take_over(tables: Path, file: Path = FILE) -> None:
    """Write the table from that of the analysis.

    Raises
    ------
    StudyError
        If the analysis has not been evaluated.
    """
    table = tables / "like_effects.csv"
    if not table.exists():
        raise StudyError(f"{table}: there is no such table; run snakemake like_effects")
    with table.open(newline="", encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    with atomic_write(file) as beside, beside.open("w", newline="", encoding="utf-8") as out:
        out.write(f"# analysis of effects on like muscles of {time.strftime('%Y-%m-%d')}, ")
        out.write(f"code {record.code_digest(*MODELS)}\n")
        writer = csv.DictWriter(out, rows[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows({n: shortened(n, value) for n, value in row.items()} for row in rows)
