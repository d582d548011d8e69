"""What the scorecard of the paper's claims is and writes."""

from workflow.analyses.analysis import PAPERS, Analysis

ANALYSIS = Analysis(
    name="claims",
    title="The paper's claims",
    chapter="2 The verdict",
    muscles=PAPERS,
    tables={"claims": None},
    page=("claims",),
    on_figures=True,
)
