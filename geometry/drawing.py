"""A picture of the muscle (the paper's Fig. 3): all threads, the layers laid open, the numbers.

The view is orthographic, from beside the axis and a little from its positive end. Every body is a
cylinder about the axis, and each further along the axis is nearer to the viewer; so bodies are
painted in this order, and of a surface what faces the viewer is what is seen.
"""

import math
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray

from geometry.muscle import Muscle
from geometry.whole import thread_points

WIDTH, HEIGHT = 7.0, 3.7  # of the figure [inch]
WHOLE = (0.15, 2.62, 6.7, 1.0)  # left, bottom, width, height of the axes [inch]
OPENED = (0.15, 0.1, 4.35, 2.3)
NUMBERS = (4.75, 0.35, 2.1, 1.9)
TURNED = math.radians(24)  # of the axis, out of the plane of the paper
LIGHT = math.radians(40)  # of the light, above the viewer
FONT = 8.5  # [pt]
STEPS_PER_TURN = 48  # of a drawn thread
STRIPS = 48  # of the seen half of a cylinder
RUBBER, BENEATH, CAP = (0.62, 0.90), (0.80, 0.99), (0.30, 0.62)  # darkest and lightest grey
LAYERS = (  # colours that also differ in grey
    {"color": "#12357a", "label": "inner layer, clockwise"},
    {"color": "#f0750f", "label": "outer layer, counter-clockwise"},
)


@dataclass(frozen=True)
class _Body:
    """A piece of cylinder, and the thread layer on it that is to be seen."""

    radius: float
    start: float
    stop: float
    greys: tuple[float, float]
    layers: tuple[int, ...] = ()


def draw(muscle: Muscle) -> Figure:
    """Draw the muscle whole, with both layers seen through the rubber, and laid open at one end."""
    figure = Figure(figsize=(WIDTH, HEIGHT))
    half, outer = muscle.length / 2, muscle.outer_radius
    layers = tuple(range(len(muscle.layer_radii)))
    cap_start, cap_stop = half, half + muscle.cap_length
    tube = _Body(outer, -half, half, BENEATH if layers else RUBBER, layers)
    caps = [_Body(outer, a, b, CAP) for a, b in ((-cap_stop, -cap_start), (cap_start, cap_stop))]

    whole = _axes(figure, WHOLE)
    _paint(whole, muscle, [caps[0], tube, caps[1]])
    _dimension(whole, muscle)

    opened = _axes(figure, OPENED)
    bodies = _laid_open(muscle)
    _paint(opened, muscle, [caps[0], *bodies])
    _face(opened, muscle.inner_radius, bodies[-1].stop, "0.25")
    _name_bodies(opened, muscle, bodies)

    _write_numbers(figure, muscle)
    return figure


def numbers(muscle: Muscle) -> list[tuple[str, str]]:
    """Names of the muscle's numbers, and the numbers with their units, as they are drawn."""
    rows = [
        ("inner diameter", f"{muscle.inner_diameter:g} mm"),
        ("wall thickness", f"{muscle.wall_thickness:g} mm"),
        ("length between caps", f"{muscle.length:g} mm"),
    ]
    braid = muscle.braid
    if braid is None:
        return [*rows, ("threads", "none")]
    inner, outer = braid.layer_diameters
    return [
        *rows,
        ("layer diameters", f"{inner:g} and {outer:g} mm"),
        ("threads", f"{braid.threads} in each layer"),
        ("lead", f"{braid.lead:.5g} mm"),
        ("axial spacing", f"{braid.axial_spacing:.4g} mm"),
        ("braid angle", f"{math.degrees(braid.angle):.1f}°"),
    ]


def _laid_open(muscle: Muscle) -> list[_Body]:
    """Near one cap, the wall taken off in steps: on layer 2, on layer 1, at the tube's end."""
    outer = muscle.outer_radius
    surfaces: list[tuple[float, float, tuple[int, ...]]] = [(1.7, outer, ())]
    for layer, radius in reversed(list(enumerate(muscle.layer_radii))):
        surfaces.append((1.7, radius, (layer,)))
    share = min(1.0, muscle.length / (outer * sum(length for length, _, _ in surfaces)))
    bodies, start = [], -muscle.length / 2
    for length, radius, layers in surfaces:
        stop = start + share * length * outer
        bodies.append(_Body(radius, start, stop, BENEATH if layers else RUBBER, layers))
        start = stop
    return bodies


def _axes(figure: Figure, place: tuple[float, float, float, float]) -> Axes:
    """Empty axes in mm, at a place in inch."""
    left, bottom, width, height = place
    axes = figure.add_axes((left / WIDTH, bottom / HEIGHT, width / WIDTH, height / HEIGHT))
    axes.set_axis_off()
    axes.set_aspect("equal", adjustable="datalim")
    return axes


