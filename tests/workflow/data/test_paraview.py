"""Fields as VTU and PVD: what meshio reads back, whole or absent, the same bytes every time."""

from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import meshio
import numpy as np
import pytest

from solver import record
from solver.case import Case
from solver.effects import Effects
from solver.load_path import LoadPath
from solver.record import unreached
from solver.status import StateStatus
from workflow.data import deformed, paraview
from workflow.data.paraview import View
from workflow.plan.plan import plan
from workflow.study.errors import StudyError
from workflow.study.study import load

from ..synthetic import MUSCLE, converged, planned

CONFIG = Path(__file__).parents[3] / "config" / "config.yaml"
CORNERS = np.array([[10, 0, 15, 0], [12, 0, 16.5, 0], [10, 5, 15, 4]], dtype=float)
STRESS = np.array([[-0.3, 0.1, 0.2, 1.0], [0, 0, 0.5, 0.8], [-0.3, 0, -0.4, -0.6]])


@pytest.fixture
def recorded(tmp_path, make_case):
    path = LoadPath(kind="isobaric", held=0.3, stops=(0.0, 0.1))
    case: Case = make_case(model="solid", path=path, fields_at=(0.1,))
    states = unreached(2) | {"force": np.array([500.0, 250.0])}
    solution = converged(states, fields={1: {"corners": CORNERS, "stress": STRESS}})
    file = tmp_path / "case.h5"
    record.write(file, case, solution)
    return file


def test_the_wall_comes_back(recorded, tmp_path):
    paraview.write(recorded, 1, tmp_path / "a.vtu")
    mesh = meshio.read(tmp_path / "a.vtu")
    assert mesh.cells_dict["triangle"].tolist() == [[0, 1, 2]]
    assert mesh.points[:, :2] == pytest.approx(CORNERS[:, 2:])
    unloaded = mesh.points - mesh.point_data["displacement [mm]"]
    assert unloaded[:, :2] == pytest.approx(CORNERS[:, :2])
    assert mesh.point_data["stress_tt [MPa]"] == pytest.approx(STRESS[:, 3])
    in_plane = np.linalg.eigvalsh([[-0.3, 0.1], [0.1, 0.2]])
    assert mesh.point_data["largest_principal_stress [MPa]"][0] == pytest.approx(1.0)
    found = mesh.point_data["smallest_principal_stress [MPa]"][0]
    assert found == pytest.approx(in_plane.min())
    assert mesh.field_data["force [N]"].tolist() == [250.0]
    assert mesh.field_data["TimeValue"].tolist() == [0.1]
    assert "energy [N*mm]" not in mesh.field_data  # not known of this state


def test_points_where_they_were_unloaded(recorded, tmp_path):
    paraview.write(recorded, 1, tmp_path / "a.vtu", View(unloaded=True))
    mesh = meshio.read(tmp_path / "a.vtu")
    assert mesh.points[:, :2] == pytest.approx(CORNERS[:, :2])
    moved = mesh.points + mesh.point_data["displacement [mm]"]
    assert moved[:, :2] == pytest.approx(CORNERS[:, 2:])


def test_a_section_is_turned_about_the_axis(recorded, tmp_path):
    paraview.write(recorded, 1, tmp_path / "a.vtu", View(sectors=6))
    mesh = meshio.read(tmp_path / "a.vtu")
    wedges = mesh.cells_dict["wedge"]
    assert len(wedges) == 6
    assert np.hypot(*mesh.points[:, :2].T) == pytest.approx(np.tile(CORNERS[:, 2], 6))
    assert mesh.points[:, 2] == pytest.approx(np.tile(CORNERS[:, 3], 6))
    angles = np.arctan2(mesh.points[wedges, 1], mesh.points[wedges, 0])
    turned = (angles[:, 3:] - angles[:, :3]) % (2 * np.pi)
    assert turned == pytest.approx(np.full((6, 3), np.pi / 3), abs=1e-6)
    assert mesh.point_data["stress_tt [MPa]"] == pytest.approx(np.tile(STRESS[:, 3], 6))


