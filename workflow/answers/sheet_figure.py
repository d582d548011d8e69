"""Force against contraction of sheets, with what was measured, and the outline of the muscle."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from workflow.answers.sheet import Sheet, measured_points
from workflow.data import bench
from workflow.figures.style import FULL, SERIES, labelled, legend, look_of, panels, percent
from workflow.study.contents import Study

FINE = 200  # points of a line


def draw(study: Study, sheets: Sequence[Sheet]) -> Figure:
    """One row: forces on the left, outlines on the right."""
    figure, axes = panels(FULL, 3.4, 1, 2, gap=(0.7, 0.3), width_ratios=[3, 2])
    force, outline = axes[0]
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
            outline.plot(place, diameter, color=color)
    force.axhline(0, color="black", linewidth=0.7)
    force.set_xlabel("contraction [%]")
    force.set_ylabel("force [N]")
    percent(force.xaxis, 0.05)
    outline.set_xlabel("distance from mid-length [mm]")
    outline.set_ylabel("outer diameter [mm]")
    if not any(sheet.outline.size for sheet in sheets):
        outline.set_title("no shape by these models")
    legend(figure, labelled(axes))
    return figure
