"""The inner line of the half muscle: exact nodes, labels that FreeFEM sees, the same bytes."""

import numpy as np
import pytest

from geometry import meridian
from geometry.labels import Boundary
from geometry.mesh_settings import MeridianMesh
from geometry.muscle import Muscle
from solver import freefem

READ = """
load "msh3"
meshL Th = readmeshL("meridian.mesh");
cout.precision(17);
for (int v = 0; v < Th.nv; ++v) cout << Th(v).x << " " << Th(v).y << " " << Th(v).z << endl;
fespace Vh(Th, P1);
varf ends(u, v) = on(LOW, u = 1) + on(HIGH, u = 2);
real[int] at = ends(0, Vh, tgv = 1);
for (int v = 0; v < at.n; ++v) if (at[v] != 0) cout << "end " << v << " " << at[v] << endl;
cout << "length " << int1d(Th, LINE)(1.) << " " << 0 << endl;
"""


def read(path):
    """Vertices and segments of a Medit file, with their labels."""
    words = path.read_text().split()
    found = {}
    for name, columns in (("Vertices", 4), ("Edges", 3)):
        start = words.index(name) + 2
        numbers = words[start : start + int(words[start - 1]) * columns]
        found[name] = np.array(numbers, dtype=float).reshape(-1, columns)
    return found["Vertices"], found["Edges"].astype(int)


def tube(diameter, length):
    return Muscle(inner_diameter=diameter, wall_thickness=2, length=length, braid=None)


@pytest.mark.parametrize("refinement", [1, 2, 3])
@pytest.mark.parametrize(("diameter", "length"), [(20, 300), (20, 60), (10, 1000), (40, 300.1)])
class TestNodes:
    @pytest.fixture
    def made(self, diameter, length, refinement, tmp_path):
        mesh = MeridianMesh(refinement=refinement)
        path = tmp_path / "meridian.mesh"
        meridian.write(tube(diameter, length), mesh, path)
        return mesh, path

    def test_nodes_are_where_the_grading_puts_them(self, made, diameter, length):
        mesh, path = made
        vertices, _ = read(path)
        heights = mesh.half_length_stations(tube(diameter, length))
        assert np.sort(vertices[:, 1]) == pytest.approx(heights, rel=1e-13)
        assert (vertices[:, 0] == diameter / 2).all()
        assert (vertices[:, 2] == 0).all()

    def test_ends_are_exact_and_labelled(self, made, length):
        vertices, _ = read(made[1])
        at = {label: vertices[vertices[:, 3] == label, 1].tolist() for label in Boundary}
        assert at[Boundary.MIDPLANE] == [0]
        assert at[Boundary.END] == [length / 2]
        assert not any(at[b] for b in Boundary if b not in (Boundary.MIDPLANE, Boundary.END))

    def test_segments_make_one_line(self, made, diameter, length):
        vertices, edges = read(made[1])
        z = vertices[edges[:, :2] - 1, 1]
        assert (edges[:, 2] == Boundary.INNER).all()
        assert (z[:, 1] > z[:, 0]).all()
        total = (z[:, 1] - z[:, 0]).sum()
        assert total == pytest.approx(meridian.length(tube(diameter, length)), rel=1e-12)
        assert len(edges) == len(vertices) - 1


def test_number_of_segments_by_default(muscle, tmp_path):
    path = tmp_path / "meridian.mesh"
    meridian.write(muscle, MeridianMesh(), path)
    assert len(read(path)[1]) == 15


def test_refined_nodes_are_nested(muscle, tmp_path):
    nodes = []
    for refinement in (1, 2):
        path = tmp_path / f"{refinement}.mesh"
        meridian.write(muscle, MeridianMesh(refinement=refinement), path)
        nodes.append({round(z, 9) for z in read(path)[0][:, 1]})
    assert nodes[0] < nodes[1]


def test_same_input_same_bytes(muscle, tmp_path):
    first, second = tmp_path / "first.mesh", tmp_path / "second.mesh"
    for path in (first, second):
        meridian.write(muscle, MeridianMesh(), path)
    assert first.read_bytes() == second.read_bytes()
    assert sorted(tmp_path.iterdir()) == [first, second]  # nothing left beside them


def test_freefem_reads_it(tmp_path):
    """Coordinates arrive in double precision, and the ends are two points with their labels."""
    muscle, mesh = tube(20, 300.1), MeridianMesh()
    meridian.write(muscle, mesh, tmp_path / "meridian.mesh")
    labels = {"LOW": Boundary.MIDPLANE, "HIGH": Boundary.END, "LINE": Boundary.INNER}
    text = READ
    for word, label in labels.items():
        text = text.replace(word, str(label.value))
    (tmp_path / "read.edp").write_text(text)
    limits = freefem.Limits(wall_time=30, memory=2000)
    freefem.run(tmp_path / "read.edp", {}, tmp_path, tmp_path / "log", limits)
    rows = [line.split() for line in (tmp_path / "log").read_text().splitlines() if line.strip()]
    points = np.array([row for row in rows if row[0][0].isdigit()], dtype=float)
    heights = mesh.half_length_stations(muscle)
    assert np.sort(points[:, 1]) == pytest.approx(heights, rel=1e-13)
    assert (points[:, 0] == 10).all()
    ends = {float(row[2]): points[int(row[1]), 1] for row in rows if row[0] == "end"}
    assert ends == {1: 0, 2: 150.05}
    assert [float(row[1]) for row in rows if row[0] == "length"] == pytest.approx([150.05])
