"""Figures of the study of discrete threads: a cut through the deformed wall, and the correction."""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.interpolate import LinearNDInterpolator

from geometry.cell import Box
from workflow.figures import style
from workflow.principal import principal_of_six
from workflow.studies import Solved

Array = NDArray[np.float64]
HEIGHT = 0.25  # of the cut, in axial spacings: the threads of both layers lie apart there
CELLS = 3  # drawn beside each other
COLOURS = {"NBR": "black", "silicone": "#d55e00"}
MARKERS = {0.2: "o", 0.3: "s", 0.4: "^"}
EDGES = np.array([(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)])


def cut(values: Array, level: Array) -> list[Array]:
    """Polygons in which tetrahedra meet level = 0; ``values`` (4 n, k) and ``level`` at corners.

    Each polygon has the values at its three or four corners, in order around its middle by the
    first two of them.
    """
    polygons = []
    for corners, height in zip(
        values.reshape(-1, 4, values.shape[1]), level.reshape(-1, 4), strict=True
    ):
        a, b = EDGES[height[EDGES[:, 0]] * height[EDGES[:, 1]] < 0].T
        if len(a) < 3:
            continue
        share = (height[a] / (height[a] - height[b]))[:, None]
        points = corners[a] + share * (corners[b] - corners[a])
        middle = points[:, :2].mean(axis=0)
        turn = np.arctan2(*(points[:, :2] - middle).T)
        polygons.append(points[np.argsort(turn)])
    return polygons


def cuts(shown: dict[str, Solved]) -> Figure:
    """The wall across the axis with its threads, deformed, in the largest principal stress."""
    figure, places = style.grid(style.FULL, 3.0, 1, max(len(shown), 1), gap=(0.9, 0.3))
    for k, (rubber, entry) in enumerate(shown.items()):
        _cut(figure, figure.add_subplot(places[0, k]), rubber, entry)
    return figure


def _cut(figure: Figure, ax: Any, rubber: str, entry: Solved) -> None:
    case = entry.asked.case
    (state,) = entry.solution.fields
    fields = entry.solution.fields[state]
    corners, box = fields["corners"], Box(case.muscle)
    largest = principal_of_six(fields["stress"])[:, 2]
    # a little off the round share, so that no corner lies on the cut
    level = corners[:, 2] - (HEIGHT + 1e-4) * box.spacing
    polygons = cut(np.column_stack([corners[:, [0, 1, 3, 4]], largest]), level)
    period = 2 * np.pi / box.sectors
    faces, colours = [], []
    for k in range(CELLS):
        for polygon in polygons:
            faces.append(_place(polygon[:, 2], polygon[:, 3], (k - CELLS / 2) * period))
            colours.append(polygon[:, 4].mean())
    drawn = PolyCollection(faces, array=np.array(colours), cmap="viridis", edgecolors="face")
    drawn.set_linewidth(0.2)
    ax.add_collection(drawn)
    _threads(ax, entry, polygons, period)
    ax.set_aspect("equal")
    ax.autoscale_view()
    ax.grid(False)
    ax.set(xlabel="across the axis [mm]", ylabel="from the axis [mm]")
    eps, pressure = case.path.stops[state], case.path.held
    ax.set_title(f"{rubber}, {pressure:g} MPa, {100 * eps:g} %")
    bar = figure.colorbar(drawn, ax=ax, orientation="horizontal", pad=0.22, aspect=30)
    bar.set_label("largest principal stress of the rubber [MPa]")


def _place(r: Array, t: Array, turn: float) -> Array:
    return np.column_stack([r * np.sin(t + turn), r * np.cos(t + turn)])


def _threads(ax: Any, entry: Solved, polygons: list[Array], period: float) -> None:
    """Sections of the round threads, moved with the rubber around them."""
    case = entry.asked.case
    assert case.muscle.braid is not None
    assert case.thread is not None
    points = np.concatenate(polygons)
    shift = np.array([0, period, 0, period, 0])
    around = np.concatenate([points + k * shift for k in (-1, 0, 1)])
    moved = LinearNDInterpolator(around[:, :2] * [1, points[:, 0].mean()], around[:, 2:4])
    radius = np.sqrt(case.thread.stiffness / (np.pi * case.numerics.spread.modulus))
    turn = np.linspace(0, 2 * np.pi, 60)
    layers = zip(
        (HEIGHT, 1 - HEIGHT), case.muscle.layer_radii, case.muscle.braid.layer_angles, strict=True
    )
    for share, level, angle in layers:
        r0 = level + radius * np.sin(turn)
        t0 = share * period + radius * np.cos(turn) / (level * np.cos(angle))
        at = moved(np.column_stack([r0, t0 * points[:, 0].mean()]))
        for k in range(CELLS):
            outline = _place(at[:, 0], at[:, 1], (k - CELLS / 2) * period)
            ax.plot(*outline.T, color="white", linewidth=0.9)


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
