"""Any scene with a path: one quantity against another, with the force maps of its muscles.

What a scene says under ``figure`` chooses: quantities, what colours tell apart, maps, title. A
scene that is one of the paper's figures and says nothing there has a module of its own. Cycles are
drawn as loops, other scenes in time against time; both have no maps.
"""

from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from solver.load_path import PathKind
from solver.record import IN_TIME, SLEEVED, VARIABLES
from workflow.data import bench
from workflow.data.scene_data import (
    COLUMN,
    CONTRACTION,
    CONTROL,
    FLAGS,
    FORCE,
    PRESSURE,
    REFERENCE,
    STRENGTH,
    STRETCH,
    SUSPECT,
    TIME,
    reference_at,
    reference_curves,
    states,
)
from workflow.data.states import SHOWN
from workflow.figures import curves
from workflow.figures.labels import SERIES, constants, muscles, series
from workflow.figures.style import COLUMN_WIDTH, look_of, panels, percent
from workflow.study import figure_needs
from workflow.study.schema import FigureEntry

OF_MAP = {CONTRACTION, PRESSURE, FORCE}  # columns that a force map has
MOST = 20  # series that are drawn: more can neither be told apart nor be named in a legend
HELD, PERIOD = "held", "period"  # columns of scenes in time
MODEL = "model"  # what curves may be told apart by, beside muscle, variant and the held value


def table(data: Any) -> pd.DataFrame:
    """States of all curves, and those of the maps where a map has what is shown."""
    kind, chosen = PathKind(data.scene.kind), data.scene.figure or FigureEntry()
    held, timed = CONTROL[kind.held.key], data.scene.in_time
    x, y = map(_column, figure_needs.axes(data.scene))
    if timed:
        held, frames = HELD, _over_time(data, kind, {x, y})
    else:
        frames = [states(data, [name for name in VARIABLES | SLEEVED if COLUMN[name] in {x, y}])]
        if chosen.compare == "reference" and {x, y, held} <= OF_MAP and kind.held.key != "load":
            frames += _measured(data, kind)
    every = pd.concat(frames, ignore_index=True)
    told_apart = {
        "muscle": ["muscle", held],
        "held": [held, "muscle"],
        "variant": ["variant", "muscle", held],
        "model": [MODEL, "muscle", held],
    }[chosen.by] + [PERIOD] * timed
    every[MODEL] = every["source"].map(lambda source: look_of(source)["label"])
    every["variant"] = every["variant"].fillna("default")
    every[SERIES] = series(every, told_apart, apart=False)
    alike = constants(every, ["muscle", held])
    said = f"{alike}." if chosen.title and alike else ""  # which a title of one's own may not say
    title = chosen.title or alike
    every.attrs = {"x": x, "y": y, "title": title, "said": said, "by": chosen.by}
    return every


def draw(table: pd.DataFrame) -> Figure:
    """All curves in one pair of axes; of many series every second or third one, and so on."""
    x, y = table.attrs["x"], table.attrs["y"]
    table, left_out = _thinned(table)
    figure, axes = panels(COLUMN_WIDTH, 3.3)
    ax = axes[0, 0]
    shown = table[table["status"] != SUSPECT]
    curves.by_series(ax, shown, x, y)
    suspect = table[table["status"] == SUSPECT]
    if len(suspect):
        ax.plot(suspect[x], suspect[y], "x", color="0.45")
    low, high = ax.get_ylim()
    if low < 0 < high:
        ax.axhline(0, color="black", linewidth=0.7)
    ax.set_title(table.attrs["title"])
    for axis, column, say in ((ax.xaxis, x, ax.set_xlabel), (ax.yaxis, y, ax.set_ylabel)):
        say(_label(column))
        if column == CONTRACTION:
            percent(axis)
    curves.series_legend(figure, shown)
    text = f"{table.attrs['said']} {muscles(table)}".strip()
    if len(suspect):
        text += " Crosses are points of a map that are not used."
    text = f"{left_out} {text}"
    curves.note_gaps(figure, shown, [SERIES], x, text.strip(), y=y)
    return figure


def _thinned(table: pd.DataFrame) -> tuple[pd.DataFrame, str]:
    """The rows of MOST series at most, evenly among all, and a sentence that says so."""
    names = list(table[SERIES].unique())
    if len(names) <= MOST:
        return table, ""
    kept = names[:: -(-len(names) // MOST)]
    said = f"{len(kept)} of {len(names)} series are drawn; the table of the figure has them all."
    return table[table[SERIES].isin(kept)], said


def _over_time(data: Any, kind: PathKind, columns: set[str]) -> list[pd.DataFrame]:
    """The states of curves in time, in their order."""
    found = []
    for curve in data.curves:
        place, solution = curve.place, curve.solution
        status = [status.value for status in solution.state_status]
        known = [each in SHOWN for each in status]
        numbers = {
            _column(name): pd.Series(values).where(known)
            for name, values in solution.states.items()
            if _column(name) in {TIME, STRETCH} | columns
        }
        rows = pd.DataFrame(
            {"source": place.model, "muscle": place.muscle, "variant": place.variant}
            | {HELD: kind.held.text(place.held), PERIOD: f"{place.period:g} s"}
            | {"point": "stop"}
            | numbers
            | {"status": status}
            | {FLAGS: [" ".join(sorted(flags)) for flags in solution.flags]}
        )
        bears = data.studied[place.muscle].limits.thread_strength
        found.append(rows.assign(**{STRENGTH: float(bears) if bears else float("nan")}))
    return found


def _column(name: str) -> str:
    """The column of a quantity or of a control, a load being a force."""
    if name in IN_TIME:
        return f"{name} [{IN_TIME[name][0]}]"
    return CONTROL.get(name) or COLUMN[name]


def _label(column: str) -> str:
    """``outer_diameter [mm]`` as on an axis."""
    if column == CONTRACTION:
        return "contraction [%]"
    name, _, unit = column.partition(" [")
    if name.endswith("_max"):
        name = f"largest {name.removesuffix('_max')}"
    name = name.replace("_", " ")
    return f"{name} [{unit}" if unit else name


def _measured(data: Any, kind: PathKind) -> list[pd.DataFrame]:
    """The maps of every muscle along the path, as rows of its own."""
    found = []
    maps = bench.of_muscles(data.studied)
    for muscle, own in maps.items():
        if kind is PathKind.ISOBARIC:
            rows = [reference_curves(own.values(), data.scene.held, data.scene.swept)]
        else:
            rows = [reference_at(own.values(), e, data.scene.swept) for e in data.scene.held]
        found += [each.assign(muscle=muscle, status=each["status"]) for each in rows if len(each)]
    return [each for each in found if (each["status"] == REFERENCE).any()]