def _project(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Where points (..., 3) of the muscle lie on the paper (..., 2); the axis runs to the right."""
    x, y, z = np.moveaxis(points, -1, 0)
    return np.stack([math.cos(TURNED) * z - math.sin(TURNED) * x, -y], axis=-1)


def _faces_viewer(points: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether a cylinder's surface is seen at its points (..., 3); the viewer is where x > 0."""
    return np.asarray(points[..., 0] >= 0)


def _circle(radius: float, z: float, turn: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points of a circle about the axis, at angles from the viewer's side [rad]."""
    points = radius * np.cos(turn), radius * np.sin(turn), np.full_like(turn, z)
    return np.stack(points, axis=-1)


def _paint(axes: Axes, muscle: Muscle, bodies: list[_Body]) -> None:
    """Paint bodies from the farthest to the nearest, and set the limits of the axes."""
    ends = [(bodies[0].radius, bodies[0].start), (bodies[-1].radius, bodies[-1].stop)]
    turn = np.linspace(0, 2 * math.pi, 4 * STRIPS)
    around = np.concatenate([_project(_circle(radius, z, turn)) for radius, z in ends])
    axes.update_datalim(around)
    axes.margins(0.01)
    axes.autoscale_view()
    for body in bodies:
        if body.stop > body.start:
            _surface(axes, body)
            _face(axes, body.radius, body.stop, str(body.greys[1]))
            for layer in body.layers:
                _threads(axes, muscle, layer, body)


def _surface(axes: Axes, body: _Body) -> None:
    """The seen half of a cylinder, shaded."""
    turn = np.linspace(-math.pi / 2, math.pi / 2, STRIPS + 1)
    far, near = (_project(_circle(body.radius, z, turn)) for z in (body.start, body.stop))
    strips = np.stack([far[:-1], far[1:], near[1:], near[:-1]], axis=1)
    middle = (turn[:-1] + turn[1:]) / 2
    dark, light = body.greys
    grey = dark + (light - dark) * np.clip(np.cos(middle + LIGHT), 0, 1)
    colours = [str(round(shade, 3)) for shade in grey]
    axes.add_collection(
        PolyCollection(
            list(strips), facecolors=colours, edgecolors=colours, linewidths=0.4, zorder=1
        ),
        autolim=False,
    )
    outline = [far, np.stack([far[0], near[0]]), np.stack([far[-1], near[-1]])]
    axes.add_collection(
        LineCollection(outline, colors="black", linewidths=0.6, zorder=1), autolim=False
    )


def _face(axes: Axes, radius: float, z: float, grey: str) -> None:
    """The end of a cylinder, which the viewer sees whole."""
    edge = _project(_circle(radius, z, np.linspace(0, 2 * math.pi, 4 * STRIPS)))
    axes.add_collection(
        PolyCollection([edge], facecolors=grey, edgecolors="black", linewidths=0.6, zorder=1),
        autolim=False,
    )


def _threads(axes: Axes, muscle: Muscle, layer: int, body: _Body) -> None:
    """What is seen of the threads of one layer on one body."""
    assert muscle.braid is not None
    steps = math.ceil(STEPS_PER_TURN * (body.stop - body.start) / muscle.braid.lead)
    z = np.linspace(body.start, body.stop, max(steps, 8) + 1)
    runs = []
    for thread in thread_points(muscle, layer, z):
        seen = _faces_viewer(thread)
        for run in np.split(np.arange(len(z)), np.flatnonzero(np.diff(seen)) + 1):
            if seen[run[0]] and len(run) > 1:
                runs.append(_project(thread[run]))
    gap = muscle.braid.axial_spacing * math.sin(muscle.braid.angle)  # between threads [mm]
    size = axes.get_position().width * WIDTH * 72 / np.ptp(axes.get_xlim())  # [pt/mm]
    axes.add_collection(
        LineCollection(
            runs,
            colors=LAYERS[layer]["color"],
            linewidths=min(1.4, 0.36 * gap * size),
            capstyle="butt",
            zorder=1,
        ),
        autolim=False,
    )


def _dimension(axes: Axes, muscle: Muscle) -> None:
    """The length between the caps, under the whole muscle."""
    half, below = muscle.length / 2 * math.cos(TURNED), -1.45 * muscle.outer_radius
    arrow = {"arrowstyle": "<|-|>", "linewidth": 0.6, "shrinkA": 0, "shrinkB": 0, "color": "black"}
    axes.annotate("", (-half, below), (half, below), arrowprops=arrow, annotation_clip=False)
    box = {"facecolor": "white", "edgecolor": "none", "pad": 1.5}
    axes.text(0, below, f"{muscle.length:g} mm", ha="center", va="center", fontsize=FONT, bbox=box)


def _name_bodies(axes: Axes, muscle: Muscle, bodies: list[_Body]) -> None:
    """Names of what is seen, above and below each step, in turn."""
    for number, body in enumerate(bodies):
        name = LAYERS[body.layers[0]]["label"] if body.layers else "rubber wall"
        colour = LAYERS[body.layers[0]]["color"] if body.layers else "black"
        up = 1 if number % 2 == 0 else -1
        along = math.cos(TURNED) * (body.start + body.stop) / 2
        axes.annotate(
            name,
            (along, up * 0.8 * body.radius),
            (along, up * 1.45 * muscle.outer_radius),
            ha="center",
            va="center",
            fontsize=FONT,
            color=colour,
            arrowprops={"arrowstyle": "-", "linewidth": 0.7, "color": "black", "shrinkA": 1},
            annotation_clip=False,
        )


def _write_numbers(figure: Figure, muscle: Muscle) -> None:
    """The muscle's numbers as a small table."""
    left, bottom, width, height = NUMBERS
    rows = numbers(muscle)
    for number, (name, value) in enumerate(rows):
        y = (bottom + height * (1 - (number + 0.5) / len(rows))) / HEIGHT
        figure.text(left / WIDTH, y, name, ha="left", va="center", fontsize=FONT)
        figure.text((left + width) / WIDTH, y, value, ha="right", va="center", fontsize=FONT)
