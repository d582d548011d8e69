"""A calibrated muscle as text to paste into a study file."""

from workflow.analyses.calibration.calibrate import Calibration
from workflow.study.contents import Study


def text(result: Calibration, study: Study) -> str:
    """Entries of ``muscles:`` and, if the rubber was fitted, of ``materials:``."""
    values = result.values
    base = study.muscles[result.entry.muscle]
    own = f"base: {result.entry.muscle}"
    if base.reference:
        own += f", reference: [{', '.join(base.reference)}]"
    if "thread_stiffness" in values:
        own += f", thread_stiffness: {values['thread_stiffness']:g}"
    lines = [
        f"# {result.entry.muscle} fitted to {result.entry.reference} at "
        f"{', '.join(f'{p:g}' for p in result.entry.fit_pressure)} MPa by the model "
        f"{result.entry.model}.",
        "# Paste the lines below each heading under the same heading of a study file.",
    ]
    rubber = {"c10": base.rubber.c10, "c01": base.rubber.c01} | values
    if set(values) & {"c10", "c01"}:
        own += f", material: {result.name}"
        lines.append("materials:")
        lines.append(
            f"  {result.name}: {{c10: {rubber['c10']:g}, c01: {rubber['c01']:g}, "
            f"kappa: {base.rubber.kappa:g}}}"
        )
    lines += ["muscles:", f"  {result.name}: {{{own}}}"]
    return "\n".join(lines) + "\n"
