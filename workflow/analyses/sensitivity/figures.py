"""The sensitivities: local ones by two models above, shares of variance below."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from workflow.analyses import undrawn
from workflow.analyses.analysis import Solved
from workflow.figures import curves
from workflow.figures.style import FULL, SERIES, SOFT, grid, labelled, legend, percent

OUTPUTS = {
    "force": "force",
    "threshold_pressure": "threshold pressure",
    "free_contraction": "free contraction",
}
INPUTS = {
    "contraction": "contraction",
    "pressure": "pressure",
    "inner_diameter": "inner diameter",
    "wall_thickness": "wall thickness",
    "lead": "lead",
    "inner_layer": "radius of inner layer",
    "outer_layer": "radius of outer layer",
    "thread_stiffness": "thread stiffness EA",
    "c10": "C10",
    "c01": "C01",
    "nbr": "silicone to NBR",
}
BAR = 0.19  # inch


def draw(solved: Sequence[Solved], tables: Mapping[str, pd.DataFrame]) -> dict[str, Figure]:
    """The one figure."""
    return {"sensitivity": overview(tables["sensitivity"])}


def overview(table: pd.DataFrame) -> Figure:
    """One column per output, one row per analysis."""
    analyses = list(table["analysis"].unique())
    counts = [table[table["analysis"] == a]["input"].nunique() for a in analyses]
    width, label = FULL, 1.5
    heights = [BAR * count for count in counts]
    gap = (0.3, 0.68)
    figure, places = grid(
        width,
        sum(heights) + gap[1] * (len(analyses) - 1) + 0.9,
        len(analyses),
        3,
        gap=gap,
        height_ratios=heights,
    )
    figure.subplots_adjust(left=label / width)
    axes = places.subplots(squeeze=False)
    for row, analysis in zip(axes, analyses, strict=True):
        rows = table[table["analysis"] == analysis]
        names = list(rows["input"].unique())[::-1]
        for ax, (output, title) in zip(row, OUTPUTS.items(), strict=True):
            here = rows[rows["output"] == output]
            (_elasticities if analysis == "local" else _shares)(ax, here, names)
            ax.set_yticks(range(len(names)), [INPUTS[n] for n in names] if ax is row[0] else [])
            ax.set_ylim(-0.6, len(names) - 0.4)
            ax.grid(axis="y", visible=False)
            ax.set_title(title)
    axes[0, 1].set_xlabel("percent per percent of the input, at the normal condition (dmsp20)")
    for ax, analysis in zip(axes[1:, 1], analyses[1:], strict=True):
        ax.set_xlabel(f"share of the variance [%], {analysis}")
    legend(figure, labelled(axes))
    curves.note(figure, undrawn.sentence(_missing(table)))
    return figure


def _missing(table: pd.DataFrame) -> list[str]:
    """Bars and marks without a value."""
    named = table.assign(
        input=table["input"].map(INPUTS), output=table["output"].map(OUTPUTS), of="on"
    )
    local = named[named["analysis"] == "local"]
    found = undrawn.without_value(local, "percent per percent", ["model", "input", "of", "output"])
    shares = named[named["analysis"] != "local"]
    for column in ("first", "total"):
        if column in shares:
            by = ["analysis", "input", "of", "output"]
            found += undrawn.without_value(shares, column, by)
    return found


def _elasticities(ax: Any, rows: pd.DataFrame, names: list[str]) -> None:
    value = rows.pivot_table(index="input", columns="model", values="percent per percent")
    value = value.reindex(names)
    ax.barh(range(len(names)), value["cylinder"], 0.6, color=SERIES[0]["color"], label="cylinder")
    if "solid" in value:
        ax.plot(value["solid"], range(len(names)), "k|", markersize=9, label="FE solid")
    ax.axvline(0, color="black", linewidth=0.7)


def _shares(ax: Any, rows: pd.DataFrame, names: list[str]) -> None:
    rows = rows.set_index("input").reindex(names)
    places = range(len(names))
    error = {"ecolor": SOFT, "error_kw": {"linewidth": 0.8}}
    error |= {"xerr": rows["total_95"], "label": "variance, with others"}
    ax.barh(places, rows["total"], 0.7, color="0.82", **error)
    ax.barh(places, rows["first"], 0.35, color=SERIES[1]["color"], label="variance, alone")
    ends = np.nan_to_num(rows[["first", "total"]].to_numpy(dtype=float))
    ax.set_xlim(min(0.0, 1.05 * ends.min()), max(1.0, 1.05 * ends.max()))
    percent(ax.xaxis, 0.5)
