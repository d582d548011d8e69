"""The sheets of a scene or of one muscle as files: JSON, table, picture."""

import json
from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from geometry.files import atomic_write
from workflow.answers import sheet_figure
from workflow.answers.sheet import Sheet, as_dict, sheet
from workflow.data import records
from workflow.figures import style
from workflow.plan.plan import Plan
from workflow.study.contents import Study
from workflow.study.errors import StudyError, choices
from workflow.study.schema import SHEET


def of_scene(plan: Plan, scene: str) -> list[Sheet]:
    """The sheets of a scene, of all its curves.

    Raises
    ------
    StudyError
        If the scene asks for none, or a record is missing or damaged.
    """
    asking = [name for name, asked in plan.study.scenes.items() if SHEET in asked.quantities]
    if scene not in asking:
        allowed = choices(scene, asking)
        raise StudyError(f"{scene}: no scene with quantities: [{SHEET}]\n  allowed: {allowed}")
    load = next(iter(plan.study.scenes[scene].load or ()), None)
    found = []
    for place, key in plan.scenes[scene].items():
        case, solution = records.read_one(key, plan.cases[key].label)
        studied = plan.study.muscles[place.muscle]
        found.append(sheet(studied, place.muscle, place.variant, case, solution, load))
    return found


def table(sheets: Sequence[Sheet]) -> pd.DataFrame:
    """One row per quantity, one column per sheet with its value; units and notes of the first."""
    frames = []
    for found in sheets:
        named = f"{found.muscle} {found.pressure:g} MPa {found.model}"
        column = named if found.variant == "default" else f"{named} {found.variant}"
        rows = {(row.name, row.unit): row.value for row in found.rows}
        frames.append(pd.Series(rows, name=column))
    notes = {(r.name, r.unit): r.note for found in reversed(sheets) for r in found.rows}
    order = {(r.name, r.unit): None for found in sheets for r in found.rows}
    joined = pd.concat(frames, axis=1).reindex(list(order))
    joined.index = pd.MultiIndex.from_tuples(list(order), names=["quantity", "unit"])
    return joined.assign(note=[notes[key] for key in order]).reset_index()


def write(study: Study, sheets: Sequence[Sheet], output: Path) -> None:
    """Write ``output`` with the endings .json, .csv, .png and .svg, each whole or not at all."""
    with atomic_write(output.with_suffix(".json")) as beside:
        beside.write_text(json.dumps([as_dict(found) for found in sheets], indent=1) + "\n")
    with atomic_write(output.with_suffix(".csv")) as beside:
        table(sheets).to_csv(beside, index=False)
    figure = sheet_figure.draw(study, sheets)
    for suffix in (".svg", ".png"):
        style.save(figure, output.with_suffix(suffix))
