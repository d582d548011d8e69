"""Figure of the analysis of effects: what leaving one out changes, and what it saves, by regime."""

from collections.abc import Mapping, Sequence

import pandas as pd
from matplotlib.figure import Figure

from workflow.analyses.analysis import Solved
from workflow.figures import style

REGIMES = {
    "normal": {"color": "black", "marker": "o"},
    "low pressure": {"color": "#0072b2", "marker": "v"},
    "high contraction": {"color": "#d55e00", "marker": "^"},
    "thick silicone": {"color": "#009e73", "marker": "s"},
    "stiff threads": {"color": "#cc79a7", "marker": "D"},
}
NAMES = {"all but pressure on the net": "all but the net (Eq. 1)"}
SMALLEST = 1e-5  # share; smaller changes are drawn at this one, as the axis is logarithmic


def draw(solved: Sequence[Solved], tables: Mapping[str, pd.DataFrame]) -> dict[str, Figure]:
    """The one figure."""
    return {"effects": overview(tables["effects"])}


def overview(table: pd.DataFrame) -> Figure:
    """Left the change of force at constant pressure, right the work that is left."""
    rows = table[table["path"] == "isobaric"]
    effects = list(dict.fromkeys(rows["effect"]))
    height = {effect: len(effects) - 1 - k for k, effect in enumerate(effects)}
    figure = Figure(figsize=(style.FULL, 0.9 + 0.3 * len(effects)), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True, width_ratios=[3, 2])
    for k, (regime, look) in enumerate(REGIMES.items()):
        here = rows[rows["regime"] == regime]
        places = here["effect"].map(height) + 0.24 - 0.12 * k
        change = here["force"].clip(lower=SMALLEST)
        cut = here["missing"] > 0
        left.plot(change[~cut], places[~cut], linestyle="", label=regime, **look)
        left.plot(change[cut], places[cut], linestyle="", fillstyle="none", **look)
        work = here["work_without"] / here["work_with"]
        right.plot(work, places, linestyle="", **look)
    left.set_yticks(list(height.values()), [NAMES.get(e, e.replace("_", " ")) for e in effects])
    left.set(xscale="log", xlabel="largest change of force, share of the curve's largest")
    left.set_title("changed by leaving it out (open: states lost)")
    right.set(xscale="log", xlabel="unknowns × iterations, share left")
    right.set_title("work left")
    right.axvline(1, color=style.SOFT, linewidth=0.8)
    unknown = rows[rows["force"].isna()]
    if len(unknown):
        each = ", ".join(f"{row['effect']} ({row['regime']})" for _, row in unknown.iterrows())
        right.set_title(f"work left\nno force to compare: {each}", fontsize=7, wrap=True)
    figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=5)
    return figure
