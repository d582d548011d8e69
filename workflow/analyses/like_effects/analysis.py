"""What the analysis of effects on like muscles is and writes."""

from workflow.analyses.analysis import Analysis

ANALYSIS = Analysis(
    name="like_effects",
    title="Effects on muscles of all kinds",
    chapter="4 Effects",
    takes_hours=True,
    tables={"like_effects": None},
)
