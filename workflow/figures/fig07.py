"""Initial, inflated and equivalent diameter against pressure at constant contraction (claim C4).

The equivalent diameter is that of a cylinder whose piston pulls with the same force; it is shown
where the muscle pulls. Beside it, by how much it exceeds the inflated diameter.
"""

from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from workflow.data.states import (
    COLUMN,
    CONTRACTION,
    DIAMETER,
    FORCE,
    PRESSURE,
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
STATE = ["source", "muscle", "variant", "point", CONTRACTION, PRESSURE, "status"]
CORNER = {"ha": "right", "va": "top"}
PAPER_EXCESS = 0.156  # on average above the threshold pressure


def table(data: Any) -> pd.DataFrame:
    """Diameters of all states; the equivalent one where the muscle pulls."""
    every = states(data, ["force", "inner_diameter_inflated", "equivalent_diameter"])
    every[INITIAL] = describe(every, data)[DIAMETER]
    every[EQUIVALENT] = every[EQUIVALENT].where(every[FORCE] > 0)
    every[EXCESS] = every[EQUIVALENT] / every[INFLATED] - 1
    every[SERIES] = series(every, ["muscle", CONTRACTION])
    return every[[*STATE, SERIES, INITIAL, *NAMES, ERROR, EXCESS]]


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
    for initial in table[INITIAL].unique():
        left.axhline(initial, color="black", linewidth=1.0, linestyle=(0, (5, 2)))
        end = left.get_xlim()[1]
        left.annotate("initial", (end, initial), (-4, -4), textcoords="offset points", **CORNER)
    curves.by_series(right, table, PRESSURE, EXCESS)
    right.axhline(PAPER_EXCESS, color=SOFT, linewidth=1.0, linestyle=":")
    right.annotate(
        "the paper's mean, 15.6 %", (0.0, PAPER_EXCESS), (0, 3), textcoords="offset points"
    )
    right.axhline(0, color="black", linewidth=0.7)
    left.set_title(constants(table, [CONTRACTION]))
    left.set_ylabel("diameter [mm]")
    right.set_ylabel("equivalent over inflated − 1 [%]")
    percent(right.yaxis)
    for ax in (left, right):
        ax.set_xlabel("pressure [MPa]")
    curves.series_legend(figure, melted)
    curves.note_gaps(figure, table, [CONTRACTION], PRESSURE)
    return figure
