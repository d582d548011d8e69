"""Drawing of curves: what failed is not drawn as if it had not.

Converged states are joined by a line that stops at a gap; unstable ones are open circles; invalid
ones and those not reached are left out, and a note on the figure says so.
"""

import textwrap
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from solver.status import StateStatus
from workflow.data.states import COLUMN, CONTRACTION, FORCE, GOOD, REFERENCE, error_of
from workflow.figures.labels import SERIES, shown
from workflow.figures.style import COMPARED, SOFT, SOURCES, grow, legend, series

NOT_DRAWN = (StateStatus.INVALID_STATE.value, StateStatus.NOT_REACHED.value)
OPEN: dict[str, Any] = {
    "linestyle": "none",
    "marker": "o",
    "markerfacecolor": "white",
    "zorder": 3,
    "label": "unstable",
}
DIAMETER_INSIDE = COLUMN["inner_diameter_inflated"]
CHARACTERS = 18  # of a note, per inch of figure
NOTE_LINE = 0.14  # inch


def by_source(ax: Any, rows: pd.DataFrame, x: str, y: str, **style: Any) -> None:
    """One curve for each model, muscle, variant and reference map; ``style`` goes before theirs."""
    for source in SOURCES:
        found = rows[rows["source"] == source].groupby(["muscle", "variant"], dropna=False)
        for number, (key, each) in enumerate(found):
            name = ", ".join(map(str, key)) if len(found) > 1 else ""
            curve(ax, each, x, y, **style_of(source, name, number) | style)


def by_series(ax: Any, rows: pd.DataFrame, x: str, y: str, **style: Any) -> None:
    """One curve for each series and model: colour and marker by series, line by model."""
    for number, (_, each) in enumerate(rows.groupby(SERIES, sort=False)):
        for source, look in COMPARED.items():
            one = each[each["source"] == source]
            if len(one):
                step = max(1, len(one) // 5)
                apart = {"markevery": (number % step, step)} if "marker" not in look else {}
                curve(ax, one, x, y, **series(number) | apart | look | style)


def series_legend(figure: Figure, table: pd.DataFrame) -> None:
    """Legend of ``by_series`` above the axes: the series, then the models."""
    named = [
        Line2D([], [], **series(number), label=name)
        for number, name in enumerate(table[SERIES].unique())
    ]
    models = [
        Line2D([], [], color=SOFT, **look, label=SOURCES[source]["label"])
        for source, look in COMPARED.items()
        if (table["source"] == source).any()
    ]
    if (table["status"] == StateStatus.UNSTABLE.value).any():
        models.append(Line2D([], [], color=SOFT, **OPEN))
    legend(figure, [*named, *models])


def style_of(source: str, name: str, number: int) -> dict[str, Any]:
    """Style of the n-th curve of a model or map, called ``name``; the first has the plain line."""
    style = SOURCES[source]
    if name:
        style = style | {"label": f"{style['label']}, {name}"}
    if number > 0:
        style = style | {"linewidth": 1.0, "linestyle": (0, (6, *[1] * (2 * number + 1)))}
    return style


def curve(ax: Any, rows: pd.DataFrame, x: str, y: str, **style: Any) -> None:
    """The stops of one curve, in the order of ``x``; a map has markers at its own points."""
    rows = rows[rows["point"] != "zero force"].sort_values(x)
    good = rows["status"].isin([GOOD, REFERENCE])
    values = rows[y].where(good).to_numpy(dtype=float)
    if np.isfinite(values).any():
        own = np.flatnonzero(rows["point"] == "tabulated").tolist()
        every = {"markevery": own} if (rows["status"] == REFERENCE).any() else {}
        ax.plot(rows[x], values, **every | style)
        _band(ax, rows, x, y, values, style)
        if not every:
            _dot_lonely(ax, rows[x].to_numpy(dtype=float), values, style)
    unstable = rows[rows["status"] == StateStatus.UNSTABLE.value]
    if len(unstable):
        ax.plot(unstable[x], unstable[y], color=style["color"], **OPEN)


def _band(ax: Any, rows: pd.DataFrame, x: str, y: str, values: np.ndarray, style: Any) -> None:
    """The discretisation error around a curve, if it is known; mostly narrower than the line."""
    errors = rows.get(error_of(y))
    if errors is not None and errors.max() > 0:
        error = errors.to_numpy(dtype=float)
        band = {"color": style["color"], "alpha": 0.3, "linewidth": 0, "label": "_band"}
        ax.fill_between(rows[x], values - error, values + error, **band)


def _dot_lonely(ax: Any, x: np.ndarray, y: np.ndarray, style: dict[str, Any]) -> None:
    """A state without a neighbour on the line gets a dot."""
    known = np.pad(np.isfinite(y), 1)
    lonely = known[1:-1] & ~known[:-2] & ~known[2:]
    if lonely.any():
        ax.plot(x[lonely], y[lonely], ".", color=style["color"], label="_lonely")


def note_gaps(figure: Figure, table: pd.DataFrame, by: list[str], x: str, text: str = "") -> None:
    """Says under the axes which states are not drawn, curve by curve, and where along ``x``.

    ``text`` is what else there is to say.
    """
    missing = table[table["status"].isin(NOT_DRAWN)]
    lines = []
    for (source, *keys, status), rows in missing.groupby(["source", *by, "status"], sort=False):
        named = [shown(column, key) for column, key in zip(by, keys, strict=True)]
        count = f"{len(rows)} state{'s' if len(rows) > 1 else ''} {status.replace('_', ' ')}"
        lines.append(f"{', '.join([SOURCES[source]['label'], *named])}: {count}{_at(rows[x], x)}")
    text = f"{text} {_errors(table)}".strip()
    if lines:
        text = f"Not drawn: {'; '.join(lines)}. {text}"
    if text:
        note(figure, text)


def _errors(table: pd.DataFrame) -> str:
    """How wide the bands of the FE curves are at most; nothing if there are none."""
    largest: dict[Any, float] = {}
    for column in (FORCE, DIAMETER_INSIDE, CONTRACTION):
        error = error_of(column)
        if error in table and column in table:
            shares = table.groupby("source")[[error, column]].agg(lambda v: v.abs().max())
            for source, share in (shares[error] / shares[column]).items():
                if share > 0:
                    largest[source] = max(share, largest.get(source, 0))
    if not largest:
        return ""
    each = (f"{SOURCES[str(s)]['label']} {100 * v:.2g} %" for s, v in sorted(largest.items()))
    return f"Bands: discretisation error, of the largest value at most {', '.join(each)}."


def note(figure: Figure, text: str) -> None:
    """Small print under a figure, which grows for it."""
    width = figure.get_size_inches()[0]
    lines = textwrap.wrap(text, int(width * CHARACTERS))
    grow(figure, bottom=NOTE_LINE * (len(lines) + 0.5))
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
