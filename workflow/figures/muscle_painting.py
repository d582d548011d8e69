"""Cylinders about one axis with threads on them, as a viewer sees them: 2-D polygons on axes.

The view is orthographic, from beside the axis and a little from its positive end, which is to the
right. Each body is a cylinder about the axis, and each further along the axis is nearer to the
viewer; so bodies are painted in this order, and of a surface what faces the viewer is seen.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from numpy.typing import NDArray

from geometry.muscle import Muscle
from geometry.whole import thread_turns

LAYER_COLOURS = ("#12357a", "#e2740f")  # inner, outer; they differ in grey too
MORE_COLOURS = ("#7a1242", "#d8c83a", "#2b5a4f", "#b0b0d8")  # of further families
TURNED = math.radians(24)  # of the axis, out of the plane of the paper
LIGHT = math.radians(35)  # of the light, above the viewer
STRIPS = 48  # of the seen half of a cylinder
STEPS_PER_TURN = 96  # of a drawn thread
COVER = 0.45  # of a layer that its threads cover, as drawn
EDGE = 0.6  # outlines [pt]
SEEN = math.pi / 2  # a cylinder is seen to this angle on both sides of the viewer


@dataclass(frozen=True, kw_only=True)
class Body:
    """A piece of cylinder, and the family of threads on it (0 innermost); lengths in mm."""

    name: str
    radius: float
    start: float
    stop: float
    greys: tuple[float, float]  # darkest and lightest
    layer: int | None = None


def colour_of(layer: int) -> str:
    """Of a family of threads."""
    every = LAYER_COLOURS + MORE_COLOURS
    return every[layer % len(every)]


def project(radius: float, turn: NDArray[np.float64], z: Any) -> NDArray[np.float64]:
    """Where points lie on the paper (..., 2), by their angle from the viewer's side [rad]."""
    across = math.cos(TURNED) * z - math.sin(TURNED) * radius * np.cos(turn)
    return np.stack(np.broadcast_arrays(across, -radius * np.sin(turn)), axis=-1)


def paint(axes: Axes, muscle: Muscle, bodies: Sequence[Body]) -> None:
    """Paint bodies, given from the farthest to the nearest."""
    for body in bodies:
        if body.stop > body.start:
            _surface(axes, body)
            if body.layer is not None:
                _threads(axes, muscle, body.layer, body)
            face(axes, body.radius, body.stop, body.greys[1])


def face(axes: Axes, radius: float, z: float, grey: float) -> None:
    """Paint the end of a cylinder, which the viewer sees whole."""
    edge = project(radius, np.linspace(0, 2 * math.pi, 4 * STRIPS), z)
    _add(axes, PolyCollection([edge], facecolors=str(grey), edgecolors="black", linewidths=EDGE))


def _surface(axes: Axes, body: Body) -> None:
    """The seen half of a cylinder, shaded."""
    turn = np.linspace(-SEEN, SEEN, STRIPS + 1)
    far, near = project(body.radius, turn, body.start), project(body.radius, turn, body.stop)
    strips = np.stack([far[:-1], far[1:], near[1:], near[:-1]], axis=1)
    dark, light = body.greys
    lit = np.clip(np.cos((turn[:-1] + turn[1:]) / 2 + LIGHT), 0, 1)
    colours = [str(round(grey, 3)) for grey in dark + (light - dark) * lit]
    shaded: dict[str, Any] = {
        "facecolors": colours,
        "edgecolors": colours,
        "linewidths": 0.4,
    }  # no gaps between
    _add(axes, PolyCollection(list(strips), **shaded))
    outline = [far, np.stack([far[0], near[0]]), np.stack([far[-1], near[-1]])]
    _add(axes, LineCollection(outline, colors="black", linewidths=EDGE))


def _threads(axes: Axes, muscle: Muscle, layer: int, body: Body) -> None:
    """What is seen of a layer's threads, as bands on the cylinder, cut off where it turns away."""
    wound = muscle.layers[layer]
    steps = math.ceil(STEPS_PER_TURN * (body.stop - body.start) / wound.lead)
    z = np.linspace(body.start, body.stop, max(steps, 8) + 1)
    half = COVER * math.pi / wound.threads  # width of a band [rad]
    bands = []
    for turns in thread_turns(muscle, layer, z):
        middle = np.remainder(turns + math.pi, 2 * math.pi) - math.pi
        seen = np.abs(middle) < SEEN + half
        breaks = np.flatnonzero((np.diff(seen.astype(int)) != 0) | (abs(np.diff(middle)) > SEEN))
        for first, last in pairwise([0, *(breaks + 1), len(z)]):
            if seen[first] and last - first > 1:
                run = slice(first, last)
                edges = [np.clip(middle[run] + side, -SEEN, SEEN) for side in (-half, half)]
                there, back = (project(body.radius, edge, z[run]) for edge in edges)
                bands.append(np.concatenate([there, back[::-1]]))
    _add(axes, PolyCollection(bands, facecolors=colour_of(layer), linewidths=0))


def _add(axes: Axes, collection: LineCollection | PolyCollection) -> None:
    """Put on top of what is there."""
    collection.set_zorder(1)
    collection.set_clip_on(False)
    axes.add_collection(collection, autolim=False)
