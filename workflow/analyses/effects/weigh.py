"""What the planner knows of effects, measured: effect_costs.csv, effect_states.csv."""

import csv
import json
from collections.abc import Mapping, Sequence
from dataclasses import fields
from datetime import date
from pathlib import Path
from typing import Any

from geometry.files import atomic_write
from solver.models import MODELS
from solver.record import code_digest
from workflow.analyses import analysis
from workflow.analyses.analysis import Solved
from workflow.analyses.effects.table import states, table
from workflow.data import records
from workflow.plan import effect_states
from workflow.plan.effect_costs import FILE, MeasuredEffect
from workflow.study import folders

COSTS = folders.COST


def measure(
    study: str, costs: Path = COSTS, file: Path = FILE, of_states: Path = effect_states.FILE
) -> None:
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
    _write(file, [f.name for f in fields(MeasuredEffect)], rows)
    _write(of_states, effect_states.COLUMNS, states(solved).to_dict("records"))


def _write(file: Path, names: Sequence[str], rows: Sequence[Mapping[Any, Any]]) -> None:
    with atomic_write(file) as beside, beside.open("w", newline="") as stream:
        stream.write(f"# analysis of effects of {date.today()}, code {code_digest(*MODELS)}\n")
        writer = csv.DictWriter(stream, names, extrasaction="ignore", lineterminator="\n")
        writer.writeheader()
        writer.writerows(
            {n: "" if v != v else f"{v:g}" if isinstance(v, float) else v for n, v in row.items()}
            for row in rows
        )
