"""The wall's half section, structured triangles: the mesh of the axisymmetric solid.

Coordinates x = R, y = Z, in mm. Thread layers are lines of the mesh, and so is Z = L/2, where
fields of the clamp have a kink::

    Z = L/2 + cap_length  +--+---+------+   END        (clamp only; else END is at Z = L/2)
    Z = L/2               +--+---+------+
                          |  |   |      |
                    INNER |  |   |      | OUTER
                          |  |   |      |
    Z = 0                 +--+---+------+   MIDPLANE
                            LAYER_1, LAYER_2
"""

from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geometry.gmsh_file import writing
from geometry.grading import RAMP, UnbuildableMesh
from geometry.labels import Boundary, Region
from geometry.mesh_settings import SectionMesh
from geometry.muscle import Muscle
from geometry.refusal import build
from geometry.seal import seal

KEYS = {"mesh", "end"}  # of a specification, beside kind and muscle
OPTIONAL = {"ramp"}  # of a clamp, in wall thicknesses
ENDS = ("clamp", "butt", "sliding")


def area(muscle: Muscle, end: str) -> float:
    """Area of the meshed section [mm2]."""
    clamped = muscle.cap_length if end == "clamp" else 0
    return muscle.wall_thickness * (muscle.length / 2 + clamped)


def stations(
    muscle: Muscle, mesh: SectionMesh, end: str, ramp: float = RAMP
) -> NDArray[np.float64]:
    """Z of the rows of nodes [mm]; ``ramp`` is that of a clamp [wall thickness].

    Raises
    ------
    UnbuildableMesh
        If there is no such end, or no cap length for a clamp.
    """
    if end not in ENDS:
        raise UnbuildableMesh("end", end, f"one of {', '.join(ENDS)}")
    free = mesh.half_length_stations(muscle)
    if end != "clamp":
        return free
    return np.concatenate([free, mesh.clamp_stations(muscle, ramp)])


def write(muscle: Muscle, mesh: SectionMesh, end: str, path: Path, ramp: float = RAMP) -> None:
    """Write the section as MSH 2.2 for FreeFEM's ``gmshload``, boundaries and wall labelled.

    Diagonals alternate along Z, counted from the cap, so that those beside it, where they matter
    most, are the same however many intervals the body has.
    """
    import gmsh

    heights = stations(muscle, mesh, end, ramp)
    cap = int(np.searchsorted(heights, muscle.length / 2))  # the interval above it
    radii = [muscle.inner_radius, *muscle.layer_radii, muscle.outer_radius]
    rows = mesh.bands(len(muscle.layer_radii))
    with writing(path, ".msh", seal):
        geo = gmsh.model.geo
        points = [[geo.addPoint(r, z, 0) for z in heights] for r in radii]
        axial = [_lines(column) for column in points]
        radial = [_lines(level) for level in zip(*points, strict=True)]
        for column in axial:
            for line in column:
                geo.mesh.setTransfiniteCurve(line, 2)
        for level in radial:
            for line, count in zip(level, rows, strict=True):
                geo.mesh.setTransfiniteCurve(line, count * mesh.refinement + 1)
        cells = [
            _cell(
                radial[j][b],
                axial[b + 1][j],
                radial[j + 1][b],
                axial[b][j],
                flip=(j - cap) % 2 == 0,
            )
            for b in range(len(rows))
            for j in range(len(heights) - 1)
        ]
        geo.synchronize()
        _name_groups(axial, radial, cells)
        gmsh.option.setNumber("Mesh.MshFileVersion", 2.2)
        gmsh.model.mesh.generate(2)


def _lines(points: tuple[int, ...] | list[int]) -> list[int]:
    """Lines that join neighbouring points."""
    import gmsh

    return [gmsh.model.geo.addLine(a, b) for a, b in pairwise(points)]


def _cell(below: int, right: int, above: int, left: int, *, flip: bool) -> int:
    """One axial interval of one band; ``flip`` turns its diagonals, to alternate along Z."""
    import gmsh

    geo = gmsh.model.geo
    cell: int = geo.addPlaneSurface([geo.addCurveLoop([below, right, -above, -left])])
    geo.mesh.setTransfiniteSurface(cell, "AlternateRight" if flip else "AlternateLeft")
    return cell


def _name_groups(axial: list[list[int]], radial: list[list[int]], cells: list[int]) -> None:
    """Physical groups, by the numbers and names of ``geometry.labels``."""
    import gmsh

    inner, *layers, outer = axial
    groups = {
        Boundary.MIDPLANE: radial[0],
        Boundary.END: radial[-1],
        Boundary.INNER: inner,
        Boundary.OUTER: outer,
        **dict(zip((Boundary.LAYER_1, Boundary.LAYER_2), layers, strict=False)),
    }
    for boundary, lines in groups.items():
        gmsh.model.addPhysicalGroup(1, lines, boundary, boundary.name)
    gmsh.model.addPhysicalGroup(2, cells, Region.WALL, Region.WALL.name)


def from_spec(muscle: Muscle, spec: Mapping[str, Any], output: Path) -> None:
    """Write what a specification describes."""
    mesh, ramp = build(SectionMesh, spec["mesh"], UnbuildableMesh, "mesh"), spec.get("ramp", RAMP)
    if "ramp" in spec and spec["end"] != "clamp":
        raise UnbuildableMesh("ramp", ramp, "none where the end is no clamp")
    write(muscle, mesh, spec["end"], output, ramp)
