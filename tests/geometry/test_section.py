"""The wall's half section: exact area, labels, layers as mesh lines, the same bytes again."""

import math

import meshio
import numpy as np
import pytest

from geometry import section
from geometry.grading import UnbuildableMesh
from geometry.labels import Boundary, Region
from geometry.mesh_settings import SectionMesh
from geometry.muscle import Braid, Muscle
from geometry.section import ENDS
from solver import freefem


def reinforced(diameter, length):
    braid = Braid.from_angle(
        angle=24.8, threads=60, layer_diameters=(diameter + 0.6, diameter + 1.8)
    )
    return Muscle(inner_diameter=diameter, wall_thickness=2, length=length, braid=braid)


MUSCLES = {
    "paper": reinforced(20, 300),
    "short": reinforced(20, 60),
    "long": reinforced(20, 1000),
    "slim": reinforced(10, 300),
    "stout": reinforced(40, 60),
    "bare": Muscle(inner_diameter=20, wall_thickness=2, length=300, braid=None),
}


class Mesh:
    """A section as it was read from its file."""

    def __init__(self, path):
        mesh = meshio.read(path)
        self.points = mesh.points
        self.triangles = mesh.cells_dict["triangle"]
        labels = mesh.cell_data_dict["gmsh:physical"]
        self.lines = {b: mesh.cells_dict["line"][labels["line"] == b] for b in Boundary}
        self.regions = set(labels["triangle"])
        self.names = {name: tuple(entry) for name, entry in mesh.field_data.items()}

    @property
    def areas(self):
        a, b, c = (self.points[self.triangles[:, corner], :2] for corner in range(3))
        (ux, uy), (vx, vy) = (b - a).T, (c - a).T
        return (ux * vy - uy * vx) / 2


def lines_of(mesh, muscle, end):
    """Where each boundary is: the coordinate that is constant, its value, its length."""
    top = muscle.length / 2 + (muscle.cap_length if end == "clamp" else 0)
    wall = muscle.wall_thickness
    found = {
        Boundary.MIDPLANE: (1, 0, wall),
        Boundary.END: (1, top, wall),
        Boundary.INNER: (0, muscle.inner_radius, top),
        Boundary.OUTER: (0, muscle.outer_radius, top),
    }
    layers = (Boundary.LAYER_1, Boundary.LAYER_2)
    return found | {b: (0, r, top) for b, r in zip(layers, muscle.layer_radii, strict=False)}


@pytest.fixture(params=MUSCLES, scope="module")
def muscle(request):
    return MUSCLES[request.param]


@pytest.fixture(params=ENDS, scope="module")
def end(request):
    return request.param


@pytest.fixture(scope="module")
def mesh(muscle, end, tmp_path_factory):
    path = tmp_path_factory.mktemp("section") / "section.msh"
    section.write(muscle, SectionMesh(rows=(1, 2, 3)), end, path)
    return Mesh(path)


def test_triangles_fill_the_section(mesh, muscle, end):
    assert (mesh.areas > 0).all()  # FreeFEM wants them counter-clockwise
    assert mesh.areas.sum() == pytest.approx(section.area(muscle, end), rel=1e-12)
    assert (mesh.points[:, 2] == 0).all()


def test_area_is_that_of_the_wall(muscle, end):
    clamp = 8 if end == "clamp" else 0
    assert section.area(muscle, end) == pytest.approx(2 * (muscle.length / 2 + clamp))


def test_boundaries_are_labelled_where_they_are(mesh, muscle, end):
    expected = lines_of(mesh, muscle, end)
    assert {b for b in Boundary if len(mesh.lines[b])} == set(expected)
    for boundary, (axis, value, length) in expected.items():
        ends = mesh.points[mesh.lines[boundary]]
        assert ends[..., axis] == pytest.approx(value, rel=1e-12, abs=1e-12)
        steps = np.abs(ends[:, 1, 1 - axis] - ends[:, 0, 1 - axis])
        assert steps.sum() == pytest.approx(length, rel=1e-12)


