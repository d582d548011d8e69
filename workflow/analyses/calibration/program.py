"""All calibrations of a study file: tables, one figure, and muscles to paste."""

from pathlib import Path

import pandas as pd

from geometry.files import atomic_write
from workflow.analyses.calibration import calibrate, snippet
from workflow.analyses.calibration import figures as drawing
from workflow.figures import style
from workflow.study.errors import StudyError
from workflow.study.study import load


def run(study_file: Path, tables: Path, figures: Path, muscles: Path) -> None:
    """Fit everything and write everything, each file whole or not at all.

    Raises
    ------
    StudyError
        If the study file asks for no calibration, or one of them cannot be made.
    """
    study = load(study_file)
    if not study.calibration:
        raise StudyError(f"{study_file}: calibration is missing; see config/README.md")
    found = {name: calibrate.calibrate(study, name) for name in study.calibration}
    written = {
        "calibration": pd.concat([each.deviations for each in found.values()]),
        "calibration_values": pd.concat([calibrate.values(e, study) for e in found.values()]),
    }
    for name, table in written.items():
        with atomic_write(tables / f"{name}.csv") as beside:
            table.to_csv(beside, index=False, float_format="%.6g")
    for name, each in found.items():
        with atomic_write(muscles / f"{name}.yaml") as beside:
            beside.write_text(snippet.text(each, study), encoding="utf-8")
    models = {name: each.entry.model for name, each in found.items()}
    drawn = drawing.draw({name: each.states for name, each in found.items()}, models)
    for suffix in (".svg", ".png"):
        style.save(drawn, (figures / "calibration").with_suffix(suffix))
