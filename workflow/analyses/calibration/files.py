"""A calibrated muscle as text to paste into a study file."""

from collections.abc import Mapping

import pandas as pd

from workflow.analyses.calibration.calibrate import rounded
from workflow.study.contents import Study


def texts(study: Study, tables: Mapping[str, pd.DataFrame]) -> dict[str, str]:
    """One file for each calibration."""
    fitted = tables["calibration_values"].groupby("calibration", sort=False)
    return {
        f"{name}.yaml": text(
            study, str(name), rounded(zip(rows["parameter"], rows["fitted"], strict=True))
        )
        for name, rows in fitted
    }


def text(study: Study, name: str, values: Mapping[str, float]) -> str:
    """Entries of ``muscles:`` and, if the rubber was fitted, of ``materials:``."""
    entry = study.calibration[name]
    base = study.muscles[entry.muscle]
    own = f"base: {entry.muscle}"
    if base.reference:
        own += f", reference: [{', '.join(base.reference)}]"
    if "thread_stiffness" in values:
        own += f", thread_stiffness: {values['thread_stiffness']:g}"
    lines = [
        f"# {entry.muscle} fitted to {entry.reference} at "
        f"{', '.join(f'{p:g}' for p in entry.fit_pressure)} MPa by the model "
        f"{entry.model}.",
        "# Paste the lines below each heading under the same heading of a study file.",
    ]
    rubber = {"c10": base.rubber.c10, "c01": base.rubber.c01} | dict(values)
    if set(values) & {"c10", "c01"}:
        own += f", material: {name}"
        lines.append("materials:")
        lines.append(
            f"  {name}: {{c10: {rubber['c10']:g}, c01: {rubber['c01']:g}, "
            f"kappa: {base.rubber.kappa:g}}}"
        )
    lines += ["muscles:", f"  {name}: {{{own}}}"]
    return "\n".join(lines) + "\n"
