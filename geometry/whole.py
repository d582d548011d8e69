"""The whole muscle in three dimensions: tube, caps and every thread, for other programs (STEP).

The axis is Z with mid-length at 0, lengths in mm. Threads are curves without thickness, as in the
paper (section 2.2.1); caps are solid cylinders as wide as the tube. The parts have names: tube,
cap 1, cap 2, thread clockwise 1, ...
"""

import math
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geometry.braid import Layer
from geometry.gmsh_file import writing
from geometry.muscle import Muscle, UnbuildableMuscle

KEYS: set[str] = set()  # of a specification, beside kind and muscle
DEVIATION = 1e-4  # of a thread's spline from its helix [mm]
END_ERROR = 0.04  # of splines through points of a helix, see spline_heights
MIN_STEPS = 16  # of a spline, however small a part of a turn the muscle has
MAX_STEPS = 20_000  # more is a slip of the pen, not a braid
TURNING = {"clockwise": 1, "counter-clockwise": -1}  # going away from the viewer along Z


def volume(muscle: Muscle) -> float:
    """Volume of the tube's rubber between the caps [mm3]."""
    return math.pi * (muscle.outer_radius**2 - muscle.inner_radius**2) * muscle.length


def thread_turns(muscle: Muscle, layer: int, z: NDArray[np.float64]) -> NDArray[np.float64]:
    """Angles about the axis of all threads of a layer (inner first) at heights Z [rad].

    Returns
    -------
    array of shape (threads, heights); at Z = 0 the first thread of each layer is at 0

    Raises
    ------
    UnbuildableMuscle
        If the muscle has no braid.
    """
    wound = _layer(muscle, layer)
    start = 2 * math.pi * np.arange(wound.threads) / wound.threads
    return np.asarray(start[:, None] + wound.sense * 2 * math.pi * z / wound.lead)


def thread_points(muscle: Muscle, layer: int, z: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points of all threads of a layer at heights Z, shape (threads, heights, 3) [mm]."""
    turns, radius = thread_turns(muscle, layer, z), drawn_radius(_layer(muscle, layer))
    points = radius * np.cos(turns), radius * np.sin(turns), np.broadcast_to(z, turns.shape)
    return np.stack(points, axis=-1)


def drawn_radius(layer: Layer) -> float:
    """Radius of its threads on the unloaded muscle; a narrow sleeve is stretched [mm]."""
    return max(layer.radius, layer.carrier)


def spline_heights(muscle: Muscle, layer: int) -> NDArray[np.float64]:
    """Heights Z of the points through which the splines of a layer pass, -L/2 to L/2 [mm].

    A spline through points of a helix a step apart (an angle) deviates most in its first and last
    interval, measured as END_ERROR radius step^4; between them by a third of that.

    Raises
    ------
    UnbuildableMuscle
        If there is no braid, or so small a lead that this takes too many points.
    """
    lead, half = _layer(muscle, layer).lead, muscle.length / 2
    step = (DEVIATION / (END_ERROR * drawn_radius(_layer(muscle, layer)))) ** 0.25
    count = max(MIN_STEPS, math.ceil(2 * math.pi * muscle.length / lead / step))
    if count > MAX_STEPS:
        least = lead * count / MAX_STEPS
        raise UnbuildableMuscle("lead", lead, f"at least {least:.3g} mm, to draw every thread")
    return np.linspace(-half, half, count + 1)


def write(muscle: Muscle, path: Path) -> None:
    """Write tube, caps and threads as a STEP file.

    Raises
    ------
    UnbuildableMuscle
        If its lead is too small for threads to be drawn one by one.
    """
    import gmsh

    threads = [
        thread_points(muscle, layer, spline_heights(muscle, layer))
        for layer in range(len(muscle.layers))
    ]
    names = ["tube"]
    with writing(path, ".step", lambda step: _tidy(step, names)):
        occ = gmsh.model.occ
        half, outer = muscle.length / 2, muscle.outer_radius
        tube = occ.addCylinder(0, 0, -half, 0, 0, muscle.length, outer)
        bore = occ.addCylinder(0, 0, -half, 0, 0, muscle.length, muscle.inner_radius)
        occ.cut([(3, tube)], [(3, bore)])
        if muscle.cap_length > 0:
            for side in (-1, 1):
                occ.addCylinder(0, 0, side * half, 0, 0, side * muscle.cap_length, outer)
            names += ["cap 1", "cap 2"]
        count = dict.fromkeys(TURNING, 0)
        for points, layer in zip(threads, muscle.layers, strict=True):
            _add_threads(points)
            turning = next(name for name, sense in TURNING.items() if sense == layer.sense)
            before, count[turning] = count[turning], count[turning] + layer.threads
            names += [f"thread {turning} {number + 1}" for number in range(before, count[turning])]
        occ.synchronize()


def _layer(muscle: Muscle, number: int) -> Layer:
    """A layer of a muscle that must have some."""
    if muscle.braid is None:
        raise UnbuildableMuscle("braid", None, "a braid, where threads are asked for")
    return muscle.layers[number]


def _add_threads(threads: NDArray[np.float64]) -> None:
    """One thread through its points, the others as copies of it turned about the axis."""
    import gmsh

    occ = gmsh.model.occ
    tags = [occ.addPoint(*point) for point in threads[0]]
    first = (1, occ.addSpline(tags))
    occ.remove([(0, tag) for tag in tags[1:-1]])
    for number in range(1, len(threads)):
        copy = occ.copy([first])
        occ.rotate(copy, 0, 0, 0, 0, 0, 1, 2 * math.pi * number / len(threads))


def _tidy(step: Path, names: list[str]) -> None:
    """Name the parts of a STEP file, and take out what differs from one writing to the next.

    That is the time in the header, and numbers that OpenCASCADE counts through a process.
    """

    def name(found: re.Match[str]) -> str:
        part = found["part"]
        return f"'{names[int(part) - 1]}'" if part else "'muscle'"

    text = re.sub(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d", "", step.read_text(), count=1)
    text = re.sub(r"'Open CASCADE STEP translator [\d.]+ \d+(\.(?P<part>\d+))?'", name, text)
    numbers = iter(range(1, len(names) + 1))
    text = re.sub(r"(?<=OCCURRENCE\(')\d+", lambda _: str(next(numbers)), text)
    step.write_text(text)


def from_spec(muscle: Muscle, _spec: Mapping[str, Any], output: Path) -> None:
    """Write what a specification describes."""
    write(muscle, output)
