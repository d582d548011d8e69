"""Figures of accuracy: error against cost, where the seconds go, how errors fall."""

import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullFormatter

from workflow.analyses import undrawn
from workflow.analyses.accuracy.costs import MEMORY, PARTS, SOLVE, growth, joined, of_cases
from workflow.analyses.accuracy.settings import MUSCLE, STEPS
from workflow.analyses.analysis import Solved
from workflow.figures import style
from workflow.figures.style import SOFT, SOURCES

ERROR = "total_error [1]"
RELATIVE = "festo_musclesim_relative [1]"
PAPER = 27 * 60.0, 0.099  # s, share: the paper's solve, its deviation from the manufacturer's map
WANTED = 0.0025  # discretisation error that the default meshes are held to
DEFAULT = "1/1"
MARKERS = {"geometric": "o", "cylinder": "s", "membrane": "^", "solid": "D", "cell": "P"}
COLOURS = {
    "geometric": "0.35",
    "cylinder": "#cc79a7",
    "membrane": "black",
    "solid": "#0072b2",
    "cell": "#b8860b",
}
PART_STYLE: dict[str, dict[str, Any]] = {
    "mesh [s]": {"color": "0.85"},
    "python [s]": {"color": "0.62"},
    "start [s]": {"color": "#f0e442"},
    "assembly [s]": {"color": "#0072b2"},
    "factor [s]": {"color": "#d55e00"},
    "residual [s]": {"color": "#56b4e9"},
    "rest [s]": {"color": "black"},
}
BESIDE = 0.44  # share of the width where horizontal lines begin, right of the cheap models' names
MEMORY_TICKS = {30: "30", 50: "50", 100: "100", 200: "200"}
TIMES = {1e-5: "10 µs", 1e-3: "1 ms", 0.01: "0.01", 0.1: "0.1", 1: "1 s", 10: "10", 60: "1 min"}
TIMES |= {PAPER[0]: "27 min"}
TEXT = {  # at a model's line: what it is for; offset [points] and alignment
    "geometric": ("Eq. (1): trends only", (9, 0), "left"),
    "cylinder": ("cylinder: no end caps;\nfor fits and first sizes", (-9, -3), "right"),
    "membrane": (
        "membrane: most curves;\n{:.1f} % off where\nthe force is small",
        (-12, -8),
        "right",
    ),
    "solid": ("solid: stress, local effects,\nand the last half per cent", (14, 0), "left"),
    "cell": ("cell: single threads,\nno end caps", (0, -19), "center"),
}
BARS = (("membrane", DEFAULT), *(("solid", f"1/{m}") for m in (1, 2, 4)), ("cell", DEFAULT))
FAMILIES = (  # set, model, colour, marker, what it is
    ("tube", "solid", "#009e73", "o", "bare tube, smooth"),
    ("mesh", "membrane", "black", "^", "membrane"),
    ("mesh", "solid", "#0072b2", "D", "solid, held gradually"),
    ("butt", "solid", "#d55e00", "s", "solid, bonded sharply"),
)
THEORY = {
    "bare tube, smooth": " (theory: 4)",
    "membrane": " (theory: 4)",
}  # superconvergence: twice the order of the elements


def draw(solved: Sequence[Solved], tables: Mapping[str, pd.DataFrame]) -> dict[str, Figure]:
    """Error against cost, and how errors fall."""
    rows = tables["accuracy"]
    costs = of_cases(rows["case"].dropna().unique())
    return {"accuracy": overview(rows, costs), "accuracy_orders": orders(rows)}


def overview(table: pd.DataFrame, costs: pd.DataFrame) -> Figure:
    """Error against seconds and memory with the frontier, and a bar that splits the seconds."""
    known = joined(table, costs)
    rows = known[known["set"] == "mesh"]
    figure, places = style.grid(
        style.FULL, 7.0, 2, 2, gap=(0.34, 0.8), width_ratios=[2, 1], height_ratios=[2.6, 1]
    )
    seconds = figure.add_subplot(places[0, 0])
    memory = figure.add_subplot(places[0, 1], sharey=seconds)
    _error_against(seconds, rows, SOLVE)
    _error_against(memory, rows, MEMORY)
    _label_seconds(seconds, rows)
    _maps(seconds, rows)
    seconds.set_xlabel("CPU seconds of a curve of 21 states")
    memory.set_xlabel("peak memory [MB]")
    seconds.set_ylabel("largest error of the force [% of the curve's largest]")
    seconds.set_title("error against time")
    memory.set_title("error against memory")
    memory.tick_params(labelleft=False)
    _split(figure.add_subplot(places[1, :]), rows)
    _note(figure, _small_print(known))
    return figure


