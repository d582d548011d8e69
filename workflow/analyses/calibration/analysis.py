"""What calibrations are and write; their cases are those that a fit tries."""

from workflow.analyses.analysis import Analysis
from workflow.study.contents import Study
from workflow.study.schema import FORCE_MAPS


class Calibrations(Analysis):
    """All calibrations of a study file."""

    def fits(self, study: Study) -> bool:
        """Whether the study asks for any."""
        return bool(study.calibration)

    def inputs(self, study: Study) -> list[str]:
        """Forces that the user has measured."""
        named = {str(entry.reference) for entry in study.calibration.values()}
        return sorted(named.difference(FORCE_MAPS))

    def files(self, study: Study) -> list[str]:
        """A muscle of each, to paste into a study file."""
        return [f"{name}.yaml" for name in study.calibration]

    def reads(self, study: Study) -> object:
        """The calibrations, their muscles, and the variant by which they are computed."""
        muscles = {entry.muscle for entry in study.calibration.values()}
        made_of = [(name, study.muscles[name]) for name in sorted(muscles)]
        return sorted(study.calibration.items()), made_of, study.variants["default"]


ANALYSIS = Calibrations(
    name="calibration",
    title="Calibration",
    chapter="2 The verdict",
    target="calibrate",
    tables={
        "calibration": "%.6g",
        "calibration_values": "%.6g",
        "calibration_states": "%.6g",
        "calibration_residuals": "%.6g",
    },
    figures=("calibration", "calibration_residuals"),
    page=("calibration_values", "calibration"),
)
