"""What the analysis of the ladder is and writes."""

from workflow.analyses.analysis import Analysis

ANALYSIS = Analysis(
    name="ladder",
    title="Ladder of models",
    chapter="4 Effects",
    takes_hours=True,
    tables={"ladder": None, "ladder_states": None},
)
