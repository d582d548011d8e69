"""Figures of discrete threads: a cut through the deformed wall, and the correction."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, NullFormatter
from numpy.typing import NDArray
from scipy.interpolate import LinearNDInterpolator

from geometry.cell import Box
from solver.effects import Layers
from workflow.analyses import undrawn
from workflow.analyses.analysis import Solved
from workflow.analyses.threads.local import nodes
from workflow.figures import curves, style
from workflow.study import fit

Array = NDArray[np.float64]
HEIGHT = 0.25  # of the cut, in axial spacings: where threads of the two layers do not cross
CELLS = 3  # drawn beside each other
ACROSS, THROUGH = 80, 60  # points of a cell that the cut is drawn with
NEAR_SURFACE = 1e-3  # mm from the surface, so that every point lies between nodes
LEVELS = 16  # approximate number of shades
WALL = 2.0  # mm, of the panel of changes and of claim C8
MESH_STYLE: dict[str, dict[str, Any]] = {
    "discrete": {"marker": "o", "linestyle": "-", "label": "threads"},
    "smeared": {"marker": "s", "linestyle": (0, (4, 2)), "label": "smeared"},
    "wire": {"marker": "X", "linestyle": ":", "label": "wire of zero thickness"},
}
COLOURS = {"NBR": "black", "silicone": "#d55e00"}
MARKERS = {0.2: "o", 0.3: "s", 0.4: "^"}


def draw(solved: Sequence[Solved], tables: Mapping[str, pd.DataFrame]) -> dict[str, Figure]:
    """Both figures."""
    rows = tables["threads"]
    return {"threads": local(shown(solved), rows), "threads_correction": correction(rows)}


def shown(solved: Sequence[Solved]) -> dict[str, Solved]:
    """By rubber the case with single threads whose fields the picture shows, where it has them."""
    return {
        str(one.asked.tags["rubber"]): one
        for one in solved
        if one.asked.case.fields_at
        and one.solution.fields
        and one.asked.tags["layers"] == Layers.DISCRETE
    }


def local(shown: dict[str, Solved], rows: pd.DataFrame) -> Figure:
    """The wall across the axis in the largest principal stress; the threads' tension below."""
    figure, places = style.grid(
        style.FULL, 4.3, 2, max(len(shown), 1), gap=(0.75, 0.6), height_ratios=[2, 1]
    )
    lower = []
    for k, (rubber, one) in enumerate(shown.items()):
        _cut(figure, figure.add_subplot(places[0, k]), rubber, one)
        lower.append(figure.add_subplot(places[1, k]))
        _tension(lower[-1], rows[rows["rubber"] == rubber])
    style.grow(figure, bottom=style.LEGEND_ROW)
    handles = style.labelled(np.array(lower))
    text = undrawn.sentence(sorted(set(rows["rubber"].dropna()) - set(shown)), "No picture of")
    where: dict[str, Any] = {}
    if text:
        below = figure.get_size_inches()[1]
        curves.note(figure, text)
        taller = figure.get_size_inches()[1]
        where = {"bbox_to_anchor": (0.5, (taller - below) / taller)}
    figure.legend(handles=handles, ncols=4, loc="lower center", fontsize=7.5, **where)
    return figure


def _cut(figure: Figure, ax: Any, rubber: str, one: Solved) -> None:
    case, box = one.asked.case, Box(one.asked.case.muscle)
    ((state, fields),) = one.solution.fields.items()
    values = LinearNDInterpolator(*nodes(fields, box))
    inner, outer = case.muscle.inner_radius + NEAR_SURFACE, case.muscle.outer_radius - NEAR_SURFACE
    period = 2 * np.pi / box.sectors
    half = CELLS / 2 * period
    place = np.meshgrid(
        np.linspace(inner, outer, THROUGH), np.linspace(-half, half, CELLS * ACROSS), indexing="ij"
    )
    x, y, stress = _at(values, box, *place)
    levels = MaxNLocator(LEVELS, steps=[1, 2, 2.5, 5, 10]).tick_values(stress.min(), stress.max())
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
    bar.set_ticks(MaxNLocator(6).tick_values(levels[1], levels[-2])[1:-1])


def _at(values: Any, box: Box, radius: Array, turn: Array) -> tuple[Array, Array, Array]:
    """Where points of the cut are now, and their stress."""
    period = 2 * np.pi / box.sectors
    folded = (turn % period) * box.mean_radius
    height = np.full_like(radius, HEIGHT * box.spacing)
    r, moved, stress = np.moveaxis(values(np.stack([radius, folded, height], axis=-1)), -1, 0)
    return r * np.sin(turn + moved), r * np.cos(turn + moved), stress


def _outlines(case: Any, period: float) -> list[tuple[Array, Array]]:
    """Sections of the round threads in the cut, as radii and angles."""
    size = fit.diameter(case.thread.stiffness, case.numerics.spread.modulus) / 2
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
    if np.isfinite(middle):
        low, high = chosen["thread tension [N]"].min(), chosen["thread tension [N]"].max()
        margin = 0.08 * abs(middle)
        ax.set_ylim(min(middle - margin, low), max(middle + margin, high))
    ax.set(xlabel="along the cell [axial spacing]", ylabel="thread tension [N]", xlim=(0, 1))


