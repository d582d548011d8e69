"""Force against contraction at constant pressures, with both reference maps (claim C1).

Above the force, below its deviation from the manufacturer's map, where that is large enough for a
ratio to mean something.
"""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from workflow.data import reference
from workflow.data.states import CONTRACTION, FORCE, PRESSURE, SUSPECT, reference_curves, states
from workflow.figures import curves
from workflow.figures.style import FULL, SOFT, SOURCES, labelled, legend, panels, percent

MAP = "festo_musclesim"
DEVIATION = "deviation from Festo MuscleSIM [1]"
PAPER_DEVIATION = -0.099  # mean of its FE model


def table(data: Any) -> pd.DataFrame:
    """States of all models and the curves of both maps, with their deviation from one of them."""
    maps = reference.load()
    scene = data.scene
    measured = reference_curves(maps.values(), scene.held, scene.swept)
    every = pd.concat([states(data, ["force"]), measured], ignore_index=True)
    every[DEVIATION] = np.nan
    compared = every[(every["source"] != MAP) & every[FORCE].notna()]
    for pressure, rows in compared.groupby(PRESSURE):
        every.loc[rows.index, DEVIATION] = reference.relative_deviation(
            maps[MAP], rows[CONTRACTION], pressure, rows[FORCE]
        )
    return every


def draw(table: pd.DataFrame) -> Figure:
    """One column per pressure."""
    pressures = sorted(table[PRESSURE].unique())
    figure, axes = panels(
        FULL,
        4.4,
        2,
        len(pressures),
        sharex=True,
        sharey="row",
        gap=(0.18, 0.2),
        height_ratios=(2.2, 1),
    )
    for (above, below), pressure in zip(axes.T, pressures, strict=True):
        here = table[table[PRESSURE] == pressure]
        curves.by_source(above, here, CONTRACTION, FORCE)
        curves.by_source(below, here, CONTRACTION, DEVIATION)
        suspect = here[here["status"] == SUSPECT]
        if len(suspect):
            style = {"color": SOURCES[MAP]["color"], "label": "MuscleSIM, suspect: not used"}
            above.plot(suspect[CONTRACTION], suspect[FORCE], "x", **style)
        for ax in (above, below):
            ax.axhline(0, color="black", linewidth=0.7)
        style = {"color": SOFT, "linewidth": 1.0, "linestyle": ":"}
        below.axhline(PAPER_DEVIATION, label="the paper's mean, −9.9 %", **style)
        above.set_title(f"{pressure:g} MPa")
        below.set_xlabel("contraction [%]")
        percent(below.xaxis, 0.05)
        percent(below.yaxis)
    axes[0, 0].set_ylabel("force [N]")
    axes[1, 0].set_ylabel("deviation from\nMuscleSIM [%]")
    axes[1, 0].set_ylim(-0.6, 1.0)
    legend(figure, labelled(axes))
    text = "Deviations are shown where MuscleSIM's force is over a tenth of its curve's largest."
    curves.note_gaps(figure, table, [PRESSURE], CONTRACTION, text)
    return figure
