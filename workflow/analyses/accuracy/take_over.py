"""Errors found by the analysis of accuracy, taken over into workflow/plan/mesh_error.csv."""

import csv
import time
from pathlib import Path

from geometry.files import atomic_write
from solver import record
from solver.models import MODELS
from workflow.analyses import planner_tables
from workflow.plan.mesh_error import COLUMNS, FILE


def take_over(table_file: Path, path: Path = FILE) -> None:
    """Write the table from that of the analysis of accuracy.

    Raises
    ------
    StudyError
        If the analysis has not been evaluated.
    """
    rows = [row for row in planner_tables.read(table_file, "accuracy") if row["set"] == "scenes"]
    families: dict[tuple[str, ...], list[dict[str, str]]] = {}
    for row in rows:
        families.setdefault((*_written(row), f"{float(row['refinement']):g}"), []).append(row)
    with atomic_write(path) as beside, beside.open("w", newline="", encoding="utf-8") as stream:
        stream.write(f"# {time.strftime('%Y-%m-%d')}, code {record.code_digest(*MODELS)}\n")
        table = csv.writer(stream, lineterminator="\n")
        table.writerow(COLUMNS)
        for key, family in families.items():
            worst = max(family, key=lambda row: float(row["force_error [1]"]))
            diameter = max(float(row["diameter_error [1]"]) for row in family)
            errors = (f"{float(worst['force_error [1]']):.2e}", f"{diameter:.2e}")
            table.writerow([*key, *errors, len(family), worst["mesh"]])


def _written(row: dict[str, str]) -> list[str]:
    """Settings of a row of the table, numbers in their shortest form."""
    steps = (f"{float(row[name]):g}" for name in ("cap_step", "growth", "body_step"))
    return [row["model"], row["end"], *steps, row["rows"]]
