"""The periodic cell: its exact volume, faces that match, threads where they belong."""

import math

import numpy as np
import pytest

from geometry import cell
from geometry.cell import Box
from geometry.grading import UnbuildableMesh
from geometry.labels import Boundary
from geometry.mesh_settings import CellMesh
from geometry.muscle import Muscle

RADIUS = 0.309  # of the tubes over which threads are spread [mm]


def read(path):
    """Points, triangles by label, tetrahedra of a Medit file."""
    columns = {"Vertices": 4, "Triangles": 4, "Tetrahedra": 5}
    words = iter(path.read_text().split())
    found = {}
    for word in words:
        if word in columns:
            numbers = [float(next(words)) for _ in range(int(next(words)) * columns[word])]
            found[word] = np.array(numbers).reshape(-1, columns[word])
    triangles = found["Triangles"].astype(int)
    return (
        found["Vertices"][:, :3],
        {label: triangles[triangles[:, 3] == label][:, :3] - 1 for label in Boundary},
        found["Tetrahedra"][:, :4].astype(int) - 1,
    )


@pytest.fixture(params=["braid", "bare", "two cells", "lines", "two cells, lines"])
def made(request, muscle, tmp_path):
    """A mesh, with what it was made from."""
    mesh = CellMesh(repeats=2 if "two cells" in request.param else 1)
    bare = Muscle(inner_diameter=20, wall_thickness=2, length=20, braid=None)
    tube = bare if request.param == "bare" else muscle
    path = tmp_path / "cell.mesh"
    lines = "lines" in request.param
    cell.write(tube, mesh, None if request.param == "bare" else RADIUS, path, thread_lines=lines)
    return tube, mesh, *read(path)


def test_tetrahedra_fill_the_box(made):
    tube, mesh, points, _, tetrahedra = made
    corners = points[tetrahedra]
    volumes = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6
    assert (volumes > 0).all() or (volumes < 0).all()
    assert abs(volumes.sum()) == pytest.approx(cell.volume(tube, mesh), rel=1e-10)


def test_faces_are_labelled_where_they_are(made):
    tube, mesh, points, faces, _ = made
    box = Box(tube)
    places = {
        Boundary.INNER: (0, tube.inner_radius),
        Boundary.OUTER: (0, tube.outer_radius),
        Boundary.ANGLE_LOW: (1, 0),
        Boundary.ANGLE_HIGH: (1, box.width),
        Boundary.AXIAL_LOW: (2, 0),
        Boundary.AXIAL_HIGH: (2, box.spacing * mesh.repeats),
    }
    for label, (axis, value) in places.items():
        assert len(faces[label]) > 0
        assert points[faces[label]][..., axis] == pytest.approx(value, abs=1e-9)


@pytest.mark.parametrize(
    ("axis", "low", "high"),
    [
        (1, Boundary.ANGLE_LOW, Boundary.ANGLE_HIGH),
        (2, Boundary.AXIAL_LOW, Boundary.AXIAL_HIGH),
    ],
)
def test_periodic_faces_match(made, axis, low, high):
    _, _, points, faces, _ = made

    def triangles(label):
        """Triangles of a face as rounded corners without the periodic coordinate."""
        flat = np.round(np.delete(points[faces[label]], axis, axis=-1), 8) + 0.0
        return sorted(sorted(map(tuple, corners)) for corners in flat.tolist())

    assert triangles(low) == triangles(high)


def test_threads_are_straight_diagonals(muscle):
    box = Box(muscle)
    inner, outer = muscle.layer_radii
    for share in (0, 0.25, 0.5, 0.9):
        z = share * box.spacing
        assert box.distance(inner, share * box.width, z) == pytest.approx(0, abs=1e-12)
        assert box.distance(outer, (1 - share) * box.width, z) == pytest.approx(0, abs=1e-12)
    # on the inner layer's radius, half-way between its threads and beside the outer layer's
    between = math.pi * inner / box.sectors * math.cos(muscle.braid.layer_angles[0])
    assert box.distance(inner, 0, box.spacing / 2) == pytest.approx(min(between, outer - inner))


def test_threads_are_lines_of_the_mesh_where_asked(muscle, tmp_path):
    cell.write(muscle, CellMesh(), RADIUS, tmp_path / "cell.mesh", thread_lines=True)
    points, _, tetrahedra = read(tmp_path / "cell.mesh")
    pairs = {tuple(sorted((t[i], t[j]))) for t in tetrahedra for i in range(4) for j in range(i)}
    lengths = dict.fromkeys(muscle.layer_radii, 0.0)
    for ends in (points[list(pair)] for pair in pairs):
        places = [*ends, ends.mean(axis=0)]
        if all(Box(muscle).distance(*place) < 1e-6 for place in places):
            nearest = min(lengths, key=lambda radius, at=ends: abs(radius - at[0, 0]))
            lengths[nearest] += abs(ends[0, 2] - ends[1, 2])
    assert list(lengths.values()) == pytest.approx([Box(muscle).spacing] * 2)


def test_the_mesh_is_finer_at_the_threads(muscle, tmp_path):
    cell.write(muscle, CellMesh(refinement=3), RADIUS, tmp_path / "cell.mesh")
    points, _, tetrahedra = read(tmp_path / "cell.mesh")
    corners = points[tetrahedra]
    sizes = np.abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) ** (1 / 3)
    far = np.array([Box(muscle).distance(*p) for p in corners.mean(axis=1)]) > RADIUS
    assert np.median(sizes[~far]) < 0.8 * np.median(sizes[far])


def test_equal_input_gives_equal_bytes(muscle, tmp_path):
    for name in ("a.mesh", "b.mesh"):
        cell.write(muscle, CellMesh(), RADIUS, tmp_path / name)
    assert (tmp_path / "a.mesh").read_bytes() == (tmp_path / "b.mesh").read_bytes()


@pytest.mark.parametrize(
    "setting", [{"thread_size": 0}, {"body_size": math.nan}, {"refinement": 1.5}, {"repeats": 0}]
)
def test_what_is_no_mesh_is_refused(setting):
    with pytest.raises(UnbuildableMesh, match=next(iter(setting))):
        CellMesh(**setting)


@pytest.mark.parametrize("radius", [None, 0, -1.0, math.inf])
def test_a_braid_needs_a_thread_radius(muscle, tmp_path, radius):
    with pytest.raises(UnbuildableMesh, match="thread_radius"):
        cell.write(muscle, CellMesh(), radius, tmp_path / "cell.mesh")
