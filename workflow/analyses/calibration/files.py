"""A calibrated muscle as text to paste into a study file, or why there is none."""

import json
from collections.abc import Iterator, Mapping
from typing import Any

import pandas as pd

from geometry.braid import Braid
from workflow.analyses.calibration.calibrate import rounded
from workflow.analyses.calibration.forward_model import reshaped, shape_of
from workflow.study.contents import Study


def texts(study: Study, tables: Mapping[str, pd.DataFrame]) -> dict[str, str]:
    """One file for each calibration."""
    fitted = tables["calibration_values"].groupby("calibration", sort=False)
    return {
        f"{name}.yaml": text(
            study, str(name), rounded(zip(rows["parameter"], rows["fitted"], strict=True))
        )
        if rows["usable"].all()
        else no_muscle(study, str(name), rows)
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
    own += _shape(study, name, values)
    lines = [
        _head(study, name),
        "# Paste the lines below each heading under the same heading of a study file.",
    ]
    fitted = {key: value for key, value in values.items() if key in base.rubber.values()}
    if fitted:
        own += f", material: {name}"
        lines.append("materials:")
        law = "" if base.rubber.unnamed else f"law: {base.rubber.law()}, "
        found = base.rubber.values() | fitted | {"kappa": base.rubber.kappa}
        said = ", ".join(
            [f"{key}: {value:g}" for key, value in found.items()]
            + [f"{key}: {json.dumps(value)}" for key, value in _kept(study, base.material)]
        )
        lines.append(f"  {name}: {{{law}{said}}}")
    lines += ["muscles:", f"  {name}: {{{own}}}"]
    return "\n".join(lines) + "\n"


def _kept(study: Study, material: str) -> Iterator[tuple[str, Any]]:
    """What else the entry of a rubber says; not ``fitted_range``, which was of its first law."""
    given = study.source.plain["materials"][material]
    return ((key, given[key]) for key in ("stretch_limit", "density", "memory") if key in given)


def no_muscle(study: Study, name: str, rows: pd.DataFrame) -> str:
    """What is written of a fit that says nothing: why, and no muscle."""
    lines = [_head(study, name), "# No muscle to paste: the forces do not say what it is."]
    lines += [
        f"# {row.parameter}: {row.fitted:.4g} {row.unit}, 95 % from {row.low_95:.3g} to "
        f"{row.high_95:.3g}; {row.note or 'not to be had without the others'}"
        for row in rows.itertuples()
    ]
    return "\n".join(lines) + "\n"


def _head(study: Study, name: str) -> str:
    entry = study.calibration[name]
    where = "all measured points"
    if entry.fit_pressure is not None:
        where = f"{', '.join(f'{p:g}' for p in entry.fit_pressure)} MPa"
    return f"# {entry.muscle} fitted to {entry.reference} at {where} by the model {entry.model}."


def _shape(study: Study, name: str, values: Mapping[str, float]) -> str:
    """Keys of a muscle whose size was fitted; both layers move together at the same angle."""
    muscle = study.muscles[study.calibration[name].muscle].muscle
    said = f", wall_thickness: {values['wall_thickness']:g}" if "wall_thickness" in values else ""
    if "layer_radius" in values:
        braid = reshaped(muscle, {"layer_radius": values["layer_radius"]}).braid
        assert isinstance(braid, Braid)  # see workflow/study/checks.py
        depths = [(d - muscle.inner_diameter) / 2 for d in braid.layer_diameters]
        said += f", layer_depths: [{depths[0]:.9g}, {depths[1]:.9g}]"
    if {"angle", "layer_radius"} & set(values):
        said += f", angle: {values.get('angle', shape_of(muscle)['angle']):.12g}"
    return said
