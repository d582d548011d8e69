"""What guesses of effects are made of, from the analysis: workflow/plan/like_effects.csv."""

from pathlib import Path

from workflow.analyses import planner_tables
from workflow.plan.like_effects import FILE


def take_over(tables: Path, file: Path = FILE) -> None:
    """Write the table from that of the analysis.

    Raises
    ------
    StudyError
        If the analysis has not been evaluated.
    """
    rows = planner_tables.read(tables / "like_effects.csv", "like_effects")
    planner_tables.write(file, rows, "effects on like muscles")
