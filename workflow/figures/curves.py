"""Drawing of curves: what failed is not drawn as if it had not, and nothing vanishes unsaid.

Converged states are joined by a line that stops at a gap; unstable ones are open circles; flagged
ones are marked. What is not drawn (invalid, not reached, without a value, not positive on a
logarithmic axis) is named in a note under the axes.
"""

import re
import textwrap
from collections.abc import Iterator
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from solver.status import Flag, StateStatus
from workflow.data.scene_data import (
    FLAGS,
    REFERENCE,
    STRENGTH,
    STRETCH,
    SUSPECT,
    TIME,
    TOLERANCE,
    TOTAL_BY,
    error_of,
)
from workflow.data.states import GOOD, SHOWN
from workflow.data.strain import LONG
from workflow.figures.labels import SERIES, shown
from workflow.figures.style import (
    SOFT,
    compared,
    grow,
    in_order,
    labelled,
    legend,
    look_of,
    marked,
    series,
)
from workflow.plan.plan import NOT_PROVED

Array = NDArray[np.float64]
UNSTABLE = StateStatus.UNSTABLE.value
OPEN: dict[str, Any] = {
    "linestyle": "none",
    "marker": "o",
    "markerfacecolor": "white",
    "zorder": 3,
    "label": "unstable",
}
MARKS: dict[str, dict[str, Any]] = {
    Flag.OVERSTRAINED: {"marker": "x", "markersize": 6, "label": "overstrained"},
    Flag.EXTRAPOLATED: {"marker": "2", "markersize": 8, "label": "extrapolated"},
    Flag.SMOOTHED: {"marker": "|", "markersize": 9, "label": "smoothed"},
}
MEANING = {
    Flag.OVERSTRAINED: "beyond a limit of the material",
    Flag.EXTRAPOLATED: "beyond the stretches to which the law of the rubber was fitted",
    Flag.SMOOTHED: "the smoothing of slack threads carries a share of the force",
}
NO_VALUE, NO_STRESS, NOT_POSITIVE = "no_value", "no_stress", "not_positive"
UNIT = re.compile(r"(?<=\d) (?=%|MPa|mm|N\b)")  # the blank between a number and its unit
WORDS = {  # what is said of states that are not drawn: of one, of several
    StateStatus.INVALID_STATE.value: ("invalid state", "invalid states"),
    StateStatus.NO_ROOT.value: ("no root: the force has no zero", "no roots"),
    NO_VALUE: ("state without a value", "states without a value"),
    NO_STRESS: ("state without a stress in a section", "states without a stress in a section"),
    "unstable_state": ("unstable state", "unstable states"),
    NOT_POSITIVE: ("state not above zero", "states not above zero"),
}
SAME = 1e-6  # of the largest value: curves that differ by less are one line
BAND = "_band"
CHARACTERS = 17  # of a note, per inch of figure
NOTE_LINE = 0.12  # inch


def by_source(ax: Any, rows: pd.DataFrame, x: str, y: str, **style: Any) -> None:
    """One curve for each model, muscle, variant and reference map; ``style`` goes before theirs."""
    several = [name for name in ("muscle", "variant") if rows[name].nunique() > 1]
    for source in in_order(rows["source"]):
        found = rows[rows["source"] == source].groupby(["muscle", "variant"], dropna=False)
        for number, (key, each) in enumerate(found):
            named = dict(zip(("muscle", "variant"), key, strict=True))
            name = ", ".join(str(named[k]) for k in several if pd.notna(named[k]))
            curve(ax, each, x, y, **style_of(source, name, number) | style)