def correction(rows: pd.DataFrame) -> Figure:
    """What single threads change in the force; silicone over the wall; meshes, and the wire."""
    figure, axes = style.panels(style.FULL, 5.4, 2, 2, gap=(0.85, 0.65))
    _change(axes[0, 0], rows)
    _walls(axes[0, 1], rows)
    _meshes(axes[1, 0], rows, "force [N]")
    _meshes(axes[1, 1], rows, "smallest det F at corners [1]")
    axes[1, 1].axhline(0, color="black", linewidth=0.7)
    axes[1, 1].set_ylabel("smallest det F [1]")
    axes[1, 0].legend(fontsize=7.5)
    curves.note(figure, undrawn.sentence(_missing(rows)))
    return figure


def _missing(rows: pd.DataFrame) -> list[str]:
    """States without a force, curve by curve, and changes that have nothing to be compared with."""
    found = rows[rows["set"].isin(["correction", "mesh"])]
    named = found.assign(unit="MPa", of="wall", length="mm")
    by = ["set", "rubber", "layers", "pressure [MPa]", "unit", "of", "wall [mm]", "length"]
    lost = undrawn.without_value(named, "force [N]", by)
    drawn = _of_correction(named)
    drawn = drawn[(drawn["layers"] == "discrete") & (drawn["wall [mm]"] == WALL)]
    alone = drawn[drawn["force [N]"].notna() & drawn["change [N]"].isna()]
    by = ["rubber", "layers", "pressure [MPa]", "unit"]
    return lost + [f"change of {name}" for name in undrawn.without_value(alone, "change [N]", by)]


def _of_correction(rows: pd.DataFrame) -> pd.DataFrame:
    return rows[rows["set"] == "correction"]


def _change(ax: Any, rows: pd.DataFrame) -> None:
    rows = _of_correction(rows)
    chosen = rows[(rows["layers"] == "discrete") & (rows["wall [mm]"] == WALL)]
    for (rubber, pressure), curve in chosen.groupby(["rubber", "pressure [MPa]"]):
        ax.plot(
            100 * curve["contraction [1]"],
            curve["change [N]"],
            color=COLOURS[str(rubber)],
            marker=MARKERS.get(float(pressure), "x"),
            linestyle="-" if rubber == "NBR" else (0, (4, 2)),
            label=f"{rubber}, {pressure:g} MPa",
        )
    ax.axhline(0, color="black", linewidth=0.7)
    low, high = chosen["change [N]"].min(), chosen["change [N]"].max()
    if low < high:
        ax.set_ylim(top=high + 0.45 * (high - low))  # room for the legend
    ax.set(xlabel="contraction [%]", ylabel="force of threads − smeared [N]")
    ax.set_title(f"what single threads change, wall {WALL:g} mm")
    ax.legend(fontsize=7, ncols=2, loc="upper right")


def _walls(ax: Any, rows: pd.DataFrame) -> None:
    """Claim C8: whether silicone pulls most at the wall of 2 mm."""
    rows = _of_correction(rows)
    chosen = rows[(rows["rubber"] == "silicone") & np.isclose(rows["contraction [1]"], 0.1)]
    for (layers, pressure), curve in chosen.groupby(["layers", "pressure [MPa]"], sort=False):
        curve = curve.sort_values("wall [mm]")
        at = curve.loc[curve["wall [mm]"] == WALL, "force [N]"]
        single = layers == "discrete"
        ax.plot(
            curve["wall [mm]"],
            curve["force [N]"] - (at.iloc[0] if len(at) else 0),
            color="black" if single else "0.75",
            linewidth=1.0 if single else 4.0,
            zorder=3 if single else 2,
            marker=MARKERS.get(float(pressure), "x") if single else "",
            linestyle="-",
            label=f"threads, {pressure:g} MPa" if single else "smeared" * (pressure == 0.3),
        )
    ax.axhline(0, color="black", linewidth=0.7)
    ax.set(xlabel="wall thickness [mm]", ylabel=f"force − that at {WALL:g} mm [N]")
    ax.set_title("silicone, 10 %: most at 2 mm? (C8)")
    ax.legend(fontsize=7.5)


def _meshes(ax: Any, rows: pd.DataFrame, quantity: str) -> None:
    chosen = rows[(rows["set"] == "mesh") & np.isclose(rows["contraction [1]"], 0.0)]
    for layers, curve in chosen.groupby("layers"):
        ax.plot(curve["size"], curve[quantity], color="black", **MESH_STYLE[str(layers)])
    ax.set(xscale="log", xlabel="mesh size h at a thread [thread radii]", ylabel=quantity)
    sizes = sorted(chosen["size"].unique())
    ax.set_xticks(sizes, [f"{size:g}" for size in sizes])
    ax.xaxis.set_minor_formatter(NullFormatter())
    ax.tick_params(axis="x", which="minor", bottom=False)
    ax.set_title("NBR, 0.3 MPa, 0 %: finer to the left")
