"""Views of one stressed muscle: whole, near the cap, and along the meridian."""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.colors import CenteredNorm
from matplotlib.tri import Triangulation

from workflow.data.stress import LARGEST, SMALLEST
from workflow.figures.labels import SERIES
from workflow.figures.style import SOFT

COLOURS = "RdBu_r"
SKIN = {"cmap": COLOURS, "shading": "gouraud", "rasterized": True}
CAP, WALL = "z of the cap [mm]", "wall_thickness [mm]"
R, Z = "r [mm]", "z [mm]"
NEAR = 8.0  # wall thicknesses on this side of the cap that the enlarged views show
INSIDE = 3.0  # beyond it, in the fitting
NOISE = 0.01  # of the largest stress: compression is hatched from there
LINES = (  # of the lower panels: where, which stress, name, style
    (
        "inner surface",
        LARGEST,
        "largest: inner surface",
        {"color": "#0072b2", "linestyle": (0, (4, 1.5))},
    ),
    ("mean", LARGEST, "mean", {"color": "black", "linewidth": 2.0}),
    ("outer surface", LARGEST, "outer surface", {"color": "#d55e00", "linestyle": (0, (1, 1.2))}),
    ("mean", SMALLEST, "smallest: mean", {"color": "black", "linewidth": 0.8}),
)


def whole(ax: Any, state: pd.DataFrame, norm: CenteredNorm, title: str) -> None:
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
    ax.set_title(title, pad=3)
    radius = outside[R].max()
    ax.set_yticks([-radius, 0, radius], [f"{radius:.3g}", "0", f"{radius:.3g}"], fontsize=7)
    ax.set_ylabel("r [mm]", fontsize=7)
    ax.set_xlabel("z from mid-length [mm]", fontsize=7, labelpad=1)
    ax.tick_params(axis="x", labelsize=7, pad=1)
    ax.grid(visible=False)
    ax.spines[:].set_visible(False)


def near_cap(ax: Any, state: pd.DataFrame, norm: CenteredNorm) -> None:
    """The wall near one cap, true to scale."""
    corners, cap = state[state["where"] == "wall"], state[CAP].iloc[0]
    thick = state[WALL].iloc[0]
    start, stop = cap - NEAR * thick, cap + INSIDE * thick
    mesh = _triangles(corners[Z], corners[R])
    ax.tripcolor(mesh, corners[LARGEST], norm=norm, **SKIN)
    zero = -NOISE * norm.halfrange
    ax.tricontour(mesh, corners[LARGEST], [zero], colors="black", linewidths=0.6)
    ax.tricontourf(mesh, corners[LARGEST], [-1e3, zero], colors="none", hatches=["//////"])
    ax.axvline(cap, color=SOFT, linewidth=0.8)
    ax.text(cap, 0.97, " fitting", va="top", fontsize=7, transform=ax.get_xaxis_transform())
    near = corners.loc[corners[Z].between(start, stop), R]
    near = near if len(near) else corners[R]  # a mesh may have no node so near
    ax.set_xlim(start, stop)
    ax.set_ylim(near.min() - 0.35 * thick, near.max() + 0.35 * thick)
    ax.set_aspect("equal")
    ax.set_title(state[SERIES].iloc[0])
    ax.tick_params(labelbottom=False)
    if ax.get_subplotspec().is_first_col():
        ax.set_ylabel("r [mm]")
    ax.grid(visible=False)


def along(ax: Any, state: pd.DataFrame) -> None:
    """Largest and smallest principal stress along the meridian near the cap."""
    for where, stress, label, style in LINES:
        rows = state[state["where"] == where].sort_values(Z)
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
