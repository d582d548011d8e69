"""One figure: the numbers of its table, then the drawing of the table."""

import importlib
from pathlib import Path

from geometry.files import atomic_write
from workflow.data.scene_data import SceneData
from workflow.plan.plan import Plan
from workflow.study import figure_needs
from workflow.study.errors import StudyError, choices


def make(plan: Plan, scene: str, output: Path, *, partial: bool = False) -> None:
    """Draw a scene as PNG and SVG and write its table as CSV, each whole or not at all.

    If ``partial``, of the records that there are, and the picture says how many are not.

    Raises
    ------
    StudyError
        If there is no such scene or figure, or a record is missing or damaged.
    """
    if scene not in plan.study.scenes:
        raise StudyError(f"{scene}: no such scene; there are {choices(scene, plan.study.scenes)}")
    name = figure_needs.module(scene, plan.study.scenes[scene])
    if not name:
        raise StudyError(f"{scene}: no figure; it would be workflow/figures/{scene}.py")
    data = SceneData.read(plan, scene, partial=partial)
    module = importlib.import_module(f"workflow.figures.{name}")
    from workflow.figures import style

    table = module.table(data)
    with atomic_write(output.with_suffix(".csv")) as beside:
        table.to_csv(beside, index=False)
    figure = module.draw(table)
    if data.missing:
        unfinished = f"UNFINISHED: {data.missing} of {len(data.curves)} curves are not solved yet"
        figure.text(0.5, 0.995, unfinished, ha="center", va="top", size=7, color="#d55e00")
    for suffix in (".svg", ".png"):
        style.save(figure, output.with_suffix(suffix))
