"""Figure of promises: what was promised against what is true, and cost against hindsight."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from workflow.analyses.analysis import Solved
from workflow.analyses.promise.cases import TOLERANCES
from workflow.analyses.promise.table import NONE
from workflow.figures import curves, style

LOOKS = (  # of tolerances
    {"color": "#0072b2", "marker": "o"},
    {"color": "#009e73", "marker": "s"},
    {"color": "#d55e00", "marker": "^"},
    {"color": "black", "marker": "D"},
)
SMALLEST = 1e-6  # share; smaller errors are drawn at this one, as the axis is logarithmic
TAKEN, CHEAPEST = "curve_seconds [s]", "hindsight_seconds [s]"


def draw(solved: Sequence[Solved], tables: Mapping[str, pd.DataFrame]) -> dict[str, Figure]:
    """The one figure."""
    return {"promise": overview(tables["promise"], tables["promise_summary"])}


def overview(choices: pd.DataFrame, summary: pd.DataFrame) -> Figure:
    """Left errors of the choices, right seconds of the curves; in words what they come to."""
    figure, axes = style.panels(style.FULL, 3.4, 1, 2, gap=(0.8, 0.3))
    _errors(axes[0, 0], choices[choices["promised"]])
    _seconds(axes[0, 1], choices.drop_duplicates("curve"))
    curves.note(figure, _in_words(summary))
    return figure


def _errors(ax: Any, choices: pd.DataFrame) -> None:
    for tolerance, look in zip(TOLERANCES, LOOKS, strict=True):
        here = choices[choices["tolerance [1]"] == tolerance]
        true = here["true_error [1]"].clip(lower=SMALLEST)
        dots = {"linestyle": "", "markersize": 3, "label": f"{100 * tolerance:g} %"}
        ax.plot(true, here["promised_error [1]"], **look, **dots)
        ax.axvline(tolerance, color=look["color"], linewidth=0.5)
    ends = [SMALLEST, 0.1]
    ax.plot(ends, ends, color=style.SOFT, linewidth=0.8)
    ax.set(xscale="log", yscale="log", xlabel="true error, share of the largest value")
    ax.set_ylabel("promised error")
    ax.set_title("missed: right of the line of its tolerance")
    _legend(ax, "tolerance")


def _seconds(ax: Any, muscles: pd.DataFrame) -> None:
    muscles = muscles[muscles["dearest"] != NONE]
    solid = muscles["dearest"].str.startswith("solid")
    for name, part, color in (
        ("a solid", muscles[solid], "black"),
        ("another", muscles[~solid], "#0072b2"),
    ):
        ax.plot(part[CHEAPEST], part[TAKEN], ".", color=color, label=name)
    if len(muscles):
        far = muscles[[CHEAPEST, TAKEN]].to_numpy()
        ends = [far.min(), far.max()]
        ax.plot(ends, ends, color=style.SOFT, linewidth=0.8)
    ax.set(xscale="log", yscale="log", xlabel="cheapest with hindsight [s]", ylabel="taken [s]")
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())
    ax.set_title("processor time of a muscle")
    _legend(ax, "dearest with hindsight")


def _legend(ax: Any, title: str) -> None:
    look = {"fontsize": 7.5, "title_fontsize": 7.5, "frameon": True, "framealpha": 1.0}
    ax.legend(title=title, loc="lower right", **look, edgecolor="white")


def _in_words(summary: pd.DataFrame) -> str:
    of_all = summary[summary["choices"] == "all"].iloc[0]
    ratios = summary.dropna(subset=["cost_ratio [1]"])
    costs = (f"{row['choices']}: {row['cost_ratio [1]']:.2f} times" for _, row in ratios.iterrows())
    worst = of_all["worst [1]"]
    lost = "states lost" if np.isinf(worst) else f"{worst:.2g} times its tolerance"
    return (
        f"{of_all['count']:.0f} choices, {of_all['missed']:.0f} missed, "
        f"{of_all['not_promised']:.0f} not promised; median overestimate "
        f"{of_all['median_overestimate [1]']:.2g}, worst: {lost}. "
        f"Taken against hindsight, {'; '.join(costs)}."
    )
