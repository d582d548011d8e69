"""Force against contraction of sheets, with what was measured, and the outline of the muscle."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from workflow.answers.sheet import Sheet, measured_points
from workflow.data import bench
from workflow.figures.style import (
    COLUMN_WIDTH,
    FULL,
    SERIES,
    labelled,
    legend,
    look_of,
    panels,
    percent,
)
from workflow.study.contents import Study

FINE = 200  # points of a line


def draw(study: Study, sheets: Sequence[Sheet]) -> Figure:
    """One row: forces on the left, outlines on the right if a model has some."""
    shaped = any(sheet.outline.size for sheet in sheets)
    if shaped:
        figure, axes = panels(FULL, 3.4, 1, 2, gap=(0.7, 0.3), width_ratios=[3, 2])
    else:
        figure, axes = panels(COLUMN_WIDTH, 3.4)
    force = axes[0, 0]
    for number, sheet in enumerate(sheets):
        style = SERIES[number % len(SERIES)]
        color = style["color"]
        contraction = np.linspace(0, sheet.curve.contraction[-1], FINE)
        label = f"{sheet.muscle}, {sheet.pressure:g} MPa, {sheet.model}"
        force.plot(contraction, sheet.curve.force(contraction), color=color, label=label)
        for name, found in bench.of_muscle(study.muscles[sheet.muscle]).items():
            points = measured_points(found, sheet.pressure)
            look = look_of(name)
            force.plot(
                *points.T, color=color, linestyle="none", marker=look.get("marker", "x"),
                markerfacecolor="none", label=look["label"],
            )  # fmt: skip
        at = sheet.curve.contraction_of(sheet.load)
        if np.isfinite(at):
            force.plot([at], [sheet.load], marker="D", color=color, markersize=5)
        if sheet.outline.size:
            place, diameter = sheet.outline.T
            axes[0, 1].plot(place, diameter, color=color)
    force.axhline(0, color="black", linewidth=0.7)
    force.set_xlabel("contraction [%]")
    force.set_ylabel("force [N]")
    percent(force.xaxis, 0.05)
    if shaped:
        axes[0, 1].set_xlabel("distance from mid-length [mm]")
        axes[0, 1].set_ylabel("outer diameter [mm]")
    legend(figure, labelled(axes))
    return figure
