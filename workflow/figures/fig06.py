"""Force against pressure at constant contraction, with the threshold pressure (claim C3)."""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from workflow.data import bench, paper
from workflow.data.scene_data import CONTRACTION, FORCE, PRESSURE, reference_at, states
from workflow.data.states import GOOD
from workflow.figures import curves
from workflow.figures.labels import constants, shown
from workflow.figures.style import COLUMN_WIDTH, SOFT, look_of, panels

PAPER = "the paper's threshold [MPa]"


def table(data: Any) -> pd.DataFrame:
    """States of all models, that of zero force among them, and the muscle's force maps."""
    frames = [states(data, ["force"])]
    maps = bench.of_muscles(data.studied)
    for muscle, own in maps.items():
        for held in data.scene.held:
            measured = reference_at(own.values(), held, data.scene.swept)
            frames.append(measured.assign(muscle=muscle))
    every = pd.concat(frames, ignore_index=True)
    normal = [name for name, muscle in data.studied.items() if paper.is_normal(muscle)]
    stated = every["muscle"].isin(normal) & np.isclose(every[CONTRACTION], paper.AT_CONTRACTION)
    every[PAPER] = np.where(stated, paper.THRESHOLD, np.nan)
    return every


def draw(table: pd.DataFrame) -> Figure:
    """One panel per contraction."""
    contractions = sorted(table[CONTRACTION].unique())
    count = len(contractions)
    figure, axes = panels(COLUMN_WIDTH * count, 3.4, 1, count, sharey=True)
    for ax, contraction in zip(axes.flat, contractions, strict=True):
        here = table[table[CONTRACTION] == contraction]
        curves.by_source(ax, here, PRESSURE, FORCE)
        ax.axhline(0, color="black", linewidth=0.7)
        for pressure in here[PAPER].dropna().unique():
            style = {"color": SOFT, "linewidth": 1.0, "linestyle": ":"}
            ax.axvline(pressure, label=f"the paper's {pressure:g}", **style)
        for _, row in _thresholds(here).iterrows():
            look = {"color": look_of(row["source"])["color"], "markersize": 5, "zorder": 3}
            ax.plot(row[PRESSURE], 0, "D", label="_threshold", **look)
        ax.set_title(constants(here, ["muscle", CONTRACTION]))
        ax.set_xlabel("pressure [MPa]")
    axes[0, 0].set_ylabel("force [N]")
    curves.source_legend(figure, axes)
    told_apart = [name for name in ("muscle", CONTRACTION) if table[name].nunique() > 1]
    text = _said(_thresholds(table), told_apart)
    if table[PAPER].notna().any():
        text += f" Dotted: the threshold pressure in the paper, {paper.THRESHOLD:g} MPa."
    curves.note_gaps(figure, table, told_apart or [CONTRACTION], PRESSURE, text.strip(), y=FORCE)
    return figure


def _thresholds(table: pd.DataFrame) -> pd.DataFrame:
    return table[(table["point"] == "zero force") & (table["status"] == GOOD)]


def _said(thresholds: pd.DataFrame, told_apart: list[str]) -> str:
    """The threshold pressures in words."""
    if thresholds.empty:
        return ""
    columns = told_apart + (["variant"] if thresholds["variant"].nunique() > 1 else [])
    each = [
        ", ".join([look_of(row["source"])["label"], *(shown(c, row[c]) for c in columns)])
        + f" {row[PRESSURE]:.4g} MPa"
        for _, row in thresholds.iterrows()
    ]
    return f"Diamonds are threshold pressures: {'; '.join(each)}."
