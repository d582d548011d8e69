"""What the analysis of promises is and writes."""

from dataclasses import dataclass

from workflow.analyses.analysis import Analysis
from workflow.study.contents import Study


@dataclass(frozen=True, kw_only=True)
class _Promises(Analysis):
    def reads(self, study: Study) -> object:
        """Which muscles."""
        return study.promise


ANALYSIS = _Promises(
    name="promise",
    title="Promises",
    chapter="4 Effects",
    takes_hours=True,
    tables={"promise": None, "promise_summary": "%.4g"},
    figures=("promise",),
    page=("promise_summary",),
)
