"""Force of the wider muscles over that of the narrowest, against contraction (claim C7).

The ratio means nothing where the narrowest muscle hardly pulls: there the curves go on as dots on
a shaded ground. The axis is logarithmic, as a ratio's is, so that one spike does not hide the rest.
"""

from typing import Any

import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from workflow.data.states import CONTRACTION, DIAMETER, FORCE, GOOD, PRESSURE, THREADS, error_of
from workflow.figures import curves, force_contraction
from workflow.figures.labels import SERIES, constants
from workflow.figures.style import COLUMN_WIDTH, panels, percent
from workflow.study.errors import StudyError

RATIO = "force / force of the narrowest [1]"
SHARE = "force of the narrowest / its largest [1]"
NARROWEST = "narrowest"
RELATIVE = "discretisation error / force [1]"
SMALL = 0.1  # of the narrowest muscle's largest force: below, the ratio means nothing
CURVE = ["source", "variant", PRESSURE]
PAPER = (0.20, 34.5)  # contraction, ratio
TICKS = (1, 2, 3, 4, 6, 10, 20, 40, 100)


def table(data: Any) -> pd.DataFrame:
    """Ratios of all muscles but the narrowest; a state counts as the worse of the two."""
    every = force_contraction.table(data, [DIAMETER, THREADS])
    if len(data.muscles) < 2:
        raise StudyError(f"scenes.{data.name}.muscles: a ratio needs at least two muscles")
    narrowest = min(data.muscles, key=lambda name: (data.muscles[name].inner_diameter, name))
    every[SHARE] = every[FORCE] / every.groupby([*CURVE, "muscle"])[FORCE].transform("max")
    at = [*CURVE, CONTRACTION]
    every[RELATIVE] = every[error_of(FORCE)] / every[FORCE].abs()
    base = every[every["muscle"] == narrowest][[*at, FORCE, RELATIVE, SHARE, "status", SERIES]]
    wider = every[every["muscle"] != narrowest].drop(columns=SHARE)
    both = wider.merge(base, "left", at, suffixes=("", f" {NARROWEST}"))
    worse = both["status"].where(both["status"] != GOOD, both[f"status {NARROWEST}"])
    both = both.rename(columns={f"{SERIES} {NARROWEST}": NARROWEST})
    ratio = both[FORCE] / both[f"{FORCE} {NARROWEST}"]
    relative = both[RELATIVE] + both[f"{RELATIVE} {NARROWEST}"]
    known = {RATIO: ratio, error_of(RATIO): ratio.abs() * relative, "status": worse}
    used = [FORCE, RELATIVE, "status"]
    return both.assign(**known).drop(
        columns=[error_of(FORCE), FORCE, RELATIVE, *(f"{name} {NARROWEST}" for name in used)]
    )


def draw(table: pd.DataFrame) -> Figure:
    """One curve per wider muscle and model."""
    figure, axes = panels(COLUMN_WIDTH, 3.4)
    ax = axes[0, 0]
    narrowest = table[NARROWEST].iloc[0]
    sound = table[SHARE] >= SMALL
    dots = {"linewidth": 1.0, "linestyle": (0, (1, 2)), "marker": "", "alpha": 1}
    curves.by_series(ax, table, CONTRACTION, RATIO, **dots)
    curves.by_series(ax, table.assign(**{RATIO: table[RATIO].where(sound)}), CONTRACTION, RATIO)
    ax.set_yscale("log", nonpositive="mask")
    ax.set_ylim(TICKS[0], TICKS[-1])
    ax.set_yticks(TICKS, map(str, TICKS))
    ax.yaxis.set_minor_locator(NullLocator())
    ax.set_xlim(table[CONTRACTION].min(), table[CONTRACTION].max())
    shaded = table.loc[~sound & (table["source"] != "geometric"), CONTRACTION]
    if len(shaded):
        ax.axvspan(shaded.min(), ax.get_xlim()[1], color="0.94", zorder=0)
    ax.plot(*PAPER, "k*", markersize=8)
    ax.annotate(
        f"the paper's {PAPER[1]:g}",
        PAPER,
        (-6, 0),
        textcoords="offset points",
        ha="right",
        va="center",
    )
    ax.set_title(constants(table, [PRESSURE]))
    ax.set_xlabel("contraction [%]")
    ax.set_ylabel(f"force over that of {narrowest}")
    percent(ax.xaxis, 0.05)
    curves.series_legend(figure, table)
    text = (
        f"Shaded: {narrowest} pull with less than a tenth of their largest force."
        if len(shaded)
        else ""
    )
    curves.note_gaps(figure, table, [SERIES], CONTRACTION, text)
    return figure
