"""Force against contraction of several muscles: Figs. 9 and 10."""

from collections.abc import Sequence
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from workflow.data.scene_data import CONTRACTION, FORCE, PRESSURE, describe, states
from workflow.figures import curves
from workflow.figures.labels import SERIES, constants, muscles, series
from workflow.figures.style import COLUMN_WIDTH, panels, percent


def table(data: Any, compared: Sequence[str]) -> pd.DataFrame:
    """States of all muscles, told apart by the columns ``compared``."""
    every = describe(states(data, ["force"]), data)
    every[SERIES] = series(every, [*compared, PRESSURE])
    return every


def draw(table: pd.DataFrame) -> Figure:
    """One curve per muscle and model."""
    figure, axes = panels(COLUMN_WIDTH, 3.4)
    ax = axes[0, 0]
    curves.by_series(ax, table, CONTRACTION, FORCE)
    ax.axhline(0, color="black", linewidth=0.7)
    ax.set_title(constants(table, ["muscle", PRESSURE]))
    ax.set_xlabel("contraction [%]")
    ax.set_ylabel("force [N]")
    percent(ax.xaxis, 0.05)
    curves.series_legend(figure, table)
    curves.note_gaps(figure, table, [SERIES], CONTRACTION, muscles(table), y=FORCE)
    return figure
