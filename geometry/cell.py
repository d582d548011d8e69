r"""The periodic cell of the braid: what repeats around and along the tube, as tetrahedra.

One sector between neighbouring threads, one axial thread spacing long. It is meshed as a box, in
cylindrical coordinates of the reference shape: x = R, y = R_m T with R_m the mean radius of the
wall, z = Z, in mm, so that periodic faces match by translation and curved walls cost nothing. The
thread of each layer is a diagonal of the box::

    Z = spacing +---------+          LAYER_1 rises with T, LAYER_2 falls; they cross in the middle
                | \     / |          and at the corners, which are one point of the muscle
                |   \ /   |
                |   / \   |
                | /     \ |
    Z = 0       +---------+
                T = 0     T = 2 pi / sectors

A thread is no volume of the mesh: the solver spreads it over a tube of a given radius, and the mesh
is finer there.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from geometry.gmsh_file import writing
from geometry.grading import UnbuildableMesh
from geometry.labels import Boundary, Region
from geometry.mesh_settings import CellMesh
from geometry.muscle import Braid, LayeredBraid, Muscle
from geometry.refusal import build, is_number
from geometry.seal import seal

KEYS = {"mesh", "thread_radius", "thread_lines"}  # of a specification, beside kind and muscle
# Faces of a gmsh box in the order of their tags.
FACES = (
    Boundary.INNER,
    Boundary.OUTER,
    Boundary.ANGLE_LOW,
    Boundary.ANGLE_HIGH,
    Boundary.AXIAL_LOW,
    Boundary.AXIAL_HIGH,
)


@dataclass(frozen=True)
class Box:
    """The cell of a muscle: how often it repeats, and its sides.

    A bare tube has no braid to repeat; its cell is about as wide and long as the wall is thick.
    """

    muscle: Muscle

    @property
    def _braid(self) -> Braid | None:
        """The braid, which has one lead: no other repeats."""
        braid = self.muscle.braid
        assert not isinstance(braid, LayeredBraid)  # refused in a case (solver/models/cell)
        return braid

    @property
    def mean_radius(self) -> float:
        """Radius at which y is arc length, that of the wall's middle [mm]."""
        return (self.muscle.inner_radius + self.muscle.outer_radius) / 2

    @property
    def sectors(self) -> int:
        """Cells around the tube."""
        if self._braid is not None:
            return self._braid.threads
        return max(3, round(2 * math.pi * self.mean_radius / self.muscle.wall_thickness))

    @property
    def width(self) -> float:
        """Extent along y [mm]."""
        return 2 * math.pi * self.mean_radius / self.sectors

    @property
    def spacing(self) -> float:
        """Extent along the axis of one cell [mm]."""
        braid = self._braid
        return braid.axial_spacing if braid is not None else self.muscle.wall_thickness

    def distance(self, x: float, y: float, z: float) -> float:
        """From a point of the box to the nearest thread, other cells' included [mm]."""
        if self.muscle.braid is None:
            return math.inf
        nearest = math.inf
        share, step = y / self.width, z / self.spacing
        for sense, radius, angle in zip(
            (1, -1), self.muscle.layer_radii, self.muscle.braid.layer_angles, strict=True
        ):
            turns = share - sense * step
            arc = (turns - round(turns)) * 2 * math.pi * radius / self.sectors
            nearest = min(nearest, math.hypot(x - radius, arc * math.cos(angle)))
        return nearest


def volume(muscle: Muscle, mesh: CellMesh) -> float:
    """Volume of the meshed box, in its own coordinates [mm3]."""
    box = Box(muscle)
    return muscle.wall_thickness * box.width * box.spacing * mesh.repeats