def _note(figure: Figure, text: str) -> None:
    """Small print below."""
    lines = textwrap.wrap(text, 118)
    style.grow(figure, bottom=0.15 * len(lines))
    figure.text(0.015, 0.01, "\n".join(lines), color=SOFT, fontsize=7, va="bottom")


def _error_against(ax: Any, rows: pd.DataFrame, cost: str) -> None:
    """A line per model over its meshes; the frontier; the defaults ringed."""
    known = rows[rows[cost].notna() & rows[ERROR].notna()]
    cheapest = known.sort_values([cost, ERROR])
    frontier = cheapest[cheapest[ERROR] <= cheapest[ERROR].cummin()]
    if len(frontier):
        ax.plot(frontier[cost], frontier[ERROR], color="0.85", linewidth=9, zorder=1)
    for model, own in known.groupby("model"):
        own = own.sort_values(cost)
        look = {"color": COLOURS[str(model)], "marker": MARKERS[str(model)], "zorder": 3}
        ax.plot(own[cost], own[ERROR], markersize=5, linewidth=1.2, **look)
        default = own[own["mesh"] == DEFAULT]
        ax.plot(default[cost], default[ERROR], **_ring(), label="_default")
    positive = known[ERROR][known[ERROR] > 0]
    limits = min(4e-6, positive.min() / 2), max(1.2, 2 * positive.max())
    ax.set(xscale="log", yscale="log", ylim=limits if len(positive) else (4e-6, 1.2))
    ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{100 * value:g}"))
    ax.xaxis.set_minor_formatter(NullFormatter())
    ax.tick_params(axis="x", which="minor", bottom=False)
    ticks = MEMORY_TICKS if cost == MEMORY else TIMES
    ax.set_xticks(list(ticks), list(ticks.values()))
    begin = BESIDE if cost == SOLVE else 0
    ax.axhline(WANTED, begin, color=SOFT, linewidth=0.8, linestyle=(0, (4, 2)))


def _ring() -> dict[str, Any]:
    return {
        "linestyle": "",
        "marker": "o",
        "markersize": 12,
        "fillstyle": "none",
        "color": "#d55e00",
        "markeredgewidth": 1.6,
        "zorder": 4,
    }


def _label_seconds(ax: Any, rows: pd.DataFrame) -> None:
    """Names beside the lines, and the paper."""
    for model, own in rows[rows[SOLVE].notna() & rows[ERROR].notna()].groupby("model"):
        default = own[own["mesh"] == DEFAULT] if len(own) > 1 else own
        one = (default if len(default) else own).iloc[0]
        text, where, side = TEXT[str(model)]
        ax.annotate(
            text.format(100 * one["modelling_error [1]"]),
            (one[SOLVE], one[ERROR]),
            where,
            textcoords="offset points",
            color=COLOURS[str(model)],
            fontsize=8,
            ha=side,
            va="center",
        )
    ax.plot(*PAPER, "*", color="#d55e00", markersize=13, zorder=4)
    text = "the paper: 27 min a case,\n−9.9 % from Festo's map"
    ax.annotate(text, PAPER, (12, 9), textcoords="offset points", ha="right", fontsize=7.5)
    ax.plot([], [], **_ring(), label="default mesh")
    ax.plot([], [], color="0.85", linewidth=7, label="frontier: nothing is cheaper and better")
    ax.legend(loc="lower left", fontsize=7.5, handlelength=1.8)
    ax.set_xlim(2e-5, 4 * PAPER[0])
    right = {"transform": ax.get_yaxis_transform(), "ha": "right", "fontsize": 7}
    ax.text(0.99, WANTED, "a quarter of a per cent", color=SOFT, va="bottom", **right)


def _maps(ax: Any, rows: pd.DataFrame) -> None:
    """How far the fullest model itself is from what was measured, whatever the mesh."""
    fullest = rows[rows["model"] == "solid"].sort_values("refinement").iloc[-1]
    found = {
        name: abs(fullest[f"{name}_share [1]"])
        for name in ("martens2017", "festo_musclesim")
        if f"{name}_share [1]" in rows
    }
    above = max(found.values(), default=0.0)
    for row, (name, value) in enumerate(found.items()):
        look = SOURCES[name]
        ax.axhline(value, BESIDE, color=look["color"], linewidth=0.9, linestyle=":")
        text = f"solid from {look['label'].removesuffix(' 2017')}: {100 * value:.1f} %"
        left = {"transform": ax.get_yaxis_transform(), "fontsize": 7, "va": "bottom"}
        ax.text(BESIDE, above * 1.04 * 1.4**row, text, color=look["color"], **left)