def test_same_bytes_twice(recorded, tmp_path):
    for name in ("a.vtu", "b.vtu"):
        paraview.write(recorded, 1, tmp_path / name)
    assert (tmp_path / "a.vtu").read_bytes() == (tmp_path / "b.vtu").read_bytes()


def test_a_state_without_fields_is_said(recorded, tmp_path):
    with pytest.raises(StudyError, match="no fields of state 0; there are of 1"):
        paraview.write(recorded, 0, tmp_path / "a.vtu")
    assert not (tmp_path / "a.vtu").exists()


def test_a_series_has_all_states_with_fields_at_their_contractions(tmp_path, make_case):
    path = LoadPath(kind="isobaric", held=0.3, stops=(0.0, 0.05, 0.1))
    fields = {k: {"corners": CORNERS + k, "stress": STRESS} for k in (0, 1)}
    solution = converged(
        unreached(3),
        fields=fields,
        state_status=[StateStatus.CONVERGED] * 2 + [StateStatus.NOT_REACHED],
    )
    record.write(tmp_path / "c.h5", make_case(model="solid", path=path), solution)
    series = tmp_path / "my <wall>.pvd"
    assert paraview.write_series(tmp_path / "c.h5", series) == 2
    found = list(ElementTree.parse(series).iter("DataSet"))
    assert [float(each.get("timestep")) for each in found] == [0.0, 0.05]
    meshes = [meshio.read(series.parent / each.get("file")) for each in found]
    for k, mesh in enumerate(meshes):
        assert mesh.points[:, 0] == pytest.approx(CORNERS[:, 2] + k)
    assert paraview.parts_of(series) == [tmp_path / "my <wall>" / f"000{k}.vtu" for k in (0, 1)]
    assert "time is contraction [1]" in series.read_text()


def test_time_is_what_is_swept(tmp_path, make_case):
    path = LoadPath(kind="isometric", held=0.1, stops=(0.2, 0.3))
    case = make_case(path=path, fields_at=(0.3,))
    fields = {1: {"meridian": CORNERS}}
    record.write(tmp_path / "c.h5", case, converged(unreached(2), fields=fields))
    paraview.write_series(tmp_path / "c.h5", tmp_path / "c.pvd")
    text = (tmp_path / "c.pvd").read_text()
    assert 'timestep="0.3"' in text
    assert "time is pressure [MPa]" in text
    assert meshio.read(tmp_path / "c" / "0001.vtu").cells_dict["line"].tolist() == [[0, 1], [1, 2]]


def test_a_damaged_record_is_named(recorded, tmp_path):
    recorded.write_bytes(recorded.read_bytes()[:100])
    with pytest.raises(StudyError, match=r"case\.h5"):
        paraview.write(recorded, 1, tmp_path / "a.vtu")
    assert not (tmp_path / "a.vtu").exists()


def test_only_scenes_that_ask_for_stress_have_files():
    files = paraview.files(plan(load(CONFIG)))
    fine = [f"dmsp20_solid_fine_isobaric_{p}.pvd" for p in (0.2, 0.3, 0.4)]
    assert sorted(files) == ["dmsp20_solid_default_isobaric_0.3.pvd", *fine]


IN_TIME = (
    MUSCLE
    + """\
scenes:
  loops:
    path: cycle
    muscles: [one]
    cycle: {held: pressure, period: 4, cycles: 1, samples: 4}
    pressure: [0.3]
    contraction: [0, 0.2]
    models: [membrane]
    quantities: [deformed_shape]
"""
)


