"""A picture of the muscle (the paper's Fig. 3): its threads laid open in steps, and its numbers."""

import math
import textwrap
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon
from matplotlib.transforms import offset_copy
from numpy.typing import NDArray

from geometry.braid import Kind
from geometry.muscle import Braid, LayeredBraid, Muscle
from geometry.whole import TURNING, drawn_radius
from workflow.figures.muscle_painting import (
    COVER,
    EDGE,
    TURNED,
    Body,
    colour_of,
    face,
    paint,
    project,
)

WIDTH, HEIGHT = 7.0, 3.8  # of the figure [inch]
TITLE = (0.1, 6.9, 3.72)  # left, right and top of the name and of what is not drawn [inch]
WHOLE = (0.1, 2.5, 6.8, 0.95)  # left, bottom, width, height of the axes [inch]
OPENED = (0.1, 0.4, 2.75, 1.5)
SECTION = (3.1, 0.65, 1.2, 1.2)
NUMBERS = (5.1, 6.9, 1.9)  # left, right and top of the table [inch]
ROW, NAME, LINE_PITCH = 0.16, 1.05, 0.215  # least distance of labels and of names, lines [inch]
FONT = 8.0  # [pt]
PIECE = 1.3  # length of each step of the enlarged piece [outer radius]
SLICE = 0.85  # half width of the section [wall thickness]
POINTED = math.radians(60)  # from the viewer's side to where a name points on its body
RUBBER, BENEATH, CAP = (0.50, 0.80), (0.80, 1.0), (0.25, 0.55)  # darkest and lightest grey
BORE, CUT, SOFT = 0.2, 0.88, "0.4"  # greys
LINE: dict[str, Any] = {"color": "black", "linewidth": EDGE}


def draw(muscle: Muscle, name: str = "", others: Sequence[str] = ()) -> Figure:
    """Draw the muscle whole, a piece of it and its wall enlarged, and its numbers.

    Above stands its name, and which ``others`` are not drawn.
    Families of threads are laid open in steps: sleeves, the tube, without its outside the outer
    family in it, and without what is outside of that the inner one.
    """
    figure = Figure(figsize=(WIDTH, HEIGHT))
    outer, half = muscle.outer_radius, muscle.length / 2
    left, right = (
        Body(name="cap", radius=outer, start=start, stop=start + muscle.cap_length, greys=CAP)
        for start in (-half - muscle.cap_length, half)
    )
    steps = laid_open(muscle, muscle.length)
    axes = _view(figure, WHOLE, muscle, left.start, right.stop)
    paint(axes, muscle, [left, *steps])
    face(axes, muscle.inner_radius, half, BORE)
    paint(axes, muscle, [right])
    _dimension(figure, axes, muscle)

    steps = laid_open(muscle, min(muscle.length, PIECE * outer * len(steps)))
    left = replace(left, start=max(left.start, -half - PIECE / 2 * outer))
    axes = _view(figure, OPENED, muscle, left.start, steps[-1].stop)
    paint(axes, muscle, [left, *steps])
    face(axes, muscle.inner_radius, steps[-1].stop, BORE)
    _name_bodies(axes, muscle, [left, *steps])

    _section(figure, muscle)
    _write_numbers(figure, muscle)
    begin, end, top = TITLE
    place: dict[str, Any] = {"va": "top", "fontsize": FONT}
    figure.text(begin / WIDTH, top / HEIGHT, name, weight="bold", **place)
    if others:
        text = textwrap.shorten(f"not drawn: {', '.join(others)}", 90, placeholder=" …")
        figure.text(end / WIDTH, top / HEIGHT, text, ha="right", color=SOFT, **place)
    return figure


def laid_open(muscle: Muscle, length: float) -> list[Body]:
    """The tube from its left end, with more of the wall taken off in every step of equal length."""
    steps = len(muscle.layers) + 1
    edges = (np.linspace(0, length, steps + 1) - muscle.length / 2).tolist()
    radii = [drawn_radius(layer) for layer in muscle.layers]
    order: list[int | None] = [*sorted(range(steps - 1), key=lambda k: -radii[k])]
    order.insert(sum(layer.kind is Kind.SLEEVE for layer in muscle.layers), None)  # the tube
    return [
        Body(name="tube", radius=muscle.outer_radius, start=start, stop=stop, greys=RUBBER)
        if layer is None
        else Body(
            name=_name(muscle, layer),
            radius=radii[layer],
            start=start,
            stop=stop,
            greys=BENEATH,
            layer=layer,
        )
        for layer, (start, stop) in zip(order, pairwise(edges), strict=True)
    ]


