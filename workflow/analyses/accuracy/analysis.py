"""What the analysis of accuracy is and writes."""

from geometry.files import RESULTS
from workflow.analyses.analysis import PAPERS, Analysis
from workflow.study.contents import Study

BENCHMARK = RESULTS / "cost.csv"  # what snakemake benchmark has measured


class Accuracy(Analysis):
    """That of accuracy, whose first figure has the seconds of this machine."""

    def inputs(self, study: Study) -> list[str]:
        """Those seconds, if they have been measured."""
        return [str(BENCHMARK)] if BENCHMARK.exists() else []


ANALYSIS = Accuracy(
    name="accuracy",
    title="Accuracy",
    chapter="3 Accuracy",
    muscles=PAPERS,
    tables={"accuracy": None},
    figures=("accuracy", "accuracy_orders"),
)
