"""A quantity against wall thickness for several rubbers: Figs. 12 and 13."""

from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from workflow.data.scene_data import CONTRACTION, FORCE, PRESSURE, WALL, describe, states
from workflow.figures import curves
from workflow.figures.labels import SERIES, constants, muscles, series
from workflow.figures.style import COLUMN_WIDTH, panels


def table(data: Any, quantity: str) -> pd.DataFrame:
    """States of all muscles, told apart by rubber and load."""
    every = describe(states(data, [quantity]), data)
    held = CONTRACTION if quantity == "force" else FORCE
    every[SERIES] = series(every, ["material", PRESSURE, held], apart=False)
    return every.sort_values([SERIES, "source", "variant", WALL], ignore_index=True)


def draw(table: pd.DataFrame, y: str, constant: str) -> tuple[Figure, Any]:
    """One curve per rubber and model; the caller labels the y axis."""
    figure, axes = panels(COLUMN_WIDTH, 3.1)
    ax = axes[0, 0]
    curves.by_series(ax, table, WALL, y, markevery=1)
    ax.set_title(constants(table, ["muscle", PRESSURE, constant]))
    ax.set_xlabel("wall thickness [mm]")
    ax.set_xticks(sorted(table[WALL].unique()))
    ax.set_ylim(bottom=min(0, ax.get_ylim()[0]))
    curves.series_legend(figure, table)
    curves.note_gaps(figure, table, [SERIES], WALL, muscles(table), y=y)
    return figure, ax