def _name(muscle: Muscle, layer: int) -> str:
    """Of a family of threads, by what carries it and how it winds."""
    wound = muscle.layers[layer]
    turning = next(name for name, sense in TURNING.items() if sense == wound.sense)
    if isinstance(muscle.braid, Braid):
        return f"{('inner', 'outer')[layer]} layer, {turning}"
    return f"{'sleeve' if wound.kind is Kind.SLEEVE else 'layer'}, {turning}"


def numbers(muscle: Muscle) -> list[tuple[str, str]]:
    """Names of the muscle's numbers, and the numbers with their units, as they are written."""
    rows = [
        ("inner diameter", f"{muscle.inner_diameter:g} mm"),
        ("wall thickness", f"{muscle.wall_thickness:g} mm"),
        ("length", f"{muscle.length:g} mm"),
    ]
    braid = muscle.braid
    if braid is None:
        return [*rows, ("threads", "none")]
    if isinstance(braid, LayeredBraid):
        rows += [
            (f"{kind}, {threads} each", f"{diameter:.4g} mm, {math.degrees(angle):.3g}°")
            for kind, threads, diameter, angle in zip(
                braid.kinds, braid.threads, braid.layer_diameters, braid.layer_angles, strict=True
            )
        ]
        return rows
    inner, outer = braid.layer_diameters
    return [
        *rows,
        ("layer diameters", f"{inner:g}, {outer:g} mm"),
        ("threads per layer", f"{braid.threads}"),
        ("lead", f"{braid.lead:.5g} mm"),
        ("axial spacing", f"{braid.axial_spacing:.4g} mm"),
        ("braid angle", f"{math.degrees(braid.angle):.2f}°"),
    ]


def _outermost(muscle: Muscle) -> float:
    """Radius of tube and sleeves [mm]."""
    return max([muscle.outer_radius, *(drawn_radius(layer) for layer in muscle.layers)])


def spread(values: list[float], gap: float) -> list[float]:
    """Rising values moved apart to at least ``gap``, about where they were."""
    if not values:
        return []
    apart = np.maximum.accumulate(np.array(values) - gap * np.arange(len(values)))
    apart += gap * np.arange(len(values))
    return list(apart - np.mean(apart - values))


def _axes(figure: Figure, place: tuple[float, float, float, float]) -> Axes:
    """Empty axes with equal scales, at a place in inch."""
    left, bottom, width, height = place
    axes = figure.add_axes((left / WIDTH, bottom / HEIGHT, width / WIDTH, height / HEIGHT))
    axes.set_axis_off()
    axes.set_aspect("equal")
    return axes


def _view(
    figure: Figure,
    place: tuple[float, float, float, float],
    muscle: Muscle,
    start: float,
    stop: float,
) -> Axes:
    """Axes in mm on the paper that hold the muscle from one Z to another."""
    axes, outer = _axes(figure, place), _outermost(muscle)
    side = math.sin(TURNED) * outer  # half the width of a circle about the axis
    axes.set_xlim(math.cos(TURNED) * start - side, math.cos(TURNED) * stop + side)
    axes.set_ylim(-1.02 * outer, 1.02 * outer)
    return axes


def _dimension(figure: Figure, axes: Axes, muscle: Muscle) -> None:
    """The length between the caps, under the whole muscle."""
    below = offset_copy(axes.transData, fig=figure, y=-ROW, units="inches")
    half, y = muscle.length / 2 * math.cos(TURNED), -muscle.outer_radius
    arrow = {"arrowstyle": "<|-|>", "shrinkA": 0, "shrinkB": 0, **LINE}
    ends: dict[str, Any] = {"xycoords": below, "textcoords": below, "annotation_clip": False}
    axes.annotate("", (-half, y), (half, y), arrowprops=arrow, **ends)
    text: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": FONT}
    box = {"facecolor": "white", "edgecolor": "none", "pad": 1.5}
    axes.text(0, y, f"{muscle.length:g} mm", bbox=box, transform=below, **text)


