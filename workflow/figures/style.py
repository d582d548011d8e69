"""One look for all figures: sizes, line styles of models and muscles, legible in grey.

What differs differs in line style or marker, never in colour alone. Importing this module sets
matplotlib's parameters; ``save`` writes the same bytes for the same figure.
"""

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Literal

import matplotlib
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.gridspec import GridSpec
from matplotlib.text import Text
from matplotlib.ticker import MultipleLocator
from matplotlib.transforms import ScaledTranslation

from geometry.files import atomic_write
from solver.models import MODELS

FULL, COLUMN_WIDTH = 7.0, 4.6  # widths [inch]
LEFT, RIGHT, TOP, BOTTOM = 0.7, 0.14, 0.28, 0.48  # margins around the axes [inch]
GAP = 0.28  # between axes [inch]
LEGEND_ROW, HANDLE, CHARACTER = 0.19, 0.66, 0.067  # height, key and gaps, a character [inch]
DPI = 150
SOFT = "0.45"  # grey of what is said about the data, not the data

matplotlib.rcParams.update(
    {
        "font.family": "DejaVu Sans",
        "font.size": 8.5,
        "mathtext.fontset": "dejavusans",
        "axes.titlesize": 8.5,
        "axes.titleweight": "bold",
        "axes.titlelocation": "left",
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.linewidth": 0.7,
        "axes.grid": True,
        "axes.axisbelow": True,
        "grid.color": "0.9",
        "grid.linewidth": 0.6,
        "xtick.direction": "out",
        "lines.linewidth": 1.5,
        "lines.markersize": 4,
        "legend.frameon": False,
        "legend.handlelength": 2.8,
        "legend.fontsize": 8.5,
        "svg.fonttype": "none",
        "svg.hashsalt": "muscle",
        "savefig.dpi": DPI,
        "figure.dpi": DPI,
    }
)

# Lines of models, by their rank (solver/models), in the order in which they are drawn; a model of
# another rank is drawn as OTHER, last. The second is for where the colour says something else.
LINES: dict[int, tuple[dict[str, Any], dict[str, Any]]] = {
    0: (
        {"color": "0.45", "linestyle": (0, (5, 2))},
        {"linewidth": 1.2, "linestyle": (0, (4, 4)), "marker": ""},
    ),
    1: (
        {"color": "0.45", "linewidth": 1.1, "linestyle": (0, (1, 1.5))},
        {"linewidth": 1.2, "linestyle": (0, (1, 1.5)), "marker": ""},
    ),
    2: (
        {"color": "#cc79a7", "linestyle": (0, (5, 1, 1, 1))},
        {"linewidth": 1.2, "linestyle": (0, (5, 1, 1, 1)), "marker": ""},
    ),
    5: (
        {"color": "#b8860b", "linewidth": 1.2, "linestyle": (0, (3, 1, 1, 1, 1, 1))},
        {"linewidth": 1.2, "linestyle": (0, (3, 1, 1, 1, 1, 1)), "marker": ""},
    ),
    4: (
        {"color": "#5ba4d6", "linewidth": 2.8},
        {"linewidth": 2.8, "alpha": 0.5, "marker": ""},
    ),
    3: ({"color": "black", "linewidth": 1.1}, {"linewidth": 1.1}),
}
OTHER: dict[str, Any] = {"color": "#7b3294", "linewidth": 1.2, "linestyle": (0, (1, 1))}
OWN: dict[str, Any] = {"color": "#cc3311", "linewidth": 0.9, "marker": "D"}  # forces of a user
PLACE = {rank: place for place, rank in enumerate(LINES)}
OF_MODELS = sorted(MODELS.values(), key=lambda model: PLACE.get(model.rank, len(PLACE)))
SOURCES: dict[str, dict[str, Any]] = {  # models and reference maps, by name
    **{m.name: {"label": m.label, **LINES.get(m.rank, (OTHER,))[0]} for m in OF_MODELS},
    "festo_musclesim": {
        "label": "Festo MuscleSIM",
        "color": "#d55e00",
        "linewidth": 0.9,
        "marker": "s",
    },
    "martens2017": {
        "label": "Martens & Boblan 2017",
        "color": "#009e73",
        "linewidth": 0.9,
        "marker": "o",
    },
}
COMPARED = {model.name: LINES[model.rank][1] for model in OF_MODELS if model.rank in LINES}
SERIES: tuple[dict[str, Any], ...] = (  # muscles, loads, materials compared in one plot
    {"color": "#0072b2", "marker": "o"},
    {"color": "#d55e00", "marker": "s"},
    {"color": "#009e73", "marker": "^"},
    {"color": "#7b3294", "marker": "D"},
    {"color": "black", "marker": "v"},
    {"color": "#b8860b", "marker": "P"},
)


