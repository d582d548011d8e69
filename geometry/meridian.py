"""The inner line of the half muscle, from mid-length to the cap: the membrane's curve mesh.

Coordinates x = R (the inner radius everywhere), y = Z, z = 0, in mm.
"""

from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

from geometry.gmsh_file import writing
from geometry.grading import OF_DIAMETER, OF_WALL, Grading
from geometry.labels import Boundary
from geometry.muscle import ONE, Muscle
from geometry.seal import seal

FIRST_FREE_TAG = 100  # above every label


@dataclass(frozen=True, kw_only=True)
class MeridianMesh(Grading):
    """Numerics of the curve mesh: about 15 segments for the muscle of the paper."""

    cap_step: float = field(default=0.5, metadata=OF_WALL)
    growth: float = field(default=1.35, metadata=ONE)
    body_step: float = field(default=1.0, metadata=OF_DIAMETER)


def length(muscle: Muscle) -> float:
    """Length of the meshed line [mm]."""
    return muscle.length / 2


def write(muscle: Muscle, mesh: MeridianMesh, path: Path) -> None:
    """Write the line as a Medit file for FreeFEM's ``readmeshL`` (14 significant digits).

    Every node is a point of the model, because the nodes of a transfinite curve with progression
    are right to 1e-9 only. Medit has no groups of points: FreeFEM takes the label of an
    end from the tag of the point there, so the tags of the two ends are their labels.
    """
    import gmsh

    stations = mesh.half_length_stations(muscle)
    tags = [
        Boundary.MIDPLANE,
        *range(FIRST_FREE_TAG, FIRST_FREE_TAG + len(stations) - 2),
        Boundary.END,
    ]
    with writing(path, ".mesh", seal):
        geo = gmsh.model.geo
        for tag, z in zip(tags, stations, strict=True):
            geo.addPoint(muscle.inner_radius, z, 0, tag=tag)
        lines = [geo.addLine(a, b) for a, b in pairwise(tags)]
        for line in lines:
            geo.mesh.setTransfiniteCurve(line, 2)
        geo.synchronize()
        gmsh.model.addPhysicalGroup(1, lines, Boundary.INNER, Boundary.INNER.name)
        gmsh.option.setNumber("Mesh.SaveElementTagType", 2)  # lines labelled by their group
        gmsh.model.mesh.generate(1)