def _split(ax: Any, rows: pd.DataFrame) -> None:
    """Shares of the seconds of some curves, from the mesh to the record."""
    names = []
    for k, (model, mesh) in enumerate(BARS):
        found = rows[(rows["model"] == model) & (rows["mesh"] == mesh)]
        if found.empty or found[SOLVE].isna().all():
            continue
        one = found.iloc[0]
        spent = {part: float(np.nan_to_num(one.get(part, 0.0))) for part in PART_STYLE}
        total, left = sum(spent.values()), 0.0
        for part, seconds in spent.items():
            look = PART_STYLE[part]
            label = PARTS[part] if k == 0 else None
            ax.barh(k, seconds / total, left=left, color=look["color"], label=label, height=0.7)
            left += seconds / total
        ax.text(1.01, k, f"{total:.2g} s", va="center", fontsize=8)
        names.append((k, f"{model}" if mesh == DEFAULT else f"{model}\n{mesh}"))
    ax.set_yticks([k for k, _ in names], [name for _, name in names], fontsize=7.5)
    ax.tick_params(axis="y", length=0, pad=2)
    ax.invert_yaxis()
    ax.set_xlim(0, 1.08)
    style.percent(ax.xaxis, 0.25)
    ax.set_xlabel("share of the CPU seconds, from the mesh to the record [%]")
    ax.set_title("where the seconds go")
    ax.spines[:].set_visible(False)
    ax.grid(visible=False)
    ax.legend(
        loc="lower right", bbox_to_anchor=(1.02, 1.0), ncol=4, fontsize=7, handlelength=1,
        columnspacing=1, borderaxespad=0.1,
    )  # fmt: skip


def _small_print(known: pd.DataFrame) -> str:
    """What the axes cannot say."""
    laws = growth(known)
    text = (
        f"{_missing(known[known['set'] == 'mesh'])}{MUSCLE}, 0.3 MPa, 0 to 20 %. "
        "The error is the largest difference from what the fullest model "
        "(solid) converges to, discretisation and modelling together. "
    )
    if RELATIVE in known:
        text += (
            "Dotted: mean difference of that model from force maps, as a share of their largest "
            f"force; the paper's is relative, {_relative(known)} for ours. "
        )
    for model in ("membrane", "solid"):
        own = laws[laws["model"] == model].set_index(["quantity", "against"])["exponent [1]"]
        if own.size:
            seconds = own["after start [s]", "unknowns [1]"]
            memory, states = own[MEMORY, "unknowns [1]"], own["after start [s]", "states"]
            text += (
                f"{model.capitalize()}: seconds grow as unknowns^{seconds:.2f} and "
                f"states^{states:.2f}, memory as unknowns^{memory:.2f}. "
            )
    return text


def _relative(known: pd.DataFrame) -> str:
    """Mean relative deviation of the default solid from the manufacturer's map."""
    ours = known[(known["set"] == "mesh") & (known["model"] == "solid")]
    value = ours.loc[ours["mesh"] == DEFAULT, RELATIVE].mean()
    if not np.isfinite(value):
        return "not known"
    return f"{100 * value:.1f} %".replace("-", "−")


def _missing(rows: pd.DataFrame) -> str:
    """Meshes of which error, seconds or memory is not known; Eq. (1) and the cylinder need none."""
    lost = rows.assign(error=rows[ERROR].where(rows[ERROR] > 0))
    said = undrawn.without_value(lost, "error", ["model", "mesh"])
    unknown = undrawn.without_value(rows, SOLVE, ["model", "mesh"])
    text = [undrawn.sentence(said, "No error of"), undrawn.sentence(unknown, "No seconds of")]
    return "".join(f"{sentence} " for sentence in text if sentence)


def orders(table: pd.DataFrame) -> Figure:
    """Discretisation error by refinement with observed orders; errors by Newton tolerance."""
    figure, axes = style.panels(style.FULL, 3.6, 1, 2, gap=(0.75, 0.3), right=0.6)
    _by_refinement(axes[0, 0], table)
    _by_tolerance(axes[0, 1], table)
    steps = table[table["set"] == "steps"]
    lost = _without_error(table)
    if len(steps):
        _note(
            figure,
            f"{lost}Steps along the path, of {100 * min(STEPS):g} to {100 * max(STEPS):g} % of "
            "contraction, decide what a curve costs and not what it is: its forces differ by at "
            f"most {100 * steps['force_error [1]'].max():.0e} %. All elements are quadratic.",
        )
    return figure


