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
    fitted = {key: value for key, value in values.items() if key in base.rubber.values()}
    if fitted:
        own += f", material: {name}"
        lines.append("materials:")
        law = "" if base.rubber.unnamed else f"law: {base.rubber.law()}, "
        found = base.rubber.values() | fitted | {"kappa": base.rubber.kappa}
        said = ", ".join(f"{key}: {value:g}" for key, value in found.items())
        lines.append(f"  {name}: {{{law}{said}}}")
    lines += ["muscles:", f"  {name}: {{{own}}}"]
    return "\n".join(lines) + "\n"