def test_a_series_in_time_has_every_state_at_its_time(tmp_path):
    found = planned(tmp_path, IN_TIME)
    assert list(paraview.files(found)) == ["loops_one_membrane_default_cycle_0.3_4s.pvd"]
    (each,) = found.cases.values()
    assert each.case.fields_at == (0.0, 0.1, 0.2)
    states = unreached(5, record.variables(each.case)) | {"time": np.arange(5.0)}
    fields = {k: {"meridian": CORNERS} for k in range(5)}
    record.write(tmp_path / "c.h5", each.case, converged(states, fields=fields))
    assert paraview.write_series(tmp_path / "c.h5", tmp_path / "c.pvd") == 5
    sets = ElementTree.parse(tmp_path / "c.pvd").iter("DataSet")
    assert [float(one.get("timestep")) for one in sets] == [0, 1, 2, 3, 4]
    assert "time is that of the path [s]" in (tmp_path / "c.pvd").read_text()


def test_a_cylinder_has_no_shape_in_time_either(tmp_path):
    with pytest.raises(StudyError, match=r"only by membrane.*; not cylinder"):
        planned(tmp_path, IN_TIME.replace("[membrane]", "[cylinder]"))


def test_a_cell_comes_back_as_a_piece_of_the_tube(tmp_path, make_case):
    path = LoadPath(kind="isobaric", held=0.3, stops=(0.1,))
    before = np.array([[10, 0, 0], [12, 0, 0], [10, 0.1, 0], [10, 0, 2.4]], dtype=float)
    fields = {
        "corners": np.hstack([before, before * [1.5, 1, 0.9]]),
        "stress": np.tile([-0.3, 1.0, 0.2, 0, 0, 0], (4, 1)),
        "threads": np.ones((4, 4)),
    }
    solution = converged(unreached(1), fields={0: fields})
    record.write(tmp_path / "c.h5", make_case(model="cell", path=path, fields_at=(0.1,)), solution)
    paraview.write(tmp_path / "c.h5", 0, tmp_path / "c.vtu")
    mesh = meshio.read(tmp_path / "c.vtu")
    assert mesh.cells_dict["tetra"].tolist() == [[0, 1, 2, 3]]
    assert mesh.points[3] == pytest.approx([15, 0, 0.9 * 2.4])
    unloaded = mesh.points - mesh.point_data["displacement [mm]"]
    assert unloaded[2] == pytest.approx([10 * np.cos(0.1), 10 * np.sin(0.1), 0])
    assert mesh.point_data["largest_principal_stress [MPa]"] == pytest.approx(1.0)
    with pytest.raises(StudyError, match="no section that could be turned"):
        paraview.write(tmp_path / "c.h5", 0, tmp_path / "d.vtu", View(sectors=8))
    with pytest.raises(StudyError, match="not those of a whole muscle"):
        paraview.write(tmp_path / "c.h5", 0, tmp_path / "d.vtu", View(whole=True))


POLYGON = np.sin(2 * np.pi / deformed.SECTORS) * deformed.SECTORS / (2 * np.pi)  # to its circle


def parts_of(mesh, kind):
    """Cells of a kind, and the part that each is of."""
    number = [block.type for block in mesh.cells].index(kind)
    return mesh.cells[number].data, mesh.cell_data[deformed.PART][number]


def flux(mesh, part):
    """A third of the integral of x . n over a part of the surface: what it adds to a volume."""
    quads, parts = parts_of(mesh, "quad")
    corners = mesh.points.astype(float)[quads[parts == part]]
    triangles = [corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]]
    return sum(np.linalg.det(t).sum() / 6 for t in triangles) / POLYGON


