"""Fields as VTU: what meshio reads back, whole or absent, the same bytes every time."""

from pathlib import Path
from types import SimpleNamespace

import meshio
import numpy as np
import pytest

from solver import record
from solver.case import Case
from solver.load_path import LoadPath
from solver.record import unreached
from workflow.data import paraview
from workflow.plan.plan import Place, plan
from workflow.study.errors import StudyError
from workflow.study.study import load

from ..synthetic import converged

CONFIG = Path(__file__).parents[3] / "config" / "config.yaml"
CORNERS = np.array([[10, 0, 15, 0], [12, 0, 16.5, 0], [10, 5, 15, 4]], dtype=float)
STRESS = np.array([[-0.3, 0.1, 0.2, 1.0], [0, 0, 0.5, 0.8], [-0.3, 0, -0.4, -0.6]])


@pytest.fixture
def recorded(tmp_path, make_case):
    path = LoadPath(kind="isobaric", held=0.3, stops=(0.0, 0.1))
    case: Case = make_case(model="solid", path=path, fields_at=(0.1,))
    solution = converged(unreached(2), fields={1: {"corners": CORNERS, "stress": STRESS}})
    file = tmp_path / "case.h5"
    record.write(file, case, solution)
    return file


def test_the_wall_comes_back(recorded, tmp_path):
    paraview.write(recorded, 1, tmp_path / "a.vtu")
    mesh = meshio.read(tmp_path / "a.vtu")
    assert mesh.cells_dict["triangle"].tolist() == [[0, 1, 2]]
    assert mesh.points[:, :2] == pytest.approx(CORNERS[:, :2])
    warped = mesh.points + mesh.point_data["displacement"]
    assert warped[:, :2] == pytest.approx(CORNERS[:, 2:])
    assert mesh.point_data["stress_tt"] == pytest.approx(STRESS[:, 3])
    in_plane = np.linalg.eigvalsh([[-0.3, 0.1], [0.1, 0.2]])
    assert mesh.point_data["largest_principal_stress"][0] == pytest.approx(1.0)
    assert mesh.point_data["smallest_principal_stress"][0] == pytest.approx(in_plane.min())


def test_same_bytes_twice(recorded, tmp_path):
    for name in ("a.vtu", "b.vtu"):
        paraview.write(recorded, 1, tmp_path / name)
    assert (tmp_path / "a.vtu").read_bytes() == (tmp_path / "b.vtu").read_bytes()


def test_a_state_without_fields_is_an_empty_file(recorded, tmp_path):
    paraview.write(recorded, 0, tmp_path / "a.vtu")
    assert (tmp_path / "a.vtu").read_bytes() == b""


def test_a_damaged_record_is_named(recorded, tmp_path):
    recorded.write_bytes(recorded.read_bytes()[:100])
    with pytest.raises(StudyError, match=r"case\.h5"):
        paraview.write(recorded, 1, tmp_path / "a.vtu")
    assert not (tmp_path / "a.vtu").exists()


def test_only_scenes_that_ask_for_stress_have_files():
    files = paraview.files(plan(load(CONFIG)))
    assert sorted(files) == [f"dmsp20_solid_fine_isobaric_{p}_0.1.vtu" for p in (0.2, 0.3, 0.4)]


def test_a_stop_that_a_path_comes_to_twice_has_two_files():
    path = SimpleNamespace(stops=(0.0, 0.1, 0.2, 0.1))
    case = SimpleNamespace(path=path, fields_at=(0.1, 0.2))
    place = Place("isobaric", "one", "solid", "default", 0.3)
    asked = SimpleNamespace(
        scenes={"loop": {place: "key"}}, cases={"key": SimpleNamespace(case=case)}
    )
    found = {name: state for name, (_, state) in paraview.files(asked).items()}
    start = "one_solid_default_isobaric_0.3"
    assert found == {f"{start}_0.1_1.vtu": 1, f"{start}_0.2.vtu": 2, f"{start}_0.1_3.vtu": 3}


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
    assert mesh.points[2] == pytest.approx([10 * np.cos(0.1), 10 * np.sin(0.1), 0])
    moved = mesh.points + mesh.point_data["displacement"]
    assert moved[3] == pytest.approx([15, 0, 0.9 * 2.4])
    assert mesh.point_data["largest_principal_stress"] == pytest.approx(1.0)
