"""Figures of the study of discrete threads: a cut through the deformed wall, and the correction."""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray
from scipy.interpolate import LinearNDInterpolator

from geometry.cell import Box
from workflow.figures import style
from workflow.studies import Solved
from workflow.studies.threads_local import nodes

Array = NDArray[np.float64]
HEIGHT = 0.25  # of the cut, in axial spacings: the threads of both layers lie apart there
CELLS = 3  # drawn beside each other
ACROSS, THROUGH = 80, 60  # points of a cell that the cut is drawn with
NEAR_SURFACE = 1e-3  # mm: where the wall begins for an interpolation between nodes
LEVELS = 16  # about as many shades
COLOURS = {"NBR": "black", "silicone": "#d55e00"}
MARKERS = {0.2: "o", 0.3: "s", 0.4: "^"}


def local(shown: dict[str, Solved], rows: pd.DataFrame) -> Figure:
    """The wall across the axis in the largest principal stress; the threads' tension below."""
    figure, places = style.grid(
        style.FULL, 4.3, 2, max(len(shown), 1), gap=(0.75, 0.6), height_ratios=[2, 1]
    )
    lower = []
    for k, (rubber, entry) in enumerate(shown.items()):
        _cut(figure, figure.add_subplot(places[0, k]), rubber, entry)
        lower.append(figure.add_subplot(places[1, k]))
        _tension(lower[-1], rows[rows["rubber"] == rubber])
    style.grow(figure, bottom=style.LEGEND_ROW)
    figure.legend(
        handles=style.labelled(np.array(lower)), ncols=4, loc="lower center", fontsize=7.5
    )
    return figure


def _cut(figure: Figure, ax: Any, rubber: str, entry: Solved) -> None:
    case, box = entry.asked.case, Box(entry.asked.case.muscle)
    ((state, fields),) = entry.solution.fields.items()
    values = LinearNDInterpolator(*nodes(fields, box))
    inner, outer = case.muscle.inner_radius + NEAR_SURFACE, case.muscle.outer_radius - NEAR_SURFACE
    period = 2 * np.pi / box.sectors
    half = CELLS / 2 * period
    place = np.meshgrid(
        np.linspace(inner, outer, THROUGH), np.linspace(-half, half, CELLS * ACROSS), indexing="ij"
    )
    x, y, stress = _at(values, box, *place)
    levels = MaxNLocator(LEVELS, steps=[1, 2, 5, 10]).tick_values(stress.min(), stress.max())
    drawn = ax.contourf(x, y, stress, levels, cmap="cividis")
    ax.contour(x, y, stress, levels, colors="black", linewidths=0.2, linestyles="-")
    if stress.min() < 0 < stress.max():
        ax.contour(x, y, stress, [0], colors="black", linewidths=1.2)
        ax.contourf(x, y, stress, [stress.min() - 1, 0], colors="none", hatches=["/////"])
    for outline in _outlines(case, period):
        ax.plot(*_at(values, box, *outline)[:2], color="white", linewidth=2.0)
        ax.plot(*_at(values, box, *outline)[:2], color="black", linewidth=0.9)
    ax.set_aspect("equal")
    ax.grid(visible=False)
    ax.set(xlabel="across the axis [mm]", ylabel="from the axis [mm]")
    eps, pressure = case.path.stops[state], case.path.held
    ax.set_title(f"{rubber}, {pressure:g} MPa, {100 * eps:g} %")
    bar = figure.colorbar(drawn, ax=ax, orientation="horizontal", pad=0.24, aspect=30)
    below = " (hatched: below 0)" if stress.min() < 0 else ""
    bar.set_label(f"largest principal stress [MPa]{below}")
    bar.set_ticks(levels[::2])


def _at(values: Any, box: Box, radius: Array, turn: Array) -> tuple[Array, Array, Array]:
    """Where points of the cut are now, and their stress."""
    period = 2 * np.pi / box.sectors
    folded = (turn % period) * box.mean_radius
    height = np.full_like(radius, HEIGHT * box.spacing)
    r, moved, stress = np.moveaxis(values(np.stack([radius, folded, height], axis=-1)), -1, 0)
    return r * np.sin(turn + moved), r * np.cos(turn + moved), stress


