"""Contraction against pressure under constant loads (claim C5)."""

from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from workflow.data.scene_data import CONTRACTION, FORCE, PRESSURE, states
from workflow.figures import curves
from workflow.figures.labels import SERIES, constants, muscles, series
from workflow.figures.style import COLUMN_WIDTH, panels, percent

LOWEST = -0.12  # contraction; Eq. (1) goes far down at low pressure


def table(data: Any) -> pd.DataFrame:
    """Contraction of all states; the force is the load."""
    every = states(data, ["contraction"])
    every[SERIES] = series(every, [FORCE])
    return every


def draw(table: pd.DataFrame) -> Figure:
    """One curve per load."""
    figure, axes = panels(COLUMN_WIDTH, 3.3)
    ax = axes[0, 0]
    curves.by_series(ax, table, PRESSURE, CONTRACTION)
    ax.axhline(0, color="black", linewidth=0.7)
    ax.set_title(constants(table, ["muscle", FORCE]) or "constant loads")
    ax.set_xlabel("pressure [MPa]")
    ax.set_ylabel("contraction [%]")
    ax.set_ylim(bottom=max(ax.get_ylim()[0], LOWEST))
    percent(ax.yaxis, 0.05)
    curves.series_legend(figure, table)
    text = muscles(table)
    if (table[CONTRACTION] < LOWEST).any():
        text += f" Curves go on below {100 * LOWEST:g} %."
    curves.note_gaps(figure, table, [SERIES], PRESSURE, text.strip(), y=CONTRACTION)
    return figure
