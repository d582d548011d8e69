"""What the comparison with measured muscles is and writes; its cases are those that fits try."""

from workflow.analyses.analysis import Analysis
from workflow.data import paper
from workflow.study.contents import Study
from workflow.study.study import load_library


class Validation(Analysis):
    """Of the muscles of the library, whatever the study."""

    def fits(self, study: Study) -> bool:
        """Whether the study is about the muscle that most was measured on: for its report."""
        return any(paper.is_normal(made) for made in study.muscles.values())

    def reads(self, study: Study) -> object:
        """The muscles of the library that somebody has measured."""
        found = load_library().muscles
        return [(name, made) for name, made in found.items() if made.reference]


ANALYSIS = Validation(
    name="validate",
    title="What measured muscles say",
    chapter="2 The verdict",
    tables={"validate": "%.4g", "validate_fits": "%.4g"},
    page=("validate_fits", "validate"),
)