def by_series(ax: Any, rows: pd.DataFrame, x: str, y: str, **style: Any) -> None:
    """One curve for each series and model: colour and marker by series, line by model."""
    bearer = marked(rows["source"])
    for number, (name, each) in enumerate(rows.groupby(SERIES, sort=False)):
        for source in in_order(each["source"]):
            look = compared(source, number, marked=source == bearer)
            one = each[each["source"] == source]
            step = max(1, len(one) // 5)
            apart = {"markevery": (number % step, step)} if "marker" not in look else {}
            label = {"label": f"_{look_of(source)['label']}, {name}"}
            curve(ax, one, x, y, **series(number) | apart | look | label | style)


def series_legend(figure: Figure, table: pd.DataFrame) -> None:
    """Legend of ``by_series`` above the axes: the series, then the models and the marks."""
    named = [
        Line2D([], [], **series(number), label=name)
        for number, name in enumerate(table[SERIES].unique())
    ]
    models = [
        Line2D([], [], color=SOFT, **compared(source), label=look_of(source)["label"])
        for source in in_order(table["source"])
    ]
    if (table["status"] == UNSTABLE).any():
        models.append(Line2D([], [], color=SOFT, **OPEN))
    for flag, look in MARKS.items():
        if _flagged(table, flag).any():
            models.append(Line2D([], [], color=SOFT, linestyle="none", **look))
    legend(figure, named, models)


def source_legend(figure: Figure, axes: Any) -> None:
    """Legend of ``by_source`` above the axes: models, variants and maps, then the marks."""
    marks = {OPEN["label"], *(look["label"] for look in MARKS.values())}
    handles = labelled(axes)
    legend(
        figure,
        [handle for handle in handles if handle.get_label() not in marks],
        [handle for handle in handles if handle.get_label() in marks],
    )


def style_of(source: str, name: str, number: int) -> dict[str, Any]:
    """Style of the n-th curve of a model or map, called ``name``; the first has the plain line."""
    style = look_of(source)
    if name:
        style = style | {"label": f"{style['label']}, {name}"}
    if number > 0:
        style = style | {"linewidth": 1.0, "linestyle": (0, (6, *[1] * (2 * number + 1)))}
    return style


def curve(ax: Any, rows: pd.DataFrame, x: str, y: str, **style: Any) -> None:
    """The stops of one curve, by ``x``, or as time goes; a map has markers at its own points."""
    stops = (rows["point"] != "zero force") & (rows["status"] != SUSPECT)
    rows = rows[stops] if TIME in rows else rows[stops].sort_values(x)
    good = rows["status"].isin([GOOD, REFERENCE])
    values = rows[y].where(good).to_numpy(dtype=float)
    if ax.get_yscale() == "log":
        values = np.where(values > 0, values, np.nan)
    if np.isfinite(values).any():
        own = np.flatnonzero(rows["point"] == "tabulated").tolist()
        every = {"markevery": own} if (rows["status"] == REFERENCE).any() else {}
        (line,) = ax.plot(rows[x], values, **every | style)
        _band(ax, rows, x, y, values, line)
        if not every:
            _dot_lonely(ax, rows[x].to_numpy(dtype=float), values, line)
    unstable = rows[rows["status"] == UNSTABLE]
    if len(unstable):
        ax.plot(unstable[x], unstable[y], color=style["color"], **OPEN)
    for flag, look in MARKS.items():
        flagged = rows[_flagged(rows, flag)]
        if len(flagged):
            mark = look | {"color": style["color"], "linestyle": "none", "zorder": 4}
            ax.plot(flagged[x], flagged[y], **mark)


def _flagged(rows: pd.DataFrame, flag: str) -> pd.Series:
    """Which rows of states that are drawn have a flag."""
    if FLAGS not in rows:
        return pd.Series(False, rows.index)
    flags = rows[FLAGS].fillna("").map(lambda words: flag in str(words).split())
    return flags.astype(bool) & rows["status"].isin(SHOWN)


def _band(ax: Any, rows: pd.DataFrame, x: str, y: str, values: Array, line: Line2D) -> None:
    """The discretisation error around a curve, where it is known."""
    errors = rows.get(error_of(y))
    if errors is None:
        return
    error = errors.to_numpy(dtype=float)
    low, high = values - error, values + error
    known = np.isfinite(low) & (error > 0)
    if ax.get_yscale() == "log":
        known &= low > 0  # a band without a lower end would hang from nowhere
    if known.any():
        look = {"color": line.get_color(), "alpha": 0.3, "linewidth": 0, "label": BAND}
        band = ax.fill_between(rows[x], low, high, where=known, **look)
        band.around = line


def _dot_lonely(ax: Any, x: Array, y: Array, line: Line2D) -> None:
    """A state without a neighbour on the line gets a dot, as wide as the line and wider."""
    known = np.pad(np.isfinite(y), 1)
    lonely = known[1:-1] & ~known[:-2] & ~known[2:]
    if lonely.any():
        look = {"color": line.get_color(), "alpha": line.get_alpha(), "label": "_lonely"}
        ax.plot(x[lonely], y[lonely], "o", markersize=2 + 1.5 * line.get_linewidth(), **look)


def note_gaps(
    figure: Figure,
    table: pd.DataFrame,
    by: list[str],
    x: str,
    text: str = "",
    *,
    y: str | None = None,
    log: bool = False,
) -> None:
    """Says under the axes what they cannot: call it when all is drawn.

    Which states are not drawn, curve by curve, and where along ``x``; which are flagged; how far
    threads are stretched; which curves lie on each other; what a band is, where there is one.

    Parameters
    ----------
    text : what else there is to say
    y : the column that is drawn; what has no value in it is not drawn
    log : whether it is drawn on a logarithmic axis
    """
    said = [
        _listed("Not drawn", table.assign(why=_reasons(table, y, log)), by, x),
        *(_flags(table, flag) for flag in MARKS),
        text,
        _stretched(table),
        _one_line(table, x, y) if y else "",
        _bands(figure),
        _promised(table, by),
    ]
    if any(said):
        note(figure, " ".join(sentence for sentence in said if sentence))


def _promised(table: pd.DataFrame, by: list[str]) -> str:
    """Which curves are as exact as a scene wants, by model and mesh, and which may not be."""
    if TOLERANCE not in table:
        return ""
    found: dict[str, list[str]] = {}
    keys = ["source", *by, *(["variant"] if _varies(table, "variant") else [])]
    rows = table[table[TOLERANCE].notna()]
    for (tolerance, known, source, *values), _ in rows.groupby(
        [TOLERANCE, TOTAL_BY, *keys], sort=False, dropna=False
    ):
        named = [shown(c, v) for c, v in zip(keys[1:], values, strict=True) if pd.notna(v)]
        is_proved = not known.startswith(NOT_PROVED)
        how = "Proved to be" if is_proved else f"{NOT_PROVED.capitalize()} to be"
        said = f"{how} within {100 * tolerance:g} % of a refined solid"
        found.setdefault(said, []).append(
            ", ".join(dict.fromkeys([look_of(source)["label"], *named]))
        )
    if len(found) == 1:
        return f"{next(iter(found))}."
    return " ".join(f"{said}: {'; '.join(names)}." for said, names in found.items())


def _reasons(table: pd.DataFrame, y: str | None, log: bool) -> pd.Series:
    """Why a state is not drawn; empty for those that are."""
    drawn = table["status"].isin([*SHOWN, REFERENCE, SUSPECT])
    why = table["status"].where(~drawn, "")
    if y is None:
        return why
    stop = table["point"] != "zero force"
    why = why.mask(drawn & stop & table[y].isna(), NO_VALUE)
    return why.mask(drawn & stop & (table[y] <= 0), NOT_POSITIVE) if log else why


def _listed(title: str, table: pd.DataFrame, by: list[str], x: str) -> str:
    """A sentence that counts the rows with a reason, curve by curve, and says where they are."""
    keys = ["source", *by, *(["variant"] if _varies(table, "variant") else [])]
    rows = table[table["why"] != ""]
    curves_of: dict[str, list[str]] = {}
    for (source, *values, why), found in rows.groupby([*keys, "why"], sort=False, dropna=False):
        named = [shown(c, v) for c, v in zip(keys[1:], values, strict=True) if pd.notna(v)]
        curve_name = ", ".join(dict.fromkeys([look_of(source)["label"], *named]))
        said = f"{_counted(why, len(found))}{_at(found[x], x)}"
        curves_of.setdefault(said, []).append(curve_name)
    lines = [f"{' and '.join(names)}: {said}" for said, names in curves_of.items()]
    return f"{title}: {'; '.join(lines)}." if lines else ""


def _varies(table: pd.DataFrame, column: str) -> bool:
    return column in table and table[column].nunique() > 1


def _counted(why: str, count: int) -> str:
    words = str(why).replace("_", " ")
    one, several = WORDS.get(why, (f"state {words}", f"states {words}"))
    if why == StateStatus.NO_ROOT.value and count == 1:
        return one
    return f"{count} {one if count == 1 else several}"


def _flags(table: pd.DataFrame, flag: str) -> str:
    """How many states of each model have a flag."""
    counts = table[_flagged(table, flag)].groupby("source").size()
    each = [f"{counts[source]} ({look_of(source)['label']})" for source in in_order(counts.index)]
    return f"{flag.capitalize()}, {MEANING[Flag(flag)]}: states {', '.join(each)}." if each else ""


def _stretched(table: pd.DataFrame) -> str:
    """Names threads that are stretched far, where it is not known what they bear."""
    if STRETCH not in table:
        return ""
    unknown = table[table[STRENGTH].isna()] if STRENGTH in table else table
    largest = unknown.groupby("source")[STRETCH].max()
    each = [
        f"{100 * (largest[source] - 1):.0f} % ({look_of(source)['label']})"
        for source in in_order(largest[largest > LONG].index)
    ]
    if not each:
        return ""
    return f"Threads are stretched by up to {', '.join(each)}: more than many threads stand."


def _one_line(table: pd.DataFrame, x: str, y: str) -> str:
    """Names series of a model that lie on each other."""
    if SERIES not in table:
        return ""
    found = []
    for source, rows in table[table["status"] == GOOD].groupby("source", sort=False):
        curves = {
            name: each.groupby(x)[y].mean() for name, each in rows.groupby(SERIES, sort=False)
        }
        found += [
            f"{look_of(source)['label']} for {one} and {other}" for one, other in _alike(curves)
        ]
    return f"One and the same line: {'; '.join(found)}." if found else ""


def _alike(curves: dict[str, pd.Series]) -> Iterator[tuple[str, str]]:
    """Names of two of some curves that have values at the same places, which are the same."""
    names, values = list(curves), pd.DataFrame(curves).to_numpy().T
    known = ~np.isnan(values)
    for k, name in enumerate(names):
        others = np.flatnonzero((known[k + 1 :] == known[k]).all(axis=1)) + k + 1
        if known[k].sum() < 2 or not len(others):
            continue
        own, theirs = values[k, known[k]], values[np.ix_(others, known[k])]
        size = np.maximum(np.abs(own).max(), np.abs(theirs).max(axis=1))
        same = np.abs(theirs - own).max(axis=1) <= SAME * size
        yield from ((name, names[other]) for other in others[same])


def _bands(figure: Figure) -> str:
    """What the bands are; one that is nowhere wider than its line is taken away."""
    wide = False
    for band in _all_bands(figure):
        width = _thickness(band) * 72 / figure.dpi
        if width > band.around.get_linewidth():
            wide = True
        else:
            band.remove()
    return "A shaded band around a curve is its discretisation error." if wide else ""


def _all_bands(figure: Figure) -> Iterator[Any]:
    for ax in figure.axes:
        yield from [found for found in ax.collections if found.get_label() == BAND]


def _thickness(band: Any) -> float:
    """Largest height of a band within the axes [pixel]."""
    low, high = band.axes.bbox.y0, band.axes.bbox.y1
    largest = 0.0
    for path in band.get_paths():
        x, y = band.axes.transData.transform(path.vertices).T
        heights = pd.Series(np.clip(y, low, high)).groupby(x.round(3))
        largest = max(largest, float((heights.max() - heights.min()).max()))
    return largest


def note(figure: Figure, text: str) -> None:
    """Small print under a figure, which grows for it; nothing of no text."""
    if not text:
        return
    width = figure.get_size_inches()[0]
    whole = UNIT.sub("\N{NO-BREAK SPACE}", text)
    lines = [
        line.replace("\N{NO-BREAK SPACE}", " ")
        for line in textwrap.wrap(whole, int(width * CHARACTERS))
    ]
    grow(figure, bottom=NOTE_LINE * (len(lines) + 1))
    corner = 0.1 / width, 0.06 / figure.get_size_inches()[1]
    figure.text(*corner, "\n".join(lines), color=SOFT, fontsize=7, va="bottom")


def _at(values: pd.Series, column: str) -> str:
    """Where the states are, as far as that is known."""
    low, high = values.min(), values.max()
    if not np.isfinite(low):
        return ""
    if low == high:
        return f" at {shown(column, low)}"
    return f" from {shown(column, low)} to {shown(column, high)}"