def look_of(source: str) -> dict[str, Any]:
    """Label, colour and line of a model or force map; of one without a look, its name."""
    return SOURCES.get(source, {"label": source, **(OTHER if source in MODELS else OWN)})


def compared(source: str, number: int = 0, *, marked: bool = False) -> dict[str, Any]:
    """Line of a model or map in the n-th series; dashes of neighbours fill each other's gaps.

    A model that is ``marked`` has the markers of the series.
    """
    other = {k: v for k, v in OTHER.items() if k != "color"} | {"marker": ""}
    of_map = {"linewidth": 0.9, "linestyle": ":", "marker": look_of(source).get("marker", "")}
    look = COMPARED.get(source, of_map if of_map["marker"] else other)
    if marked:
        look = {key: value for key, value in look.items() if key != "marker"}
    if not isinstance(look.get("linestyle"), tuple):
        return look
    offset, dashes = look["linestyle"]
    return look | {"linestyle": (offset + number % 2 * sum(dashes) / 2, dashes)}


def marked(sources: Iterable[str]) -> str | None:
    """The model that has the markers of the series: one that always has, else the last drawn."""
    models = [source for source in in_order(sources) if source in MODELS]
    always = [source for source in models if "marker" not in compared(source)]
    return next(iter(always or models[::-1]), None)


def in_order(sources: Iterable[str]) -> list[str]:
    """Models and maps in the order in which they are drawn, those without a look last."""
    found = set(sources)
    return [source for source in SOURCES if source in found] + sorted(found - set(SOURCES))


def series(number: int) -> dict[str, Any]:
    """Colour and marker of the n-th thing compared; they repeat after six."""
    return SERIES[number % len(SERIES)]


def grid(
    width: float,
    height: float,
    rows: int = 1,
    columns: int = 1,
    *,
    gap: tuple[float, float] = (GAP, GAP),
    right: float = RIGHT,
    **ratios: Any,
) -> tuple[Figure, GridSpec]:
    """A figure and places for its axes; all lengths in inch, ``gap`` between columns and rows."""
    figure = Figure(figsize=(width, height))
    FigureCanvasAgg(figure)
    wide = (width - LEFT - right - gap[0] * (columns - 1)) / columns
    tall = (height - TOP - BOTTOM - gap[1] * (rows - 1)) / rows
    figure.subplots_adjust(
        left=LEFT / width,
        right=1 - right / width,
        top=1 - TOP / height,
        bottom=BOTTOM / height,
        wspace=gap[0] / wide,
        hspace=gap[1] / tall,
    )
    return figure, figure.add_gridspec(rows, columns, **ratios)


Shared = bool | Literal["none", "all", "row", "col"]  # axes, as matplotlib has it


def panels(
    width: float,
    height: float,
    rows: int = 1,
    columns: int = 1,
    *,
    sharex: Shared = False,
    sharey: Shared = False,
    **options: Any,
) -> tuple[Figure, Any]:
    """A figure and its axes, shape (rows, columns); see ``grid``."""
    figure, places = grid(width, height, rows, columns, **options)
    return figure, places.subplots(squeeze=False, sharex=sharex, sharey=sharey)


def percent(axis: Any, step: float | None = None) -> None:
    """Shows fractions as percent on a matplotlib axis (``ax.xaxis`` or ``ax.yaxis``).

    With the digits that its ticks have: 2.5 is not 2.
    """
    axis.set_major_formatter(lambda value, _: _percent(value))
    if step:
        axis.set_major_locator(MultipleLocator(step))


