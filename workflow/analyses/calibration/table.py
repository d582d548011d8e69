"""Tables of all calibrations: deviations, fitted values, the forces behind them, residuals."""

from collections.abc import Sequence

import pandas as pd

from workflow.analyses.analysis import Solved
from workflow.analyses.calibration import calibrate
from workflow.data import bench
from workflow.study.contents import Study
from workflow.study.errors import StudyError


def tables(study: Study, solved: Sequence[Solved]) -> dict[str, pd.DataFrame]:
    """Fit everything.

    Raises
    ------
    StudyError
        If the study file asks for no calibration, or one of them cannot be made.
    """
    if not study.calibration:
        raise StudyError(f"{study.source.path}: calibration is missing; see config/README.md")
    for error in bench.refused(study):
        raise error
    found = [calibrate.calibrate(study, name) for name in study.calibration]
    states = [
        each.states.assign(calibration=each.name, fitted_by=each.entry.model) for each in found
    ]
    residuals = [each.residuals.assign(calibration=each.name) for each in found]
    return {
        "calibration": pd.concat([each.deviations for each in found]),
        "calibration_values": pd.concat([calibrate.values(each, study) for each in found]),
        "calibration_states": pd.concat(states),
        "calibration_residuals": pd.concat(residuals),
    }
