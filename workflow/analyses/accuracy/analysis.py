"""What the analysis of accuracy is and writes."""

from workflow.analyses.analysis import PAPERS, Analysis

ANALYSIS = Analysis(
    name="accuracy",
    title="Accuracy",
    chapter="3 Accuracy",
    muscles=PAPERS,
    tables={"accuracy": None},
    figures=("accuracy", "accuracy_orders"),
)