def test_labels_have_their_names(mesh, muscle, end):
    expected = {b.name: (b.value, 1) for b in lines_of(mesh, muscle, end)}
    assert mesh.names == expected | {"WALL": (Region.WALL.value, 2)}
    assert mesh.regions == {Region.WALL}


def test_rows_cross_the_wall_at_the_layers_and_at_the_cap(mesh, muscle, end):
    """Every row has nodes at both surfaces and both layers; one row is at Z = L/2."""
    heights = section.stations(muscle, SectionMesh(), end)
    assert muscle.length / 2 in heights
    nodes = {(round(r, 9), round(z, 9)) for r, z, _ in mesh.points}
    for radius in (muscle.inner_radius, *muscle.layer_radii, muscle.outer_radius):
        assert {(round(radius, 9), round(z, 9)) for z in heights} <= nodes
    assert len({z for _, z in nodes}) == len(heights)
    assert len(nodes) == 7 * len(heights)  # rows of 1, 2 and 3 elements; a bare tube has their sum


def test_no_triangle_crosses_the_cap(mesh, muscle):
    """Fields of the clamp have a kink at Z = L/2, so it is a line of the mesh."""
    z = mesh.points[mesh.triangles, 1] - muscle.length / 2
    assert not ((z.max(axis=1) > 1e-9) & (z.min(axis=1) < -1e-9)).any()


def test_diagonals_alternate(tmp_path):
    """Without a preferred direction: as many diagonals rise as fall."""
    path = tmp_path / "section.msh"
    mesh = SectionMesh(growth=1, body_step=0.25)  # 6 equal steps
    section.write(MUSCLES["short"], mesh, "butt", path)
    found = Mesh(path)
    edges = np.concatenate([found.triangles[:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))])
    slopes = found.points[edges[:, 1], :2] - found.points[edges[:, 0], :2]
    diagonal = (np.abs(slopes) > 1e-9).all(axis=1)
    rising = slopes[diagonal].prod(axis=1) > 0
    assert rising.sum() == diagonal.sum() / 2


def rising(mesh, low, high):
    """Whether diagonals between two heights rise with R; all of them must."""
    edges = np.concatenate([mesh.triangles[:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))])
    ends = mesh.points[edges, :2]
    slopes = ends[:, 1] - ends[:, 0]
    middle = ends[..., 1].mean(axis=1)
    chosen = (np.abs(slopes) > 1e-9).all(axis=1) & (middle > low) & (middle < high)
    (found,) = set(slopes[chosen].prod(axis=1) > 0)
    return found


@pytest.mark.parametrize("end", ENDS)
@pytest.mark.parametrize("length", [300, 340])
def test_diagonals_beside_the_cap_are_the_same_in_every_muscle(end, length, tmp_path):
    """A body with one more interval does not turn them: the error at the cap depends on them."""
    muscle, path = reinforced(20, length), tmp_path / "section.msh"
    section.write(muscle, SectionMesh(), end, path)
    free = section.stations(muscle, SectionMesh(), "butt")
    assert rising(Mesh(path), free[-2], free[-1])
    assert not rising(Mesh(path), free[-3], free[-2])


def test_the_clamp_is_cut_by_the_ramp_it_is_given(tmp_path):
    path = tmp_path / "section.msh"
    section.write(MUSCLES["paper"], SectionMesh(), "clamp", path, ramp=1.5)
    heights = section.stations(MUSCLES["paper"], SectionMesh(), "clamp", 1.5)
    assert {151, 152, 153} <= set(heights)
    found = {round(z, 9) for z in Mesh(path).points[:, 1]}
    assert found == {round(z, 9) for z in heights}


