"""What the analysis of sensitivities is and writes."""

from workflow.analyses.analysis import PAPERS, Analysis

ANALYSIS = Analysis(
    name="sensitivity",
    title="Sensitivity",
    chapter="4 Effects",
    muscles=PAPERS,
    tables={"sensitivity": None},
    figures=("sensitivity",),
)
