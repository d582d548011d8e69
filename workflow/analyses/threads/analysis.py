"""What the analysis of discrete threads is and writes."""

from workflow.analyses.analysis import PAPERS, Analysis

ANALYSIS = Analysis(
    name="threads",
    title="Threads",
    chapter="4 Effects",
    muscles=PAPERS,
    tables={"threads": None},
    figures=("threads", "threads_correction"),
    in_dataset=True,
)
