"""Force against contraction at constant pressures, with the muscle's force maps (claim C1).

Where the manufacturer's map is of the muscle, below the force stands its deviation from that, as
far as that is large enough for a ratio to mean something.
"""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from workflow.data import bench, paper, reference
from workflow.data.scene_data import CONTRACTION, FORCE, PRESSURE, SUSPECT, reference_curves, states
from workflow.figures import curves
from workflow.figures.labels import constants
from workflow.figures.style import FULL, SOFT, look_of, panels, percent

MAP = "festo_musclesim"
DEVIATION = "deviation from Festo MuscleSIM [1]"
PAPER = "the paper's mean deviation [1]"
SHOWN = (-0.6, 1.0)  # deviations


def table(data: Any) -> pd.DataFrame:
    """States of all models and the curves of the maps, with the deviation from one of them."""
    scene, frames = data.scene, [states(data, ["force"])]
    maps = bench.of_muscles(data.studied)
    for muscle, own in maps.items():
        measured = reference_curves(own.values(), scene.held, scene.swept)
        frames.append(measured.assign(muscle=muscle))
    every = pd.concat(frames, ignore_index=True)
    every[DEVIATION] = np.nan
    compared = every[(every["source"] != MAP) & every[FORCE].notna()]
    for (muscle, pressure), rows in compared.groupby(["muscle", PRESSURE]):
        if MAP in maps.get(muscle, ()):
            every.loc[rows.index, DEVIATION] = reference.relative_deviation(
                maps[muscle][MAP], rows[CONTRACTION], pressure, rows[FORCE]
            )
    normal = [name for name, muscle in data.studied.items() if paper.is_normal(muscle)]
    every[PAPER] = np.where(every["muscle"].isin(normal), paper.MEAN_DEVIATION, np.nan)
    return every


def draw(table: pd.DataFrame) -> Figure:
    """One column per pressure."""
    pressures = sorted(table[PRESSURE].unique())
    deviating = table[DEVIATION].notna().any()
    figure, axes = panels(
        FULL,
        4.4 if deviating else 3.2,
        2 if deviating else 1,
        len(pressures),
        sharex=True,
        sharey="row",
        gap=(0.18, 0.2),
        height_ratios=(2.2, 1) if deviating else (1,),
    )
    for column, pressure in zip(axes.T, pressures, strict=True):
        here = table[table[PRESSURE] == pressure]
        _forces(column[0], here)
        if deviating:
            _deviations(column[1], here)
        column[-1].set_xlabel("contraction [%]")
        percent(column[-1].xaxis, 0.05)
    axes[0, 0].set_ylabel("force [N]")
    text = ""
    if deviating:
        axes[1, 0].set_ylabel("deviation from\nMuscleSIM [%]")
        axes[1, 0].set_ylim(*SHOWN)
        text = "Deviations are shown where MuscleSIM's force is over a tenth of its largest."
        if not table[DEVIATION].dropna().between(*SHOWN).all():
            text += f" They are cut off at −{-100 * SHOWN[0]:.0f} and {100 * SHOWN[1]:.0f} %."
    curves.source_legend(figure, axes)
    curves.note_gaps(figure, table, _told_apart(table), CONTRACTION, text, y=FORCE)
    return figure


def _told_apart(table: pd.DataFrame) -> list[str]:
    return ["muscle", PRESSURE] if table["muscle"].nunique() > 1 else [PRESSURE]


def _forces(ax: Any, here: pd.DataFrame) -> None:
    curves.by_source(ax, here, CONTRACTION, FORCE)
    suspect = here[here["status"] == SUSPECT]
    if len(suspect):
        style = {"color": look_of(MAP)["color"], "label": "MuscleSIM, suspect: not used"}
        ax.plot(suspect[CONTRACTION], suspect[FORCE], "x", **style)
    ax.axhline(0, color="black", linewidth=0.7)
    ax.set_title(constants(here, ["muscle", PRESSURE]))


def _deviations(ax: Any, here: pd.DataFrame) -> None:
    curves.by_source(ax, here, CONTRACTION, DEVIATION)
    ax.axhline(0, color="black", linewidth=0.7)
    percent(ax.yaxis)
    for mean in here[PAPER].dropna().unique():
        style = {"color": SOFT, "linewidth": 1.0, "linestyle": ":"}
        label = f"the paper's mean, {100 * mean:.1f} %".replace("-", "\N{MINUS SIGN}")
        ax.axhline(mean, label=label, **style)
