"""Forces before and after a calibration, and what is left of the measured ones."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib import colormaps
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

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
LOOKS = {1: {"marker": "o", "zorder": 3}, 0: {"marker": "o", "zorder": 2}}  # fitted or not
SHADES, LIGHTEST = colormaps["Greys"], 0.45  # by pressure, the lowest not white
CORNER = {"ha": "right", "va": "top", "fontsize": 7.5}


def draw(solved: Sequence[Solved], tables: Mapping[str, pd.DataFrame]) -> dict[str, Figure]:
    """Curves before and after, and what is left at every measured point."""
    return {
        "calibration": overview(tables["calibration_states"]),
        "calibration_residuals": residuals(tables["calibration_residuals"]),
    }


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
    said = undrawn.sentence(_lost(states), "Without a valid state")
    curves.note(figure, f"{said} {undrawn.sentence(_unmeasured(states), 'Not measured')}".strip())
    return figure


def residuals(points: pd.DataFrame) -> Figure:
    """Computed minus measured force at every measured point, one panel per calibration."""
    calibrations = list(points.groupby("calibration", sort=False))
    figure, axes = panels(FULL, 1.1 + 1.9 * len(calibrations), len(calibrations), 1, gap=(0.5, 0.4))
    low, high = points["pressure"].min(), points["pressure"].max()
    for ax, (name, table) in zip(axes[:, 0], calibrations, strict=True):
        for fitted, look in LOOKS.items():
            here = table[(table["fitted"] == fitted) & np.isfinite(table["residual"])]
            shade = LIGHTEST + (1 - LIGHTEST) * (here["pressure"] - low) / max(high - low, 1e-9)
            colors = SHADES(shade.to_numpy())
            face = {"facecolors": colors if fitted else "none", "edgecolors": colors}
            ax.scatter(here["contraction"], here["residual"], s=14, linewidths=0.8, **face, **look)
        ax.axhline(0, color="black", linewidth=0.7)
        ax.set_title(name)
        ax.set_ylabel("computed − measured [N]")
        percent(ax.xaxis, 0.05)
    axes[-1, 0].set_xlabel("contraction [%]")
    dot: dict[str, Any] = {"linestyle": "none", "marker": "o"}
    grey = [Line2D([], [], color="0.3", mfc=mfc, **dot, label=label)
            for mfc, label in (("0.3", "fitted"), ("none", "not fitted"))
            if label == "fitted" or (~points["fitted"].astype(bool)).any()]  # fmt: skip
    ends = [
        Line2D([], [], color=SHADES(at), **dot, label=f"{pressure:.4g} MPa")
        for at, pressure in ((LIGHTEST, low), (1.0, high))
    ]
    legend(figure, grey, ends)
    lost = points.assign(what="measured at", unit=np.where(points["held"] == "isobaric", "MPa", ""))
    by = ["calibration", "what", "set_at", "unit"]
    curves.note(figure, undrawn.sentence(undrawn.without_value(lost, "residual", by, "points")))
    return figure


def _lost(states: pd.DataFrame) -> list[str]:
    """Forces that a model has not."""
    by = ["calibration", "values", "by", "model", "unit", "pressure", "mpa"]
    named = states.assign(by="by", unit="at", mpa="MPa")
    return undrawn.without_value(named, "force", by, "states")


def _unmeasured(states: pd.DataFrame) -> list[str]:
    """Forces that the measurement has not."""
    first = states.drop_duplicates(["calibration", "pressure", "contraction"])
    by = ["calibration", "unit", "pressure", "mpa"]
    named = first.assign(unit="at", mpa="MPa")
    return undrawn.without_value(named, "reference", by, "contractions")
