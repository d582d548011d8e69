"""Initial, inflated and equivalent diameter against pressure at constant contraction (claim C4).

The equivalent diameter is that of a cylinder whose piston pulls with the same force; it is shown
where the muscle pulls. Beside it, by how much it exceeds the inflated diameter.
"""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from workflow.data import paper
from workflow.data.scene_data import (
    COLUMN,
    CONTRACTION,
    DIAMETER,
    FLAGS,
    FORCE,
    PRESSURE,
    STRETCH,
    describe,
    error_of,
    states,
)
from workflow.figures import curves
from workflow.figures.labels import SERIES, constants, series
from workflow.figures.style import FULL, SOFT, panels, percent

INITIAL = "initial_inner_diameter [mm]"
INFLATED, EQUIVALENT = COLUMN["inner_diameter_inflated"], COLUMN["equivalent_diameter"]
ERROR = error_of(INFLATED)
EXCESS = "equivalent / inflated - 1 [1]"
NAMES = {EQUIVALENT: "equivalent", INFLATED: "inflated"}
STATE = ["source", "muscle", "variant", "point", CONTRACTION, PRESSURE, STRETCH, "status", FLAGS]
PAPER = "the paper's mean excess [1]"


def table(data: Any) -> pd.DataFrame:
    """Diameters of all states; the equivalent one where the muscle pulls."""
    every = states(data, ["force", "inner_diameter_inflated", "equivalent_diameter"])
    every[INITIAL] = describe(every, data)[DIAMETER]
    every[EQUIVALENT] = every[EQUIVALENT].where(every[FORCE] > 0)
    every[EXCESS] = every[EQUIVALENT] / every[INFLATED] - 1
    every[SERIES] = series(every, ["muscle", CONTRACTION])
    normal = [name for name, muscle in data.studied.items() if paper.is_normal(muscle)]
    stated = every["muscle"].isin(normal) & np.isclose(every[CONTRACTION], paper.AT_CONTRACTION)
    every[PAPER] = np.where(stated, paper.EXCESS, np.nan)
    return every[[*STATE, SERIES, INITIAL, *NAMES, ERROR, EXCESS, PAPER]]


def draw(table: pd.DataFrame) -> Figure:
    """Diameters, and the excess of the equivalent one."""
    figure, axes = panels(FULL, 3.2, 1, 2, gap=(0.75, 0), sharex=True)
    left, right = axes[0]
    melted = table.melt([*STATE, SERIES, ERROR], list(NAMES), "quantity", "diameter [mm]")
    error = melted[ERROR].where(melted["quantity"] == INFLATED)
    melted[error_of("diameter [mm]")] = error
    quantity = melted["quantity"].map(NAMES)
    several = table[SERIES].nunique() > 1
    melted[SERIES] = quantity + ", " + melted[SERIES] if several else quantity
    curves.by_series(left, melted, PRESSURE, "diameter [mm]")
    low, high = left.get_ylim()
    for initial in table[INITIAL].unique():
        left.axhline(initial, color="black", linewidth=1.0, linestyle=(0, (5, 2)))
        near = initial - low < 0.1 * (high - low)  # the axis: no room below
        side = {"ha": "right", "va": "bottom" if near else "top"}
        place = (left.get_xlim()[1], initial), (-4, 3 if near else -4)
        left.annotate("initial", *place, textcoords="offset points", **side)
    curves.by_series(right, table, PRESSURE, EXCESS)
    for mean in table[PAPER].dropna().unique():
        right.axhline(mean, color=SOFT, linewidth=1.0, linestyle=":")
        text = f"the paper's mean, {100 * mean:.1f} %"
        right.annotate(text, (0.0, mean), (0, 3), textcoords="offset points")
    right.axhline(0, color="black", linewidth=0.7)
    left.set_title(constants(table, ["muscle", CONTRACTION]))
    left.set_ylabel("diameter [mm]")
    right.set_ylabel("equivalent over inflated − 1 [%]")
    percent(right.yaxis)
    for ax in (left, right):
        ax.set_xlabel("pressure [MPa]")
    curves.series_legend(figure, melted)
    told_apart = [SERIES] if several else [CONTRACTION]
    text = "The equivalent diameter is shown where the muscle pulls."
    curves.note_gaps(figure, table, told_apart, PRESSURE, text, y=INFLATED)
    return figure
