"""Force against pressure at constant contraction, with the threshold pressure (claim C3)."""

from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from workflow.data import reference
from workflow.data.states import CONTRACTION, FORCE, GOOD, PRESSURE, reference_at, states
from workflow.figures import curves
from workflow.figures.labels import constants
from workflow.figures.style import COLUMN_WIDTH, SOFT, SOURCES, labelled, legend, panels

PAPER_THRESHOLD = 0.15  # MPa


def table(data: Any) -> pd.DataFrame:
    """States of all models, that of zero force among them, and both maps."""
    maps = reference.load().values()
    measured = [reference_at(maps, held, data.scene.swept) for held in data.scene.held]
    return pd.concat([states(data, ["force"]), *measured], ignore_index=True)


def draw(table: pd.DataFrame) -> Figure:
    """One panel per contraction."""
    contractions = sorted(table[CONTRACTION].unique())
    count = len(contractions)
    figure, axes = panels(COLUMN_WIDTH * count, 3.4, 1, count, sharey=True)
    for ax, contraction in zip(axes.flat, contractions, strict=True):
        here = table[table[CONTRACTION] == contraction]
        curves.by_source(ax, here, PRESSURE, FORCE)
        ax.axhline(0, color="black", linewidth=0.7)
        ax.axvline(PAPER_THRESHOLD, color=SOFT, linewidth=1.0, linestyle=":")
        _mark_thresholds(ax, here[(here["point"] == "zero force") & (here["status"] == GOOD)])
        ax.set_title(constants(here, [CONTRACTION]))
        ax.set_xlabel("pressure [MPa]")
    axes[0, 0].set_ylabel("force [N]")
    legend(figure, labelled(axes))
    curves.note_gaps(figure, table, [CONTRACTION], PRESSURE)
    return figure


def _mark_thresholds(ax: Any, rows: pd.DataFrame) -> None:
    """Threshold pressures on the axis of zero force, written beside each other."""
    lines = [f"threshold in the paper {PAPER_THRESHOLD:g} MPa"]
    for source, pressure in zip(rows["source"], rows[PRESSURE], strict=True):
        style = SOURCES[source]
        ax.plot(pressure, 0, "D", color=style["color"], markersize=5, zorder=3, label="_threshold")
        lines.append(f"{style['label']} {pressure:.4f} MPa")
    ax.annotate(
        "\n".join(lines),
        (PAPER_THRESHOLD, 0),
        (0.97, 0.03),
        textcoords="axes fraction",
        ha="right",
        va="bottom",
        fontsize=7.5,
        arrowprops={"arrowstyle": "-", "color": SOFT, "linewidth": 0.7, "shrinkB": 4},
    )
