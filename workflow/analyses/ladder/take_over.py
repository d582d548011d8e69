"""What guesses are made of, from the analysis of the ladder: workflow/plan/like_muscles.csv."""

from math import isnan
from pathlib import Path

from workflow.analyses import planner_tables
from workflow.plan.like_muscles import CURVES, STATES
from workflow.run.climbs import seconds
from workflow.study.errors import StudyError
from workflow.study.folders import CASES, COST


def take_over(tables: Path, curves: Path = CURVES, states: Path = STATES) -> None:
    """Write both tables from those of the analysis, with what the cases have cost.

    Raises
    ------
    StudyError
        If the analysis has not been evaluated, or what a case has cost is lost.
    """
    for name, path in (("ladder", curves), ("ladder_states", states)):
        rows = planner_tables.read(tables / f"{name}.csv", "ladder")
        for row in rows:
            if case := row.pop("case", ""):
                row["seconds"] = f"{cost_of(case):.2g}"
        planner_tables.write(path, rows, "the ladder")


def cost_of(case: str) -> float:
    """Seconds of a case, which the planner must know."""
    found = seconds(case)
    if isnan(found):
        raise StudyError(
            f"{COST / case}.json: there is no such cost; delete {CASES / case}.h5 and run "
            "snakemake ladder"
        )
    return found
