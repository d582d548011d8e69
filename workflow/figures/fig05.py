"""Largest principal Cauchy stress on the deformed wall, whole and near the cap (claim C2).

A whole muscle is drawn as engineers do: above the axis the cut wall, below it the outside, coloured
by the stress of the outer surface. White is zero; blue is compression, which is hatched near the
cap. The lines below say the same in numbers.
"""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.cm import ScalarMappable
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation

from workflow.figures import curves
from workflow.figures.labels import SERIES, series
from workflow.figures.states import CONTRACTION, GOOD, NUMBER, PRESSURE, of_curve
from workflow.figures.stress import LARGEST, SMALLEST, along_meridian, wall
from workflow.figures.style import FULL, SOFT, grid

COLOURS = "RdBu_r"
CAP = "z of the cap [mm]"
R, Z = "r [mm]", "z [mm]"
NEAR = 16.0  # mm on this side of the cap that the enlarged views show
INSIDE = 6.0  # mm beyond it, in the fitting
LINES = (  # of the lower panels: where, which stress, style
    ("inner surface", LARGEST, {"color": "#0072b2", "linestyle": (0, (4, 1.5))}),
    ("mean", LARGEST, {"color": "black", "linewidth": 2.0}),
    ("outer surface", LARGEST, {"color": "#d55e00", "linestyle": (0, (1, 1.2))}),
    ("mean", SMALLEST, {"color": "black", "linewidth": 0.8}),
)


def table(data: Any) -> pd.DataFrame:
    """Corners of all triangles and values along the meridian; of a failed state one row."""
    frames = []
    for solved in data.solutions:
        for _, state in of_curve(data.scene, ["contraction"], *solved).iterrows():
            fields = solved[-1].fields.get(state[NUMBER], {})
            drawn = pd.DataFrame({"where": ["nothing"]})
            if state["status"] == GOOD and "stress" in fields:
                corners = wall(fields)
                drawn = pd.concat([corners, along_meridian(corners)], ignore_index=True)
            half = data.muscles[state["muscle"]].length / 2
            cap = half * (1 - state[CONTRACTION])
            frames.append(drawn.assign(**state.drop([NUMBER, "point"]), **{CAP: cap}))
    every = pd.concat(frames, ignore_index=True)
    every[SERIES] = series(every, [PRESSURE, CONTRACTION, "muscle", "variant"])
    return every


def draw(table: pd.DataFrame) -> Figure:
    """One row per state for the whole muscle; below them, one column per state for its cap."""
    shown = table[table["where"] != "nothing"]
    states = [state for _, state in shown.groupby(SERIES, sort=False)]
    count = max(1, len(states))
    heights, widths = [0.75] * count + [0.75, 1.5], [1.0] * count + [0.05]
    figure, places = grid(
        FULL,
        sum(heights) + 0.3 * count + 1.2,
        count + 2,
        count + 1,
        height_ratios=heights,
        width_ratios=widths,
        gap=(0.15, 0.27),
        right=0.75,
    )
    if states:
        norm = _norm(shown[LARGEST])
        bar = figure.colorbar(ScalarMappable(norm, COLOURS), figure.add_subplot(places[:count, -1]))
        bar.set_label("largest principal\nstress [MPa]")
    first = None
    for number, state in enumerate(states):
        _whole(figure.add_subplot(places[number, :-1]), state, norm, number == count - 1)
        near = figure.add_subplot(places[count, number])
        first = figure.add_subplot(places[count + 1, number], sharex=near, sharey=first)
        _near_cap(near, state, norm)
        _along(first, state)
        if number == 0:
            near.text(state[CAP].iloc[0], near.get_ylim()[1], " fitting", va="top", fontsize=7)
            first.legend(loc="lower left", bbox_to_anchor=(-0.05, 0.98), ncol=4, columnspacing=1.0)
    curves.note_gaps(figure, table, [SERIES], CONTRACTION)
    return figure


def _norm(stress: pd.Series) -> TwoSlopeNorm:
    """White at zero; both ends of the map are used."""
    high = max(stress.max(), 1e-6)
    return TwoSlopeNorm(0, min(stress.min(), -0.01 * high), high)


def _whole(ax: Any, state: pd.DataFrame, norm: TwoSlopeNorm, last: bool) -> None:
    """Upper half cut, lower half from outside, both sides of mid-length."""
    corners = state[state["where"] == "wall"]
    outside = state[state["where"] == "outer surface"].sort_values(Z)
    skin = {"norm": norm, "cmap": COLOURS, "shading": "gouraud", "rasterized": True}
    for side in (-1, 1):
        ax.tripcolor(_triangles(side * corners[Z], corners[R]), corners[LARGEST], **skin)
        z, r, stress = (np.tile(outside[name], (2, 1)) for name in (Z, R, LARGEST))
        ax.pcolormesh(side * z, -r * [[0], [1]], stress, **skin)
        ax.plot(side * outside[Z], -outside[R], color=SOFT, linewidth=0.5)
    ax.axhline(0, color="black", linewidth=0.6, linestyle=(0, (12, 2, 2, 2)))
    ax.set_aspect("equal")
    ax.set_title(state[SERIES].iloc[0], pad=1)
    for text, place in (("cut", 0.75), ("outside", 0.25)):
        ax.text(-0.01, place, text, transform=ax.transAxes, ha="right", va="center", fontsize=7)
    ax.set_yticks([])
    ax.grid(visible=False)
    ax.spines[:].set_visible(False)
    ax.tick_params(labelbottom=last, bottom=last)


def _near_cap(ax: Any, state: pd.DataFrame, norm: TwoSlopeNorm) -> None:
    """The wall near one cap, true to scale."""
    corners, cap = state[state["where"] == "wall"], state[CAP].iloc[0]
    mesh = _triangles(corners[Z], corners[R])
    skin = {"norm": norm, "cmap": COLOURS, "shading": "gouraud", "rasterized": True}
    ax.tripcolor(mesh, corners[LARGEST], **skin)
    ax.tricontour(mesh, corners[LARGEST], [0], colors="black", linewidths=0.6)
    ax.tricontourf(mesh, corners[LARGEST], [-1e3, 0], colors="none", hatches=["//////"])
    ax.axvline(cap, color=SOFT, linewidth=0.8)
    near = corners.loc[corners[Z].between(cap - NEAR, cap + INSIDE), R]
    ax.set_xlim(cap - NEAR, cap + INSIDE)
    ax.set_ylim(near.min() - 0.7, near.max() + 0.7)
    ax.set_aspect("equal")
    ax.set_title(state[SERIES].iloc[0])
    ax.tick_params(labelbottom=False, labelleft=ax.get_subplotspec().is_first_col())
    ax.grid(visible=False)


def _along(ax: Any, state: pd.DataFrame) -> None:
    """Largest and smallest principal stress along the meridian near the cap."""
    for where, stress, style in LINES:
        rows = state[state["where"] == where].sort_values(Z)
        label = where if stress == LARGEST else "mean of the smallest"
        ax.plot(rows[Z], rows[stress], **style, label=label)
    ax.axhline(0, color="black", linewidth=0.7)
    ax.axvline(state[CAP].iloc[0], color=SOFT, linewidth=0.8)
    ax.set_xlabel("z from mid-length [mm]")
    if ax.get_subplotspec().is_first_col():
        ax.set_ylabel("principal stress [MPa]")
    else:
        ax.tick_params(labelleft=False)


def _triangles(z: pd.Series, r: pd.Series) -> Triangulation:
    """Every three rows are a triangle."""
    return Triangulation(z, r, np.arange(len(z)).reshape(-1, 3))
