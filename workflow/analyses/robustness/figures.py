"""Figures of hard cases: where which status, and what the worst states look like."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation

from workflow.analyses import undrawn
from workflow.analyses.analysis import Solved
from workflow.analyses.robustness.cases import ANY
from workflow.data import stress
from workflow.figures import curves, style

STATUS: dict[str, dict[str, Any]] = {
    "converged": {"color": "#0072b2", "marker": "o"},
    "limit_point": {"color": "#e69f00", "marker": "^"},
    "invalid_state": {"color": "#d55e00", "marker": "X"},
    "stalled": {"color": "black", "marker": "x"},
    "timeout": {"color": "black", "marker": "+"},
    "solver_error": {"color": "black", "marker": "*"},
    "mesh_failed": {"color": "black", "marker": "s"},
}
MESH_MARKS = {1: "o", 2: "s", 3: "D"}
GOOD_DET, GOOD_MESH = 0.5, 1e-3  # goals for the named cases: det F, and difference between meshes
WORST = 6
ENDS = "\n(at the ends: and beyond)"
OTHER = {"color": "black", "marker": "d"}  # a status without a look


def draw(solved: Sequence[Solved], tables: Mapping[str, pd.DataFrame]) -> dict[str, Figure]:
    """Both figures."""
    rows = tables["robustness"]
    return {"robustness": overview(rows), "robustness_worst": worst(solved, rows)}


def overview(table: pd.DataFrame) -> Figure:
    """Named cases by smallest det F and mesh; both hypercubes by status; cost of the first."""
    named = table[(table["set"] == "named") & (table["model"] == "solid")]
    cube = table[(table["set"] == "hypercube") & (table["model"] == "solid") & (table["mesh"] == 1)]
    sleeved = table[(table["set"] == ANY) & (table["model"] == "solid") & (table["mesh"] == 1)]
    figure, places = style.grid(style.FULL, 8.6, 1, 2, gap=(0.75, 0.5), width_ratios=[1.2, 1])
    figure.subplots_adjust(left=0.25, bottom=0.08)
    left = places[0, 0].subgridspec(1, 2, wspace=0.12)
    first = figure.add_subplot(left[0, 0])
    second = figure.add_subplot(left[0, 1], sharey=first)
    right = places[0, 1].subgridspec(4, 1, hspace=0.66, height_ratios=[1.2, 1.2, 1, 1])
    _named_det(first, named)
    _named_mesh(second, named)
    first = figure.add_subplot(right[0, 0])
    _by_status(first, cube, "thread strain", f"hypercube, {len(cube)} muscles")
    first.set(xscale="log", xlabel="p D² / (threads × EA), a thread strain")
    second = figure.add_subplot(right[1, 0])
    _by_status(second, sleeved, "gap", f"{len(sleeved)} of any muscles, in sleeves")
    second.set(xlabel="gap / outer radius of the tube")
    _cube_det(figure.add_subplot(right[2, 0]), cube)
    _cube_effort(figure.add_subplot(right[3, 0]), cube)
    curves.note(figure, _missing(named, cube))
    return figure


def _missing(named: pd.DataFrame, cube: pd.DataFrame) -> str:
    """What has no mark."""
    lost = undrawn.without_value(named.assign(of="mesh"), "smallest det F", ["name", "of", "mesh"])
    apart = named[named["against"] != ""].assign(of="mesh")
    apart = apart[apart["difference"].isna()]
    alone = undrawn.without_value(apart, "difference", ["name", "of", "mesh"])
    muscles = int(cube["smallest det F"].isna().sum())
    lost += [f"{muscles} muscles of the hypercube"] if muscles else []
    said = (
        undrawn.sentence(lost, "Without any state"),
        undrawn.sentence(alone, "With no state in common with mesh 3"),
    )
    return " ".join(filter(None, said))


def _named_det(ax: Any, named: pd.DataFrame) -> None:
    names = list(dict.fromkeys(named["name"]))
    for mesh, rows in named.groupby("mesh"):
        places = [names.index(name) for name in rows["name"]]
        ax.plot(
            rows["smallest det F"],
            places,
            linestyle="",
            marker=MESH_MARKS[int(mesh)],
            fillstyle="none" if mesh < 3 else "full",
            color="black",
            label=f"mesh {mesh:g}",
        )
    ax.axvline(GOOD_DET, color=style.SOFT, linewidth=0.8, linestyle=(0, (4, 2)))
    ax.set(yticks=range(len(names)), yticklabels=names, xlabel="smallest det F")
    lowest = min(0.0, 1.05 * named["smallest det F"].min())
    ax.set_xlim(lowest, 1.02)
    ax.invert_yaxis()
    ax.set_title("named cases, −5 to 25 %")
    ax.legend(loc="center left", fontsize=7, handlelength=1, borderaxespad=0.1)
    bad = named[named["status"] != "converged"]
    for name, rows in bad.groupby("name"):
        ax.text(0.02, names.index(name), rows["status"].iloc[0], fontsize=7, va="center")


def _named_mesh(ax: Any, named: pd.DataFrame) -> None:
    names = list(dict.fromkeys(named["name"]))
    for mesh, rows in named[named["against"] != ""].groupby("mesh"):
        places = [names.index(name) for name in rows["name"]]
        ax.plot(
            rows["difference"].clip(lower=1e-7),
            places,
            linestyle="",
            marker=MESH_MARKS[int(mesh)],
            fillstyle="none",
            color="black",
        )
    ax.axvline(GOOD_MESH, color=style.SOFT, linewidth=0.8, linestyle=(0, (4, 2)))
    ax.set(xscale="log", xlabel="difference of force\nfrom mesh 3 [of largest]")
    ax.tick_params(labelleft=False)


def _by_status(ax: Any, cube: pd.DataFrame, x: str, title: str) -> None:
    for status, rows in cube.groupby("status"):
        ax.plot(
            rows[x],
            rows["pressure by modulus"],
            linestyle="",
            label=f"{status}: {len(rows)}",
            fillstyle="none" if status == "converged" else "full",
            **STATUS.get(str(status), OTHER),
        )
    ax.set(yscale="log", ylabel="2 p / shear modulus")
    ax.set_ylim(bottom=cube["pressure by modulus"].min() / 20)  # room for the legend
    ax.set_title(title)
    ax.legend(loc="lower left", fontsize=7, handlelength=1, borderaxespad=0.1)


def _cube_det(ax: Any, cube: pd.DataFrame) -> None:
    edges = np.linspace(-0.5, 1, 31)
    found = [cube[name].dropna() for name in ("smallest det F", "smallest det F at nodes")]
    beyond = any(((values < edges[0]) | (values > edges[-1])).any() for values in found)
    ax.hist(
        [values.clip(edges[0], edges[-1]) for values in found],
        bins=edges,
        color=["#0072b2", "0.7"],
        label=["at quadrature points", "at nodes"],
    )
    ax.axvline(0, color="black", linewidth=0.8)
    ax.set(xlabel="smallest det F of a path" + ENDS * beyond, ylabel="muscles")
    ax.legend(loc="upper left", fontsize=7, handlelength=1, borderaxespad=0.1)


def _cube_effort(ax: Any, cube: pd.DataFrame) -> None:
    edges, found = np.arange(0, 42, 1.5), cube["iterations per state"]
    beyond = bool((found > edges[-1]).any())
    ax.hist(found.clip(upper=edges[-1]), bins=edges, color="#0072b2")
    cut = int((cube["cutbacks"] > 0).sum())
    ax.set(xlabel="Newton iterations per state" + ENDS * beyond, ylabel="muscles")
    ax.set_title(f"{cut} of {len(cube)} needed a cutback", fontweight="normal")


def worst(solved: Sequence[Solved], table: pd.DataFrame) -> Figure:
    """The deformed walls, near the cap, of the cases with the smallest det F."""
    by_record = {one.asked.case.key: one for one in solved if one.solution.fields}
    rows = table[table["record"].isin(by_record)].nsmallest(WORST, "smallest det F at nodes")
    figure, axes = style.panels(style.FULL, 6.6, 3, 2, gap=(0.45, 0.75))
    for ax, (_, row) in zip(axes.flat, rows.iterrows(), strict=False):
        _wall(ax, by_record[row["record"]], row)
    for ax in axes.flat[len(rows) :]:
        ax.set_axis_off()
    figure.text(
        0.01,
        0.005,
        "Last state near the cap. Colour: largest principal stress, red tension, blue compression, "
        "each to its own largest.",
        fontsize=7,
        color=style.SOFT,
    )
    return figure


def _wall(ax: Any, one: Solved, row: pd.Series) -> None:
    corners = stress.wall(next(iter(one.solution.fields.values())))
    muscle = one.asked.case.muscle
    mesh = Triangulation(
        corners["z [mm]"],
        corners["r [mm]"],
        np.arange(len(corners)).reshape(-1, 3),
    )
    values = corners[stress.LARGEST].to_numpy()
    limit = float(np.abs(values).max()) or 1.0
    ax.tripcolor(
        mesh, values, cmap="RdBu_r", vmin=-limit, vmax=limit, shading="gouraud", rasterized=True
    )
    ax.triplot(mesh, color="black", linewidth=0.3)
    cap = corners["z [mm]"].max() - muscle.cap_length
    near = 4 * muscle.wall_thickness
    ax.set_xlim(cap - 2.5 * near, cap + muscle.cap_length + 0.5)
    seen = corners[corners["z [mm]"] > cap - 2.5 * near]["r [mm]"]
    ax.set_ylim(seen.min() - 1, seen.max() + 1)
    ax.set_aspect("equal", adjustable="box", anchor="W")
    ax.set_title(
        f"{one.asked.label}: {row['status']}, det F {row['smallest det F']:.2f}, "
        f"at nodes {row['smallest det F at nodes']:.2f}",
        fontsize=7,
        fontweight="normal",
    )
    ax.grid(visible=False)
    ax.set(xlabel="z [mm]", ylabel="r [mm]")
