"""Largest principal Cauchy stress on the deformed wall, whole and near the cap (claim C2).

A whole muscle is drawn as engineers do: above the axis the cut wall, below it the outside, coloured
by the stress of the outer surface. White is zero; blue is compression, which is hatched near the
cap. The lines below say the same in numbers.
"""

from typing import Any

import pandas as pd
from matplotlib.cm import ScalarMappable
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure

from workflow.data.states import CONTRACTION, GOOD, NUMBER, PRESSURE, of_curve
from workflow.data.stress import LARGEST, along_meridian, wall
from workflow.figures import curves, stress_views
from workflow.figures.labels import SERIES, series
from workflow.figures.stress_views import CAP, COLOURS
from workflow.figures.style import FULL, grid


def table(data: Any) -> pd.DataFrame:
    """Corners of all triangles and values along the meridian; of a failed state one row."""
    frames = []
    for solved in data.solutions:
        for _, state in of_curve(data.scene, ["contraction"], *solved).iterrows():
            fields = solved[-1].fields.get(state[NUMBER], {})
            drawn = pd.DataFrame({"where": ["nothing"]})
            if state["status"] == GOOD and "stress" in fields:
                corners = wall(fields)
                drawn = pd.concat([corners, along_meridian(corners)], ignore_index=True)
            half = data.muscles[state["muscle"]].length / 2
            cap = half * (1 - state[CONTRACTION])
            frames.append(drawn.assign(**state.drop([NUMBER, "point"]), **{CAP: cap}))
    every = pd.concat(frames, ignore_index=True)
    every[SERIES] = series(every, [PRESSURE, CONTRACTION])
    return every


def draw(table: pd.DataFrame) -> Figure:
    """One row per state for the whole muscle; below them, one column per state for its cap."""
    shown = table[table["where"] != "nothing"]
    states = [state for _, state in shown.groupby(SERIES, sort=False)]
    count = max(1, len(states))
    heights, widths = [0.75] * count + [0.75, 1.5], [1.0] * count + [0.05]
    figure, places = grid(
        FULL,
        sum(heights) + 0.3 * count + 1.2,
        count + 2,
        count + 1,
        height_ratios=heights,
        width_ratios=widths,
        gap=(0.15, 0.27),
        right=0.75,
    )
    if states:
        norm = _norm(shown[LARGEST])
        bar = figure.colorbar(ScalarMappable(norm, COLOURS), figure.add_subplot(places[:count, -1]))
        bar.set_label("largest principal\nstress [MPa]")
    first = None
    for number, state in enumerate(states):
        stress_views.whole(
            figure.add_subplot(places[number, :-1]), state, norm, number == count - 1
        )
        near = figure.add_subplot(places[count, number])
        first = figure.add_subplot(places[count + 1, number], sharex=near, sharey=first)
        stress_views.near_cap(near, state, norm)
        stress_views.along(first, state)
        if number == 0:
            first.legend(loc="lower left", bbox_to_anchor=(-0.05, 0.98), ncol=4, columnspacing=1.0)
    curves.note_gaps(figure, table, [SERIES], CONTRACTION)
    return figure


def _norm(stress: pd.Series) -> TwoSlopeNorm:
    """White at zero; both ends of the map are used."""
    high = max(stress.max(), 1e-6)
    return TwoSlopeNorm(0, min(stress.min(), -0.01 * high), high)