def write(
    muscle: Muscle,
    mesh: CellMesh,
    thread_radius: float | None,
    path: Path,
    *,
    thread_lines: bool = False,
) -> None:
    """Write the cell as a Medit file for FreeFEM's ``readmesh3``, faces labelled.

    ``thread_radius`` is that of the tubes over which the threads are spread [mm]; None for a bare
    tube. With ``thread_lines`` every thread is a line of the mesh, for wires of zero thickness.

    Raises
    ------
    UnbuildableMesh
        If the thread radius is no positive number, or given for a bare tube.
    """
    import gmsh

    if (thread_radius is None) is not (muscle.braid is None):
        raise UnbuildableMesh("thread_radius", thread_radius, "a number with a braid, else none")
    if thread_radius is not None and not (is_number(thread_radius) and thread_radius > 0):
        raise UnbuildableMesh("thread_radius", thread_radius, "a finite number > 0 (mm)")
    box = Box(muscle)
    length = box.spacing * mesh.repeats
    with writing(path, ".mesh", seal):
        gmsh.model.occ.addBox(
            muscle.inner_radius, 0, 0, muscle.wall_thickness, box.width, length, tag=1
        )
        if thread_lines:
            _add_thread_lines(box, mesh)
        gmsh.model.occ.synchronize()
        for label in FACES:
            gmsh.model.addPhysicalGroup(2, [FACES.index(label) + 1], label, label.name)
        gmsh.model.addPhysicalGroup(3, [1], Region.WALL, Region.WALL.name)
        _make_periodic(Boundary.ANGLE_LOW, Boundary.ANGLE_HIGH, (0, box.width, 0))
        _make_periodic(Boundary.AXIAL_LOW, Boundary.AXIAL_HIGH, (0, 0, length))
        _set_sizes(box, mesh, thread_radius)
        gmsh.option.setNumber("Mesh.SaveElementTagType", 2)  # faces labelled by their group
        gmsh.model.mesh.generate(3)


def _add_thread_lines(box: Box, mesh: CellMesh) -> None:
    """Make every thread a line of the mesh, with its ends on all edges that are one by period.

    Off the lines of the mesh a wire would cut through tetrahedra, and turn them inside out. Threads
    that are spread over tubes do better without: their force is 0.02 % off then, else 0.2 %.
    """
    import gmsh

    occ, parts = gmsh.model.occ, []
    for radius, falls in zip(box.muscle.layer_radii, (False, True), strict=False):
        heights = [k * box.spacing for k in range(mesh.repeats + 1)]
        ends = [[occ.addPoint(radius, y, z) for z in heights] for y in (0, box.width)]
        low, high = reversed(ends) if falls else ends
        parts += [(0, point) for column in ends for point in column]
        parts += [(1, occ.addLine(a, b)) for a, b in zip(low, high[1:], strict=False)]
    if parts:
        occ.fragment([(3, 1)], parts)


def _make_periodic(low: Boundary, high: Boundary, shift: tuple[float, float, float]) -> None:
    """The mesh of one face is that of the opposite one, moved by ``shift``."""
    import gmsh

    x, y, z = shift
    motion = [1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z, 0, 0, 0, 1]
    gmsh.model.mesh.setPeriodic(2, [FACES.index(high) + 1], [FACES.index(low) + 1], motion)


def _set_sizes(box: Box, mesh: CellMesh, thread_radius: float | None) -> None:
    """Element sizes by the distance to the nearest thread."""
    import gmsh

    body = mesh.body_size * box.muscle.wall_thickness / mesh.refinement
    radius = math.inf if thread_radius is None else thread_radius
    near = min(mesh.thread_size * radius / mesh.refinement, body)

    def size(_dim: int, _tag: int, x: float, y: float, z: float, _size: float) -> float:
        outside = max(box.distance(x, y, z) - radius, 0) if thread_radius is not None else 0
        return min(near + mesh.growth * outside, body)

    for source in ("FromPoints", "FromCurvature", "ExtendFromBoundary"):
        gmsh.option.setNumber(f"Mesh.MeshSize{source}", 0)
    gmsh.model.mesh.setSizeCallback(size)


def from_spec(muscle: Muscle, spec: Mapping[str, Any], output: Path) -> None:
    """Write what a specification describes."""
    mesh = build(CellMesh, spec["mesh"], UnbuildableMesh, "mesh")
    lines = spec["thread_lines"] is True
    write(muscle, mesh, spec["thread_radius"], output, thread_lines=lines)
