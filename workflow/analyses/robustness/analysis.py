"""What the analysis of robustness is and writes."""

from workflow.analyses.analysis import PAPERS, Analysis

ANALYSIS = Analysis(
    name="robustness",
    title="Robustness",
    chapter="5 Hard cases",
    muscles=PAPERS,
    tables={"robustness": None, "robustness_notes": "%.4g"},
    figures=("robustness", "robustness_worst"),
    page=("robustness_notes",),
    in_dataset=True,
)
