"""What guesses are made of, from the analysis of the ladder: workflow/plan/like_muscles.csv."""

import csv
import time
from math import isnan
from pathlib import Path

from geometry.files import atomic_write
from solver import record
from solver.models import MODELS
from workflow.plan.like_muscles import CURVES, STATES
from workflow.run.climbs import seconds
from workflow.study.errors import StudyError
from workflow.study.folders import CASES, COST

DIGITS = ".3g"


def take_over(tables: Path, curves: Path = CURVES, states: Path = STATES) -> None:
    """Write both tables from those of the analysis, with what the cases have cost.

    Raises
    ------
    StudyError
        If the analysis has not been evaluated, or what a case has cost is lost.
    """
    origin = f"# analysis of the ladder of {time.strftime('%Y-%m-%d')}, "
    origin += f"code {record.code_digest(*MODELS)}\n"
    for name, path in (("ladder", curves), ("ladder_states", states)):
        table = tables / f"{name}.csv"
        if not table.exists():
            raise StudyError(f"{table}: there is no such table; run snakemake ladder")
        with table.open(newline="", encoding="utf-8") as stream:
            rows = list(csv.DictReader(stream))
        for row in rows:
            if case := row.pop("case", ""):
                row["seconds"] = f"{cost_of(case):.2g}"
        with atomic_write(path) as beside, beside.open("w", newline="", encoding="utf-8") as out:
            out.write(origin)
            writer = csv.DictWriter(out, rows[0], lineterminator="\n")
            writer.writeheader()
            writer.writerows({n: shortened(n, value) for n, value in row.items()} for row in rows)


def cost_of(case: str) -> float:
    """Seconds of a case, which the planner must know."""
    found = seconds(case)
    if isnan(found):
        raise StudyError(
            f"{COST / case}.json: there is no such cost; delete {CASES / case}.h5 and run "
            "snakemake ladder"
        )
    return found


def shortened(name: str, value: str) -> str:
    """A number with few digits; texts and whole numbers as they are."""
    try:
        return value if name == "curve" else f"{float(value):{DIGITS}}"
    except ValueError:
        return value
