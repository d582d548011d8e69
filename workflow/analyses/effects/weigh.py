"""What the planner knows of effects, measured: workflow/plan/effect_costs.csv."""

import csv
import json
from dataclasses import fields
from datetime import date
from pathlib import Path

from geometry.files import atomic_write
from solver.models import MODELS
from solver.record import code_digest
from workflow.analyses import analysis
from workflow.analyses.analysis import Solved
from workflow.analyses.effects.table import table
from workflow.data import records
from workflow.plan.effect_costs import FILE, MeasuredEffect
from workflow.study import folders

COSTS = folders.COST


def measure(study: str, costs: Path = COSTS, file: Path = FILE) -> None:
    """Write what is measured by a solved analysis of effects, with the seconds of its cases."""
    solved = []
    seconds: dict[tuple[str, str, str], float] = {}
    for asked in analysis.cases("effects", study):
        _, solution = records.read_one(asked.case.key, asked.label)
        solved.append(Solved(asked, solution))
        cost = json.loads((costs / f"{asked.case.key}.json").read_text())
        tags = asked.tags
        place = str(tags["regime"]), str(tags["path"]), str(tags["setup"])
        seconds[place] = cost["python_cpu_seconds"] + cost.get("freefem_cpu_seconds", 0.0)
    rows = table(solved).to_dict("records")
    for row in rows:
        for side in ("with", "without"):
            spent = seconds[row["regime"], row["path"], row[side]]
            row[f"seconds_{side}"] = float(f"{spent:.2g}")
    names = [f.name for f in fields(MeasuredEffect)]
    with atomic_write(file) as beside, beside.open("w", newline="") as stream:
        stream.write(f"# analysis of effects of {date.today()}, code {code_digest(*MODELS)}\n")
        writer = csv.DictWriter(stream, names, extrasaction="ignore", lineterminator="\n")
        writer.writeheader()
        writer.writerows(
            {n: "" if v != v else f"{v:g}" if isinstance(v, float) else v for n, v in row.items()}
            for row in rows
        )
