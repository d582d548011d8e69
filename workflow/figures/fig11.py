"""Force of the wider muscles over that of the narrowest, against contraction (claim C7).

The ratio means nothing where the narrowest muscle hardly pulls: there the curves go on as dots
without bands. The axis is logarithmic, as a ratio's is, so that one spike does not hide the rest;
a ratio that is not positive has no place on it and is named below.
"""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from workflow.data import paper
from workflow.data.scene_data import (
    CONTRACTION,
    DIAMETER,
    FLAGS,
    FORCE,
    PRESSURE,
    THREADS,
    error_of,
)
from workflow.data.states import GOOD
from workflow.figures import curves, force_contraction
from workflow.figures.labels import SERIES, constants, muscles
from workflow.figures.style import COLUMN_WIDTH, panels, percent
from workflow.study.errors import StudyError

RATIO = "force / force of the narrowest [1]"
SHARE = "force of the narrowest / its largest [1]"
NARROWEST = "narrowest"
RELATIVE = "discretisation error / force [1]"
SMALL = 0.1  # of the narrowest muscle's largest force: below, the ratio means nothing
CURVE = ["source", "variant", PRESSURE]
PAPER = "the paper's ratio [1]"
TICKS = (1, 2, 3, 4, 6, 10, 20, 40, 100)  # and their decades
BEYOND = 100.0  # further than the largest sound ratio no dots are followed


def table(data: Any) -> pd.DataFrame:
    """Ratios of all muscles but the narrowest; a state counts as the worse of the two."""
    every = force_contraction.table(data, [DIAMETER, THREADS])
    if len(data.muscles) < 2:
        raise StudyError(f"scenes.{data.name}.muscles: a ratio needs at least two muscles")
    narrowest = min(data.muscles, key=lambda name: (data.muscles[name].inner_diameter, name))
    every[SHARE] = every[FORCE] / every.groupby([*CURVE, "muscle"])[FORCE].transform("max")
    at = [*CURVE, CONTRACTION]
    every[RELATIVE] = every[error_of(FORCE)] / every[FORCE].abs()
    used = [FORCE, RELATIVE, "status", FLAGS]
    base = every[every["muscle"] == narrowest][[*at, *used, SHARE, SERIES]]
    wider = every[every["muscle"] != narrowest].drop(columns=SHARE)
    both = wider.merge(base, "left", at, suffixes=("", f" {NARROWEST}"))
    worse = both["status"].where(both["status"] != GOOD, both[f"status {NARROWEST}"])
    both = both.rename(columns={f"{SERIES} {NARROWEST}": NARROWEST})
    unnamed = [narrowest not in name.split(", ") for name in both[NARROWEST]]
    both[NARROWEST] += np.where(unnamed, f" ({narrowest})", "")
    pulls = both[f"{FORCE} {NARROWEST}"].where(both[f"{FORCE} {NARROWEST}"] > 0)
    ratio = both[FORCE] / pulls  # of two muscles that push it would look like one of two that pull
    relative = both[RELATIVE] + both[f"{RELATIVE} {NARROWEST}"]
    known = {RATIO: ratio, error_of(RATIO): ratio.abs() * relative, "status": worse}
    flags = both[FLAGS].fillna("") + " " + both[f"{FLAGS} {NARROWEST}"].fillna("")
    known[FLAGS] = flags.map(lambda words: " ".join(sorted(set(words.split()))))
    wide = [name for name, muscle in data.studied.items() if paper.is_wide(muscle)]
    stated = (
        paper.is_normal(data.studied[narrowest])
        & both["muscle"].isin(wide)
        & np.isclose(both[CONTRACTION], paper.AT_RATIO)
        & np.isclose(both[PRESSURE], paper.AT_PRESSURE)
    )
    known[PAPER] = np.where(stated, paper.RATIO, np.nan)
    return both.assign(**known).drop(
        columns=[error_of(FORCE), FORCE, RELATIVE, *(f"{name} {NARROWEST}" for name in used)]
    )


def draw(table: pd.DataFrame) -> Figure:
    """One curve per wider muscle and model."""
    figure, axes = panels(COLUMN_WIDTH, 3.4)
    ax = axes[0, 0]
    narrowest = table[NARROWEST].iloc[0]
    sound = table[SHARE] >= SMALL
    ax.set_yscale("log", nonpositive="mask")  # first: curves must know what has no place on it
    dots = {"linewidth": 1.0, "linestyle": (0, (1, 2)), "marker": "", "alpha": 1}
    curves.by_series(ax, table.drop(columns=error_of(RATIO)), CONTRACTION, RATIO, **dots)
    curves.by_series(ax, table.assign(**{RATIO: table[RATIO].where(sound)}), CONTRACTION, RATIO)
    _scale(ax, table[RATIO].where(sound), table[RATIO], table[PAPER])
    low, high = table[CONTRACTION].min(), table[CONTRACTION].max()
    if low < high:
        ax.set_xlim(low, high)
    for _, stated in table[table[PAPER].notna()].iterrows():
        place, beside = (stated[CONTRACTION], stated[PAPER]), {"ha": "right", "va": "center"}
        ax.plot(*place, "k*", markersize=8)
        text = f"the paper's {stated[PAPER]:g}"
        ax.annotate(text, place, (-6, 0), textcoords="offset points", **beside)
        break
    ax.set_title(constants(table, ["muscle", PRESSURE]))
    ax.set_xlabel("contraction [%]")
    ax.set_ylabel(f"force over that of\n{narrowest} [1], logarithmic")
    percent(ax.xaxis, 0.05)
    curves.series_legend(figure, table)
    text = f"{muscles(table)} There is a ratio where {narrowest} pulls."
    if (~sound & (table[RATIO] > 0)).any():
        text += f" Dotted: {narrowest} pulls with less than a tenth of its largest force."
    curves.note_gaps(figure, table, [SERIES], CONTRACTION, text.strip(), y=RATIO, log=True)
    return figure


def _scale(ax: Any, sound: pd.Series, ratio: pd.Series, stated: pd.Series) -> None:
    """Limits that show all ratios that mean something, and of the others those not far beyond."""
    shown = pd.concat([sound[sound > 0], stated.dropna()])
    shown = shown if len(shown) else ratio[ratio > 0]
    if shown.empty:
        return
    low, high = shown.min(), shown.max()
    others = ratio[(ratio > low / BEYOND) & (ratio < high * BEYOND)]
    low, high = min(low, others.min()), max(high, others.max())
    ticks = sorted({tick * 10.0**k for tick in TICKS for k in range(-12, 13)})
    below = max(tick for tick in ticks if tick <= low)
    above = min(tick for tick in ticks if tick >= high)
    ticks = [tick for tick in ticks if below <= tick <= above]
    every = max(1, len(ticks) // 8)
    ax.set_yticks(ticks[::every], [f"{tick:g}" for tick in ticks[::every]])
    ax.set_ylim(below, above if above > below else 10 * below)
    ax.yaxis.set_minor_locator(NullLocator())