@pytest.mark.parametrize(
    ("model", "of_rubber"),
    [("membrane", 5e-3), ("solid", 1e-3)],  # a membrane's lines are coarser at the cap
)
def test_the_whole_muscle_encloses_its_volume_and_its_threads_are_as_long_as_they_are_stretched(
    model, of_rubber, tmp_path, make_case, solve_case
):
    path = LoadPath(kind="isobaric", held=0.3, stops=(0.0, 0.1, 0.15))
    case = make_case(model=model, path=path, fields_at=(0.0, 0.1), effects=Effects(end="butt"))
    solution = solve_case(case)
    record.write(tmp_path / "c.h5", case, solution)
    paraview.write(tmp_path / "c.h5", 1, tmp_path / "whole.vtu", View(whole=True))
    mesh = meshio.read(tmp_path / "whole.vtu")
    muscle, states = case.muscle, {k: v[1] for k, v in solution.states.items()}
    # the bore is closed by two discs at the caps
    z, r = muscle.length / 2 * 0.9, muscle.inner_radius
    enclosed = 2 * np.pi * r**2 * z / 3 - flux(mesh, deformed.BORE)
    assert enclosed == pytest.approx(states["volume"], rel=5e-4)
    outside, bore, ends = (flux(mesh, part) for part in range(3))
    wall = np.pi * (muscle.outer_radius**2 - muscle.inner_radius**2) * muscle.length
    assert outside + bore + ends == pytest.approx(wall, rel=of_rubber)
    lines, family = parts_of(mesh, "line")
    chords = np.linalg.norm(np.diff(mesh.points[lines].astype(float), axis=1), axis=2)[:, 0]
    stretch, force = (mesh.point_data[k] for k in ("thread_stretch [1]", "thread_force [N]"))
    for number, wound in enumerate(muscle.layers):
        own = family == deformed.FIRST_LAYER + number
        free = wound.threads * muscle.length * np.hypot(1, wound.tangent)
        mean = stretch[lines[own]].mean()
        assert chords[own].sum() / free == pytest.approx(mean, rel=1e-3)
        assert mean == pytest.approx(states["thread_stretch_max"], rel=5e-3)
    assert np.nanmax(stretch) == pytest.approx(states["thread_stretch_max"], rel=2e-3)
    middle = np.isfinite(stretch) & (np.abs(mesh.points[:, 2]) < 30)  # threads are taut there
    assert force[middle] == pytest.approx(315 * (stretch[middle] - 1), abs=0.05)
    assert force[middle].min() > 4
    assert np.hypot(*mesh.points[:, :2].T).max() * 2 == pytest.approx(
        states["outer_diameter"], rel=1e-3
    )


def test_threads_of_both_senses_wind_against_each_other(tmp_path, make_case, muscle):
    case = make_case(path=LoadPath(kind="isobaric", held=0.3, stops=(0.1,)), fields_at=(0.1,))
    Z = np.linspace(0, 150, 31)
    rows = np.column_stack([np.full(31, 10.0), Z, np.full(31, 12.0), 0.9 * Z])
    inner, outer = (p for p in deformed.pieces(case, {"meridian": rows}) if p.kind == "line")
    for piece, sense in ((inner, 1), (outer, -1)):
        first = piece.after[: len(piece.after) // 60]
        turned = np.unwrap(np.arctan2(first[:, 1], first[:, 0]))
        assert turned[-1] - turned[0] == pytest.approx(sense * 2 * np.pi * 300 / 144)
        assert len(piece.cells) == 60 * (len(first) - 1)
    # a cylinder of 12 mm of bore and 0.9 of its length carries r^2 = 144 + (10.3^2 - 100)/0.9
    r = np.sqrt(144 + (10.3**2 - 100) / 0.9)
    tangent = 2 * np.pi * 10.3 / 144
    expected = np.sqrt((0.81 + (2 * np.pi * r / 144) ** 2) / (1 + tangent**2))
    assert inner.values["thread_stretch [1]"] == pytest.approx(np.full(len(inner.after), expected))


def test_a_bare_tube_has_no_threads_and_endless_ones_are_refused(make_case, muscle):
    rows = np.column_stack([np.full(5, 10.0), np.linspace(0, 150, 5)] * 2)
    bare = make_case(muscle=replace(muscle, braid=None))
    kinds = [piece.kind for piece in deformed.pieces(bare, {"meridian": rows})]
    assert kinds == ["quad"] * 3
    endless = replace(muscle, braid=replace(muscle.braid, lead=0.5))
    with pytest.raises(StudyError, match="points; at most"):
        deformed.pieces(make_case(muscle=endless), {"meridian": rows})
