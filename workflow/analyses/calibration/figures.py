"""Forces before and after a calibration, over those it was fitted to and those it was not."""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from workflow.analyses import undrawn
from workflow.analyses.analysis import Solved
from workflow.figures import curves
from workflow.figures.style import FULL, SERIES, labelled, legend, panels, percent

REFERENCE = {"color": "0.3", "marker": "s", "linestyle": "none", "label": "reference"}
CURVES = {  # values, whether the model of the fit: style
    ("before", True): {"color": "0.6", "linestyle": (0, (5, 2)), "label": "before"},
    ("after", True): {"color": SERIES[0]["color"], "label": "after"},
    ("after", False): {
        "color": SERIES[1]["color"],
        "linestyle": "none",
        "marker": "x",
        "label": "after, by the solid",
    },
}
CORNER = {"ha": "right", "va": "top", "fontsize": 7.5}


def draw(solved: Sequence[Solved], tables: Mapping[str, pd.DataFrame]) -> dict[str, Figure]:
    """The one figure."""
    return {"calibration": overview(tables["calibration_states"])}


def overview(states: pd.DataFrame) -> Figure:
    """One row per calibration, one column per pressure."""
    calibrations = list(states.groupby("calibration", sort=False))
    columns = max(table["pressure"].nunique() for _, table in calibrations)
    count = len(calibrations)
    shared: dict[str, Any] = {"sharex": True, "sharey": "row", "gap": (0.16, 0.4)}
    figure, axes = panels(FULL, 1.1 + 1.7 * count, count, columns, **shared)
    for row, (name, table) in zip(axes, calibrations, strict=True):
        for ax, (pressure, here) in zip(row, table.groupby("pressure"), strict=False):
            first = here.drop_duplicates("contraction")
            ax.plot(first["contraction"], first["reference"], **REFERENCE)
            for (when, of_fit), style in CURVES.items():
                of_model = (here["model"] == here["fitted_by"]) == of_fit
                chosen = here[(here["values"] == when) & of_model]
                ax.plot(chosen["contraction"], chosen["force"], **style)
            ax.axhline(0, color="black", linewidth=0.7)
            fitted = "fitted" if here["role"].iloc[0] == "fit" else "not fitted"
            ax.set_title(f"{pressure:g} MPa, {fitted}")
            percent(ax.xaxis, 0.05)
        for ax in row[table["pressure"].nunique() :]:
            ax.set_axis_off()
        row[0].set_ylabel("force [N]")
        row[0].annotate(name, (0.98, 0.96), xycoords="axes fraction", **CORNER)
    for ax in axes[-1]:
        ax.set_xlabel("contraction [%]")
    legend(figure, labelled(axes))
    curves.note(figure, undrawn.sentence(_missing(states)))
    return figure


def _missing(states: pd.DataFrame) -> list[str]:
    """Forces that no model, or no measurement, has."""
    by = ["calibration", "values", "model", "unit", "pressure", "mpa"]
    found = undrawn.without_value(states.assign(unit="at", mpa="MPa"), "force", by)
    first = states.drop_duplicates(["calibration", "pressure", "contraction"])
    named = first.assign(what="reference at", mpa="MPa")
    return found + undrawn.without_value(
        named, "reference", ["calibration", "what", "pressure", "mpa"]
    )
