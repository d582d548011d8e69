"""What the cases of the analysis of accuracy have cost: seconds by purpose, unknowns, memory.

From the benchmark where that has been run (results/cost.csv, medians of several runs one after the
other), else from the single solve of each case (results/cost/<case>.json), beside which other jobs
ran. All seconds are CPU seconds: they depend least on what else the machine does.
"""

import json
from collections.abc import Iterable
from typing import Any

import numpy as np
import pandas as pd

from workflow.analyses.accuracy.analysis import BENCHMARK
from workflow.analyses.accuracy.errors import exponent
from workflow.study import folders

SINGLE = folders.COST
PARTS = {  # column: what it is, in the order in which it is spent
    "mesh [s]": "mesh",
    "python [s]": "Python",
    "start [s]": "FreeFEM's start",
    "assembly [s]": "assembly",
    "factor [s]": "factorisation",
    "residual [s]": "residuals",
    "rest [s]": "the rest",
}
COLUMNS = [
    "solve [s]",
    *PARTS,
    "iterations [1]",
    "factorisations [1]",
    "unknowns [1]",
    "memory [MB]",
]
SOLVE, MEMORY, UNKNOWNS = "solve [s]", "memory [MB]", "unknowns [1]"


def of_cases(cases: Iterable[str]) -> pd.DataFrame:
    """One row per case whose cost is known, by its key."""
    wanted = list(cases)
    if BENCHMARK.exists():
        measured = pd.read_csv(BENCHMARK, comment="#").set_index("case")
        measured = measured[measured.index.isin(wanted)]
        if len(measured):
            return measured
    single = {case: SINGLE / f"{case}.json" for case in wanted}
    found = {
        case: of_run(json.loads(path.read_text())) for case, path in single.items() if path.exists()
    }
    return pd.DataFrame.from_dict(found, orient="index", columns=None if found else COLUMNS)


def of_run(cost: dict[str, Any]) -> dict[str, float]:
    """One run, from the file that ``python -m solver`` writes."""
    parts = ("start", "assembly", "factor", "residual", "rest")
    by_freefem = "freefem_cpu_seconds" in cost
    return {
        SOLVE: cost["freefem_cpu_seconds" if by_freefem else "solve_cpu_seconds"],
        "python [s]": cost["python_cpu_seconds"] + by_freefem * cost["solve_cpu_seconds"],
        **{f"{part} [s]": cost.get(f"freefem_{part}_seconds", np.nan) for part in parts},
        "iterations [1]": cost.get("freefem_iterations", np.nan),
        "factorisations [1]": cost.get("freefem_factorisations", np.nan),
        UNKNOWNS: cost.get("freefem_unknowns", np.nan),
        MEMORY: cost.get("freefem_peak_memory", np.nan),
    }


def joined(table: pd.DataFrame, costs: pd.DataFrame) -> pd.DataFrame:
    """The table of the analysis with the costs of every case, NaN where they are not known."""
    return table.join(costs[[name for name in costs if name not in table]], on="case")


def growth(known: pd.DataFrame) -> pd.DataFrame:
    """Exponents of seconds and memory against unknowns and against the number of states.

    ``known`` has a row per case with its setting and its costs.

    Seconds without FreeFEM's start. Against unknowns: a family of meshes; against states: steps.
    """
    known = known[known[UNKNOWNS].notna()]
    known = known.assign(**{"after start [s]": known[SOLVE] - known["start [s]"]})
    found = []
    for model in ("membrane", "solid", "cell"):
        own = known[known["model"] == model]
        family = (own["refinement"] > 0) | (model == "cell")  # whose meshes are no refinements
        mesh = own[(own["set"] == "mesh") & family]
        steps = own[own["set"].isin(["steps", "mesh"]) & (own["mesh"] == "1/1")]
        for quantity, against, points in (
            ("after start [s]", UNKNOWNS, mesh),
            ("assembly [s]", UNKNOWNS, mesh),
            ("factor [s]", UNKNOWNS, mesh),
            (MEMORY, UNKNOWNS, mesh),
            ("after start [s]", "states", steps),
            (MEMORY, "states", steps),
        ):
            if len(points) > 1:
                x = points[against]
                found.append(
                    {
                        "model": model,
                        "quantity": quantity,
                        "against": against,
                        "exponent [1]": exponent(x, points[quantity]),
                        "from": x.min(),
                        "to": x.max(),
                    }
                )
    columns = ["model", "quantity", "against", "exponent [1]", "from", "to"]
    return pd.DataFrame(found, columns=columns)
