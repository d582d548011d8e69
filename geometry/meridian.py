"""The inner line of the half muscle, from mid-length to the cap: the membrane's curve mesh.

Coordinates x = R (the inner radius everywhere), y = Z, z = 0, in mm.
"""

from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any

from geometry.gmsh_file import writing
from geometry.grading import UnbuildableMesh
from geometry.labels import Boundary
from geometry.mesh_settings import MeridianMesh
from geometry.muscle import Muscle
from geometry.refusal import build
from geometry.seal import seal

KEYS = {"mesh"}  # of a specification, beside kind and muscle
FIRST_FREE_TAG = 100  # above every label


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


def from_spec(muscle: Muscle, spec: Mapping[str, Any], output: Path) -> None:
    """Write what a specification describes."""
    mesh = build(MeridianMesh, spec["mesh"], UnbuildableMesh, "mesh")
    write(muscle, mesh, output)