def _outlines(case: Any, period: float) -> list[tuple[Array, Array]]:
    """Sections of the round threads in the cut, as radii and angles."""
    size = np.sqrt(case.thread.stiffness / (np.pi * case.numerics.spread.modulus))
    turn = np.linspace(0, 2 * np.pi, 60)
    found = []
    for sense, level, angle in zip(
        (1, -1), case.muscle.layer_radii, case.muscle.braid.layer_angles, strict=True
    ):
        for k in range(-CELLS, CELLS + 1):
            middle = (k + sense * HEIGHT) * period
            if abs(middle) < (CELLS / 2 - 0.2) * period:
                wide = size / (level * np.cos(angle))
                found.append((level + size * np.sin(turn), middle + wide * np.cos(turn)))
    return found


def _tension(ax: Any, rows: pd.DataFrame) -> None:
    """Along the cell, where threads of the layers cross at the ends and in the middle."""
    chosen = rows[rows["set"] == "tension"]
    for (layers, layer), line in chosen.groupby(["layers", "layer"]):
        ax.plot(
            line["along the cell [1]"],
            line["thread tension [N]"],
            color="black" if layers == "discrete" else "0.6",
            linestyle="-" if layer == 1 else (0, (4, 2)),
            marker="o" if layers == "discrete" else "",
            markersize=2.5,
            label=f"{'threads' if layers == 'discrete' else 'smeared'}, "
            f"{'inner' if layer == 1 else 'outer'} layer",
        )
    middle = chosen["thread tension [N]"].mean()
    ax.set_ylim(0.92 * middle, 1.08 * middle)
    ax.set(xlabel="along the cell [axial spacing]", ylabel="thread tension [N]", xlim=(0, 1))


def correction(rows: pd.DataFrame) -> Figure:
    """What single threads change in the force; silicone over the wall; the mesh."""
    figure, places = style.grid(style.FULL, 2.6, 1, 3, gap=(0.75, 0.3))
    axes = [figure.add_subplot(places[0, k]) for k in range(3)]
    _change(axes[0], rows)
    _walls(axes[1], rows)
    _meshes(axes[2], rows)
    return figure


def _change(ax: Any, rows: pd.DataFrame) -> None:
    chosen = rows[
        (rows["set"] == "correction") & (rows["layers"] == "discrete") & (rows["wall [mm]"] == 2)
    ]
    for (rubber, pressure), curve in chosen.groupby(["rubber", "pressure [MPa]"]):
        ax.plot(
            100 * curve["contraction [1]"],
            curve["change [N]"],
            color=COLOURS[str(rubber)],
            marker=MARKERS.get(float(pressure), "x"),
            linestyle="-" if rubber == "NBR" else (0, (4, 2)),
            label=f"{rubber}, {pressure:g} MPa",
        )
    ax.set(xlabel="contraction [%]", ylabel="threads − smeared layers [N]")
    ax.set_title("wall 2 mm")
    ax.legend(fontsize=6.5)


def _walls(ax: Any, rows: pd.DataFrame) -> None:
    chosen = rows[
        (rows["set"] == "correction")
        & (rows["rubber"] == "silicone")
        & np.isclose(rows["contraction [1]"], 0.1)
    ]
    for (layers, pressure), curve in chosen.groupby(["layers", "pressure [MPa]"]):
        ax.plot(
            curve["wall [mm]"],
            curve["force [N]"],
            color="black" if layers == "discrete" else "0.55",
            marker=MARKERS.get(float(pressure), "x"),
            linestyle="-" if layers == "discrete" else (0, (4, 2)),
            label=f"{layers}, {pressure:g} MPa",
        )
    ax.set(xlabel="wall thickness [mm]", ylabel="force [N]")
    ax.set_title("silicone, 10 %")
    ax.legend(fontsize=6.5)


def _meshes(ax: Any, rows: pd.DataFrame) -> None:
    chosen = rows[(rows["set"] == "mesh") & np.isclose(rows["contraction [1]"], 0.0)]
    for layers, curve in chosen.groupby("layers"):
        ax.plot(
            curve["size"],
            curve["force [N]"],
            marker={"discrete": "o", "smeared": "s", "wire": "X"}[str(layers)],
            linestyle={"discrete": "-", "smeared": (0, (4, 2)), "wire": ":"}[str(layers)],
            color="black",
            label={"discrete": "threads", "smeared": "smeared", "wire": "wire"}[str(layers)],
        )
    ax.set(xlabel="mesh size [thread radii]", ylabel="force [N]")
    ax.set_title("NBR, 0.3 MPa, 0 %")
    ax.legend(fontsize=6.5)