def _name_bodies(axes: Axes, muscle: Muscle, bodies: list[Body]) -> None:
    """Names of what is seen, above and below in turn."""
    seen = [body for body in bodies if body.stop > body.start]
    scale = min(OPENED[2] / np.ptp(axes.get_xlim()), OPENED[3] / np.ptp(axes.get_ylim()))
    for up, named in ((1, seen[::2]), (-1, seen[1::2])):
        turn = np.array(-up * POINTED)
        ends = [project(body.radius, turn, (body.start + body.stop) / 2) for body in named]
        places = spread([float(end[0]) for end in ends], NAME / scale)
        for body, end, along in zip(named, ends, places, strict=True):
            axes.annotate(
                body.name,
                tuple(end),
                (along, up * (muscle.outer_radius + ROW / scale)),
                ha="center",
                va="center",
                fontsize=FONT,
                color="black" if body.layer is None else colour_of(body.layer),
                arrowprops={"arrowstyle": "-", "shrinkA": 1, **LINE},
                annotation_clip=False,
            )


def _section(figure: Figure, muscle: Muscle) -> None:
    """A slice of the wall across the axis, at mid-length, and the radii in it."""
    inner, outer = muscle.inner_radius, muscle.outer_radius
    half = SLICE * muscle.wall_thickness / outer  # [rad]
    scale = SECTION[2] / (2 * outer * half)  # [inch/mm]
    axes = _axes(figure, SECTION)
    axes.set_xlim(-outer * half, outer * half)
    axes.set_ylim(outer - SECTION[3] / scale, outer)

    turn = np.linspace(-half, half, 50)
    wall = np.concatenate([_across(inner, turn), _across(outer, -turn)])
    axes.add_patch(
        Polygon(wall, facecolor=str(CUT), edgecolor="black", linewidth=EDGE, clip_on=False)
    )
    for layer in range(len(muscle.layers)):
        _cut_threads(axes, muscle, layer, half)

    within = [k for k, layer in enumerate(muscle.layers) if layer.kind is Kind.EMBEDDED]
    radii = [inner, *(muscle.layers[k].radius for k in within), outer]
    colours = ["black", *map(colour_of, within), "black"]
    ends = [(radius * math.sin(half), radius * math.cos(half)) for radius in radii]
    heights = spread([float(y) for _, y in ends], ROW / scale)
    beside = outer * half + 0.15 / scale
    for radius, colour, end, height in zip(radii, colours, ends, heights, strict=True):
        axes.plot([end[0], beside], [end[1], height], clip_on=False, **LINE)
        text = f" {radius:g} mm"
        axes.text(beside, height, text, va="center", fontsize=FONT, color=colour)
    axes.text(-outer * half, outer + 0.12 / scale, "radii in the wall", fontsize=FONT)
    if muscle.braid:
        note = "threads are curves: their\nwidth is drawn to be seen"
        below = inner * math.cos(half) - 0.2 / scale
        axes.text(-outer * half, below, note, va="top", fontsize=FONT - 1, color=SOFT)


def _cut_threads(axes: Axes, muscle: Muscle, layer: int, half: float) -> None:
    """The threads of a layer across the axis, within an angle on both sides; no wider than fits."""
    wound = muscle.layers[layer]
    radius, apart = drawn_radius(wound), 2 * math.pi / wound.threads
    radii = [muscle.inner_radius, *muscle.layer_radii, muscle.outer_radius]
    size = min(COVER * radius * apart, *np.diff(radii)) / 2
    turn = np.linspace(-half, half, 50)
    axes.plot(*_across(radius, turn).T, color=colour_of(layer), linewidth=EDGE)
    number = int((half - size / radius) / apart)
    for centre in _across(radius, np.arange(-number, number + 1) * apart):
        axes.add_patch(Circle(tuple(centre), size, color=colour_of(layer), linewidth=0))


def _across(radius: float, turn: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
    """Points of a section across the axis, by the angle from upwards."""
    return np.stack([radius * np.sin(turn), radius * np.cos(turn)], axis=-1)


def _write_numbers(figure: Figure, muscle: Muscle) -> None:
    """The muscle's numbers as a small table."""
    left, right, top = NUMBERS
    for number, (name, value) in enumerate(numbers(muscle)):
        y = (top - number * LINE_PITCH) / HEIGHT
        figure.text(left / WIDTH, y, name, ha="left", va="center", fontsize=FONT)
        figure.text(right / WIDTH, y, value, ha="right", va="center", fontsize=FONT)
