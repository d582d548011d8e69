"""Figure of promises: what was promised against what is true, and cost against hindsight."""

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from workflow.analyses.analysis import Solved
from workflow.analyses.promise.cases import TOLERANCES
from workflow.analyses.promise.table import NONE
from workflow.figures import style

LOOKS = (  # of tolerances
    {"color": "#0072b2", "marker": "o"},
    {"color": "#009e73", "marker": "s"},
    {"color": "#d55e00", "marker": "^"},
    {"color": "black", "marker": "D"},
)
SMALLEST = 1e-6  # share; smaller errors are drawn at this one, as the axis is logarithmic


def draw(solved: Sequence[Solved], tables: Mapping[str, pd.DataFrame]) -> dict[str, Figure]:
    """The one figure."""
    return {"promise": overview(tables["promise"], tables["promise_summary"])}


def overview(choices: pd.DataFrame, summary: pd.DataFrame) -> Figure:
    """Left errors of the choices, right seconds of the curves; in words what they come to."""
    figure = Figure(figsize=(style.FULL, 4.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    for tolerance, look in zip(TOLERANCES, LOOKS, strict=True):
        here = choices[(choices["tolerance [1]"] == tolerance) & choices["promised"]]
        errors = here["true_error [1]"].clip(lower=SMALLEST)
        left.plot(
            errors,
            here["promised_error [1]"],
            linestyle="",
            markersize=3,
            **look,
            label=f"within {100 * tolerance:g} %",
        )
        left.axvline(tolerance, color=look["color"], linewidth=0.5)
    ends = np.array([SMALLEST, 0.1])
    left.plot(ends, ends, color=style.SOFT, linewidth=0.8)
    left.set(xscale="log", yscale="log", xlabel="true error, share of the largest value")
    left.set_ylabel("promised error")
    curves = choices.drop_duplicates("curve")
    curves = curves[curves["dearest"] != NONE]
    solid = curves["dearest"].str.startswith("solid")
    for name, part, color in (
        ("a solid", curves[solid], "black"),
        ("another", curves[~solid], "#0072b2"),
    ):
        right.plot(
            part["hindsight_seconds [s]"],
            part["curve_seconds [s]"],
            ".",
            color=color,
            label=f"dearest with hindsight {name}",
        )
    if len(curves):
        far = curves[["hindsight_seconds [s]", "curve_seconds [s]"]].to_numpy()
        ends = np.array([far.min(), far.max()])
        right.plot(ends, ends, color=style.SOFT, linewidth=0.8)
    right.set(xscale="log", yscale="log", xlabel="cheapest with hindsight [s]", ylabel="taken [s]")
    of_all = summary[summary["choices"] == "all"].iloc[0]
    left.set_title(
        f"{of_all['count']:.0f} choices, {of_all['missed']:.0f} missed, "
        f"{of_all['not_promised']:.0f} not promised;\nmedian overestimate "
        f"{of_all['median_overestimate [1]']:.2g}, worst {of_all['worst [1]']:.2g} of the tolerance"
    )
    ratios = summary.dropna(subset=["cost_ratio [1]"])
    right.set_title(
        "\n".join(
            f"{row['choices']}: {row['cost_ratio [1]']:.2f} times" for _, row in ratios.iterrows()
        )
    )
    left.legend(), right.legend()
    return figure
