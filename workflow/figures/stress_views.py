"""Views of one stressed muscle: whole, near the cap, and along the meridian."""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.colors import TwoSlopeNorm
from matplotlib.tri import Triangulation

from workflow.data.stress import LARGEST, SMALLEST
from workflow.figures.labels import SERIES
from workflow.figures.style import SOFT

COLOURS = "RdBu_r"
SKIN = {"cmap": COLOURS, "shading": "gouraud", "rasterized": True}
CAP = "z of the cap [mm]"
R, Z = "r [mm]", "z [mm]"
NEAR = 16.0  # mm on this side of the cap that the enlarged views show
INSIDE = 6.0  # mm beyond it, in the fitting
NOISE = 0.01  # of the largest stress: compression is hatched from there
LINES = (  # of the lower panels: where, which stress, style
    ("inner surface", LARGEST, {"color": "#0072b2", "linestyle": (0, (4, 1.5))}),
    ("mean", LARGEST, {"color": "black", "linewidth": 2.0}),
    ("outer surface", LARGEST, {"color": "#d55e00", "linestyle": (0, (1, 1.2))}),
    ("mean", SMALLEST, {"color": "black", "linewidth": 0.8}),
)


def whole(ax: Any, state: pd.DataFrame, norm: TwoSlopeNorm, last: bool) -> None:
    """Upper half cut, lower half from outside, both sides of mid-length."""
    corners = state[state["where"] == "wall"]
    outside = state[state["where"] == "outer surface"].sort_values(Z)
    for side in (-1, 1):
        ax.tripcolor(_triangles(side * corners[Z], corners[R]), corners[LARGEST], norm=norm, **SKIN)
        z, r, stress = (np.tile(outside[name], (2, 1)) for name in (Z, R, LARGEST))
        ax.pcolormesh(side * z, -r * [[0], [1]], stress, norm=norm, **SKIN)
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


def near_cap(ax: Any, state: pd.DataFrame, norm: TwoSlopeNorm) -> None:
    """The wall near one cap, true to scale."""
    corners, cap = state[state["where"] == "wall"], state[CAP].iloc[0]
    mesh = _triangles(corners[Z], corners[R])
    ax.tripcolor(mesh, corners[LARGEST], norm=norm, **SKIN)
    assert norm.vmax is not None
    zero = -NOISE * norm.vmax
    ax.tricontour(mesh, corners[LARGEST], [zero], colors="black", linewidths=0.6)
    ax.tricontourf(mesh, corners[LARGEST], [-1e3, zero], colors="none", hatches=["//////"])
    ax.axvline(cap, color=SOFT, linewidth=0.8)
    ax.text(cap, 0.97, " fitting", va="top", fontsize=7, transform=ax.get_xaxis_transform())
    near = corners.loc[corners[Z].between(cap - NEAR, cap + INSIDE), R]
    near = near if len(near) else corners[R]  # a mesh may have no node so near
    ax.set_xlim(cap - NEAR, cap + INSIDE)
    ax.set_ylim(near.min() - 0.7, near.max() + 0.7)
    ax.set_aspect("equal")
    ax.set_title(state[SERIES].iloc[0])
    ax.tick_params(labelbottom=False, labelleft=ax.get_subplotspec().is_first_col())
    if ax.get_subplotspec().is_first_col():
        ax.set_ylabel("r [mm]")
    ax.grid(visible=False)


def along(ax: Any, state: pd.DataFrame) -> None:
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