@pytest.mark.parametrize(("end", "triangles"), [("clamp", 90), ("butt", 54), ("sliding", 54)])
def test_number_of_triangles_by_default(end, triangles, tmp_path):
    """A mesh of this size gives the force within 0.02 % of the curve's largest."""
    path = tmp_path / "section.msh"
    section.write(MUSCLES["paper"], SectionMesh(), end, path)
    assert len(Mesh(path).triangles) == triangles


@pytest.mark.parametrize("refinement", [2, 3])
def test_refinement_cuts_rows_too(refinement, tmp_path):
    path = tmp_path / "section.msh"
    section.write(MUSCLES["paper"], SectionMesh(refinement=refinement), "clamp", path)
    assert len(Mesh(path).triangles) == 90 * refinement**2


def test_refined_nodes_are_nested(tmp_path):
    nodes = []
    for refinement in (1, 2):
        path = tmp_path / f"{refinement}.msh"
        section.write(MUSCLES["paper"], SectionMesh(refinement=refinement), "clamp", path)
        nodes.append({(round(r, 9), round(z, 9)) for r, z, _ in Mesh(path).points})
    assert nodes[0] < nodes[1]


def test_same_input_same_bytes(tmp_path):
    first, second = tmp_path / "first.msh", tmp_path / "second.msh"
    for path in (first, second):
        section.write(MUSCLES["paper"], SectionMesh(), "clamp", path)
    assert first.read_bytes() == second.read_bytes()
    assert sorted(tmp_path.iterdir()) == [first, second]  # nothing left beside them


def test_freefem_reads_it(mesh, muscle, end, tmp_path):
    """Area and labels arrive: the length of every boundary, the inner lines counted once."""
    path = tmp_path / "section.msh"
    section.write(muscle, SectionMesh(), end, path)
    (tmp_path / "read.edp").write_text(
        'load "gmsh"\nmesh Th = gmshload("section.msh");\n'
        f"cout.precision(16);\ncout << int2d(Th, {Region.WALL.value})(1.) << endl;\n"
        "for (int label = 1; label <= 6; ++label) cout << int1d(Th, label)(1.) << endl;\n"
    )
    log = tmp_path / "log"
    limits = freefem.Limits(wall_time=30, memory=2000)
    freefem.run(tmp_path / "read.edp", {}, tmp_path, log, limits)
    area, *lengths = (float(line) for line in log.read_text().split())
    assert area == pytest.approx(section.area(muscle, end), rel=1e-12)
    expected = lines_of(mesh, muscle, end)
    for boundary, length in zip(Boundary, lengths, strict=False):
        assert length == pytest.approx(expected.get(boundary, (0, 0, 0))[2], rel=1e-12)


@pytest.mark.parametrize("rows", [(1, 1), (1, 1, 0), (1, 1, 1.5), 3, (1, 1, True), [1, 1, 1]])
def test_rows_must_be_three_counts(rows):
    with pytest.raises(UnbuildableMesh) as refusal:
        SectionMesh(rows=rows)
    assert str(refusal.value) == f"rows = {rows!r} is refused; allowed: three integers >= 1"


def test_an_unknown_end_is_refused_and_nothing_written(tmp_path):
    with pytest.raises(UnbuildableMesh, match="end = 'glued' is refused; allowed: one of clamp"):
        section.write(MUSCLES["paper"], SectionMesh(), "glued", tmp_path / "section.msh")
    assert list(tmp_path.iterdir()) == []


def test_thin_layers_are_meshed(tmp_path):
    """Layers as near to the surfaces as numbers allow that a file tells apart."""
    braid = Braid(lead=144, threads=60, layer_diameters=(20.00001, 23.99999))
    muscle = Muscle(inner_diameter=20, wall_thickness=2, length=300, braid=braid)
    section.write(muscle, SectionMesh(), "butt", tmp_path / "section.msh")
    areas = Mesh(tmp_path / "section.msh").areas
    assert math.isclose(areas.sum(), 300, rel_tol=1e-12)
    assert (areas > 0).all()