def _percent(value: float) -> str:
    return f"{round(100 * value, 6) + 0.0:g}".replace("-", "\N{MINUS SIGN}")


def labelled(axes: Any) -> list[Any]:
    """What is drawn on some axes and has a label, each label once."""
    found: dict[str, Any] = {}
    for ax in axes.flat:
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True):
            found.setdefault(label, handle)
    return list(found.values())


def legend(figure: Figure, *groups: list[Any]) -> None:
    """Legends above all axes, one below the other, each read row by row; the figure grows."""
    width = figure.get_size_inches()[0]
    groups = tuple(handles for handles in groups if handles)
    shapes = [_columns([str(h.get_label()) for h in handles], width - LEFT) for handles in groups]
    rows = [math.ceil(len(h) / c) for h, c in zip(groups, shapes, strict=True)]
    grow(figure, top=LEGEND_ROW * sum(rows))
    for k, (handles, columns) in enumerate(zip(groups, shapes, strict=True)):
        below = ScaledTranslation(0, -LEGEND_ROW * sum(rows[:k]), figure.dpi_scale_trans)
        figure.legend(
            handles=_by_row(handles, columns),
            ncol=columns,
            columnspacing=1.4,
            borderpad=0.2,
            borderaxespad=0.3,
            loc="upper left",
            bbox_to_anchor=((LEFT - 0.06) / width, 1.0),
            bbox_transform=figure.transFigure + below,  # a figure may grow below
        )


def _by_row(items: list[Any], columns: int) -> list[Any]:
    """Reordered so that matplotlib, which fills column after column, shows them row by row."""
    return [item for column in range(columns) for item in items[column::columns]]


def _columns(labels: list[str], width: float) -> int:
    """Most columns of a legend that fit into a width [inch]."""
    for columns in range(len(labels), 1, -1):
        longest = [max(map(len, labels[column::columns])) for column in range(columns)]
        if sum(HANDLE + CHARACTER * length for length in longest) <= width:
            return columns
    return 1


def grow(figure: Figure, *, top: float = 0, bottom: float = 0) -> None:
    """Makes a figure higher; its axes keep their size [inch]."""
    width, height = figure.get_size_inches()
    taller, now = height + top + bottom, figure.subplotpars
    figure.set_size_inches(width, taller)
    figure.subplots_adjust(
        bottom=(now.bottom * height + bottom) / taller, top=(now.top * height + bottom) / taller
    )


def fit_titles(figure: Figure) -> None:
    """Makes a title smaller that would run into the axes beside it, or out of the figure."""
    if figure.get_layout_engine() is not None:
        return  # which moves the axes when it is drawn
    for ax in figure.axes:
        for title in ax.findobj(Text, include_self=False):
            if not title.get_text() or title.get_text() != ax.get_title("left"):
                continue
            own = title.get_window_extent()
            beside = [a.bbox for a in figure.axes if a.bbox.x0 > ax.bbox.x1]
            right = [box.x0 for box in beside if box.y0 < own.y1 < box.y1 + 2 * own.height]
            room = min([*right, figure.bbox.x1]) - own.x0 - own.height / 2
            size = float(title.get_fontsize())
            while title.get_window_extent().width > room > 0 and size > 1:
                size *= 0.95  # step by step, for hinting makes a text not quite go with its size
                title.set_fontsize(size)


def save(figure: Figure, path: Path) -> None:
    """Writes a figure, whole or not at all; the ending of the path says the format.

    Raises
    ------
    ValueError
        If it is neither .png nor .svg.
    """
    metadata = {".png": {"Software": None}, ".svg": {"Date": None, "Creator": None}}
    if path.suffix not in metadata:
        raise ValueError(f"{path}: a figure is .png or .svg")
    fit_titles(figure)
    with atomic_write(path) as beside:
        figure.savefig(beside, format=path.suffix[1:], metadata=metadata[path.suffix])
