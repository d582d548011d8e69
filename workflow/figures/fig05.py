"""Largest principal Cauchy stress on the deformed wall, whole and near the cap (claim C2).

A whole muscle is drawn as engineers do: above the axis the cut wall, below it the outside, coloured
by the stress of the outer surface. White is zero and the scale is linear; where the largest
principal stress is compression, the wall near the cap is hatched. The lines below say the same in
numbers.
"""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.cm import ScalarMappable
from matplotlib.colors import CenteredNorm
from matplotlib.figure import Figure

from workflow.data.scene_data import CONTRACTION, NUMBER, PRESSURE, STRENGTH, numbered
from workflow.data.states import GOOD, Table
from workflow.data.stress import LARGEST, along_meridian, wall
from workflow.figures import curves, stress_views
from workflow.figures.labels import SERIES, constants, series
from workflow.figures.stress_views import CAP, COLOURS, NOISE, WALL
from workflow.figures.style import FULL, grid

COLUMNS = 3  # of views near the cap
LEFT = "unstable_state"  # of a muscle that would not stay there: it is not drawn


def table(data: Any) -> pd.DataFrame:
    """Corners of all triangles and values along the meridian; of a failed state one row."""
    frames = []
    for curve in data.curves:
        of_curve = Table.of([curve], data.studied)
        for _, state in numbered(data.scene, of_curve, ["contraction"]).iterrows():
            fields = curve.solution.fields.get(state[NUMBER], {})
            drawn = pd.DataFrame({"where": ["nothing"]})
            if state["status"] == GOOD and _has_section(fields):
                corners = wall(fields)
                drawn = pd.concat([corners, along_meridian(corners)], ignore_index=True)
            muscle = data.muscles[state["muscle"]]
            cap = muscle.length / 2 * (1 - state[CONTRACTION])
            strength = data.studied[state["muscle"]].limits.thread_strength
            known = {CAP: cap, WALL: muscle.wall_thickness, STRENGTH: strength}
            frames.append(drawn.assign(**state.drop(NUMBER), **known))
    every = pd.concat(frames, ignore_index=True)
    every[SERIES] = series(every, ["muscle", PRESSURE, CONTRACTION])
    return every


def _has_section(fields: dict[str, Any]) -> bool:
    """Whether there is a stress in a wall of two dimensions; that of the cell has three."""
    return "stress" in fields and fields["corners"].shape[1] == 4


def draw(table: pd.DataFrame) -> Figure:
    """One row per state for the whole muscle; below them its cap, several beside each other."""
    shown = table[table["where"] != "nothing"]
    states = [state for _, state in shown.groupby(SERIES, sort=False)]
    count, columns = max(1, len(states)), min(max(1, len(states)), COLUMNS)
    blocks = -(-count // columns)
    heights = [0.75] * count + [0.85, 1.5] * blocks
    figure, places = grid(
        FULL,
        sum(heights) + 0.55 * len(heights) + 0.5,
        len(heights),
        columns + 1,
        height_ratios=heights,
        width_ratios=[1.0] * columns + [0.05],
        gap=(0.35, 0.55),
        right=0.75,
    )
    stress = shown[LARGEST] if states else pd.Series([0.0])
    low, high = stress.min(), stress.max()
    norm = CenteredNorm(0, max(abs(low), abs(high), 1e-12) if states else 1)
    if states:
        bar = figure.colorbar(ScalarMappable(norm, COLOURS), figure.add_subplot(places[:count, -1]))
        bar.ax.set_ylim(min(low, 0), max(high, 0))
        bar.set_label("largest principal stress [MPa]")
    first = None
    for number, state in enumerate(states):
        whole = figure.add_subplot(places[number, :-1])
        title = constants(state, ["muscle", PRESSURE, CONTRACTION])
        stress_views.whole(whole, state, norm, title)
        block, column = divmod(number, columns)
        near = figure.add_subplot(places[count + 2 * block, column])
        below = places[count + 2 * block + 1, column]
        first = figure.add_subplot(below, sharex=near, sharey=first)
        stress_views.near_cap(near, state, norm)
        stress_views.along(first, state)
        if number == 0:
            first.legend(loc="lower left", bbox_to_anchor=(-0.05, 0.98), ncol=4, columnspacing=1.0)
    said = table.drop_duplicates([SERIES, "source", "muscle", PRESSURE, CONTRACTION])
    curves.note_gaps(figure, _seen(said), [SERIES], CONTRACTION, _explained(shown, norm))
    return figure


def _seen(states: pd.DataFrame) -> pd.DataFrame:
    """Says of a state that has an equilibrium, and is not drawn, why."""
    nothing = states["where"] == "nothing"
    status = states["status"].mask(nothing & (states["status"] == GOOD), curves.NO_STRESS)
    return states.assign(status=status.mask(nothing & (status == curves.UNSTABLE), LEFT))


def _explained(shown: pd.DataFrame, norm: CenteredNorm) -> str:
    """How to read the views."""
    if shown.empty:
        return ""
    steps = [_step(rows) for _, rows in shown[shown["where"] == "wall"].groupby(SERIES)]
    return (
        "Above the axis the wall is cut, below it seen from outside; the scale of colours is "
        f"linear. Hatched: the largest principal stress is below −{NOISE * norm.halfrange:.2g} "
        "MPa, so the rubber is compressed in all directions. Elements at the fitting are "
        f"{max(steps):.2g} mm long."
    )


def _step(corners: pd.DataFrame) -> float:
    """Length of the last element before the fitting, not deformed [mm]."""
    state = corners.iloc[0]
    heights = np.unique(corners["Z [mm]"].round(6))
    fitting = np.searchsorted(heights, state[CAP] / (1 - state[CONTRACTION]) - 1e-6)
    return float(np.diff(heights)[np.clip(fitting - 1, 0, len(heights) - 2)])