def _without_error(table: pd.DataFrame) -> str:
    """Meshes and tolerances of which no error is known; the strictest one has none."""
    families = [
        table["set"].eq(chosen) & table["model"].eq(model) for chosen, model, *_ in FAMILIES
    ]
    meshes = table[np.any(families, axis=0) & (table["refinement"] > 0)]
    strict = table["tolerance"] > table["tolerance"].min()
    tolerances = table[(table["set"] == "tolerance") & strict].assign(of="tolerance")
    said = undrawn.without_value(meshes, "force_error [1]", ["set", "model", "mesh"])
    said += undrawn.without_value(tolerances, "force_error [1]", ["model", "of", "tolerance"])
    text = undrawn.sentence(said, "No error of")
    return f"{text} " if text else ""


def _by_refinement(ax: Any, table: pd.DataFrame) -> None:
    for chosen, model, colour, marker, name in FAMILIES:
        rows = table[(table["set"] == chosen) & (table["model"] == model)]
        rows = rows[rows["refinement"] > 0].sort_values("refinement")
        if rows.empty:
            continue
        order = rows["force_order [1]"].iloc[0]
        look = {"color": colour, "marker": marker, "linewidth": 1.2}
        ax.plot(rows["refinement"], 100 * rows["force_error [1]"], **look)
        known = rows[rows["force_error [1]"] > 0]
        if known.empty:
            continue
        last = known.iloc[-1]
        seen = f"order {order:.1f}" if np.isfinite(order) else "no order"
        ax.annotate(
            f"{name}:\n{seen}{THEORY.get(name, '')}",
            (last["refinement"], 100 * last["force_error [1]"]),
            (7, {"butt": 10, "mesh": -3}.get(chosen, 0)),
            textcoords="offset points",
            color=colour,
            fontsize=7.5,
            va="center",
        )
    ax.axhline(100 * WANTED, color=SOFT, linewidth=0.8, linestyle=(0, (4, 2)))
    ax.set(xscale="log", yscale="log", xlabel="elements of the default mesh cut into")
    ax.set_xticks([1, 2, 3, 4, 6, 8])
    ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    ax.xaxis.set_minor_formatter(NullFormatter())
    ax.set_ylabel("discretisation error of the force [% of the largest]")
    ax.set_title("meshes, and observed orders")
    ax.set_xlim(0.9, 40)
    ax.tick_params(axis="x", which="minor", bottom=False)


def _by_tolerance(ax: Any, table: pd.DataFrame) -> None:
    beside = ax.twinx()
    for model in ("membrane", "solid"):
        rows = table[(table["set"] == "tolerance") & (table["model"] == model)]
        rows = rows.sort_values("tolerance")
        look = {"color": COLOURS[model], "marker": MARKERS[model], "linewidth": 1.2}
        errors = rows["force_error [1]"].where(rows["force_error [1]"] > 0)
        ax.plot(rows["tolerance"], 100 * errors, label=f"{model}: error", **look)
        look |= {"linestyle": (0, (1, 1.5)), "markersize": 2.5}
        beside.plot(rows["tolerance"], rows["iterations [1]"], **look, label="_iterations")
    ax.axvline(1e-9, color=SOFT, linewidth=0.8, linestyle=(0, (4, 2)))
    ax.text(1e-9, 2e-10, " default", fontsize=7, color=SOFT, va="bottom")
    ax.set(xscale="log", yscale="log", xlabel="tolerance")
    errors = 100 * table.loc[table["set"] == "tolerance", "force_error [1]"]
    errors = errors[errors > 0]
    within = (1e-10, 10.0) if errors.empty else (errors.min() / 2, 2 * errors.max())
    ax.set_ylim(min(1e-10, within[0]), max(10.0, within[1]))
    ax.set_ylabel("error of the force [% of the largest]")
    ax.set_title("tolerance of Newton's method")
    ax.legend(loc="upper left", fontsize=7, handlelength=1.8)
    beside.set_ylabel("iterations of the curve (dotted)")
    most = table.loc[table["set"] == "tolerance", "iterations [1]"].max()
    beside.set_ylim(0, max(250, 1.1 * most))
    beside.set_yticks([0, 50, 100])
    beside.grid(visible=False)
    beside.spines["right"].set_visible(True)
