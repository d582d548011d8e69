"""The whole muscle in three dimensions: tube, caps and every thread, for other programs (STEP).

The axis is Z with mid-length at 0, lengths in mm. Threads are curves without thickness, as in the
paper (section 2.2.1); caps are solid cylinders as wide as the tube.
"""

import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from geometry.gmsh_file import writing
from geometry.muscle import Muscle

# A spline through 64 points a turn keeps within 1e-3 mm of helices up to a metre wide;
# its error grows with the radius and falls with the fourth power of the points.
POINTS_PER_TURN = 64
MIN_POINTS = 16  # however small a part of a turn the muscle has
TURNING = (1, -1)  # clockwise and counter-clockwise, going away from the viewer along Z


def volume(muscle: Muscle) -> float:
    """Volume of the tube's rubber between the caps [mm3]."""
    return math.pi * (muscle.outer_radius**2 - muscle.inner_radius**2) * muscle.length


def thread_points(muscle: Muscle, layer: int) -> NDArray[np.float64]:
    """Points along all threads of a layer (0 inner, 1 outer) of a braided muscle [mm].

    Returns
    -------
    array of shape (threads, points, 3), from Z = -L/2 to L/2
    """
    braid = muscle.braid
    if braid is None:
        raise ValueError("a bare tube has no threads")
    count = max(MIN_POINTS, math.ceil(POINTS_PER_TURN * muscle.length / braid.lead))
    z = np.linspace(-muscle.length / 2, muscle.length / 2, count + 1)
    start = 2 * math.pi * np.arange(braid.threads) / braid.threads
    turn = start[:, None] + TURNING[layer] * 2 * math.pi * z / braid.lead
    radius = muscle.layer_radii[layer]
    points = radius * np.cos(turn), radius * np.sin(turn), np.broadcast_to(z, turn.shape)
    return np.stack(points, axis=-1)


def write(muscle: Muscle, path: Path) -> None:
    """Write tube, caps and threads as a STEP file."""
    import gmsh

    with writing(path, ".step"):
        occ = gmsh.model.occ
        half, outer = muscle.length / 2, muscle.outer_radius
        tube = occ.addCylinder(0, 0, -half, 0, 0, muscle.length, outer)
        bore = occ.addCylinder(0, 0, -half, 0, 0, muscle.length, muscle.inner_radius)
        occ.cut([(3, tube)], [(3, bore)])
        if muscle.cap_length > 0:
            for side in (-1, 1):
                occ.addCylinder(0, 0, side * half, 0, 0, side * muscle.cap_length, outer)
        for layer in range(len(muscle.layer_radii)):
            _add_threads(thread_points(muscle, layer))
        occ.synchronize()


def _add_threads(threads: NDArray[np.float64]) -> None:
    """One thread through its points, the others as copies of it turned about the axis."""
    import gmsh

    occ = gmsh.model.occ
    points = [occ.addPoint(*point) for point in threads[0]]
    first = (1, occ.addSpline(points))
    occ.remove([(0, point) for point in points[1:-1]])
    for number in range(1, len(threads)):
        copy = occ.copy([first])
        occ.rotate(copy, 0, 0, 0, 0, 0, 1, 2 * math.pi * number / len(threads))
