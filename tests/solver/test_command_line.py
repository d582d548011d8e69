"""``python -m solver``: a record whatever happens, and one message where a case makes no sense."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from solver import record
from solver.load_path import LoadPath
from solver.status import CaseStatus

PARTS = ("start", "assembly", "factor", "residual", "rest")
ROOT = Path(__file__).parents[2]


@pytest.fixture
def command_line(tmp_path):
    """Runs the program with all outputs in the temporary folder."""

    def run(case: str, *more: str) -> subprocess.CompletedProcess[str]:
        outputs = [f"--{name}={tmp_path / name}" for name in ("record", "cost", "log")]
        return subprocess.run(
            [sys.executable, "-m", "solver", f"--case={case}", *outputs, *more],
            cwd=ROOT,
            capture_output=True,
            text=True,
            timeout=120,
        )

    return run


def test_a_curve(command_line, tmp_path, make_case, mesh_of):
    path = LoadPath(kind="isobaric", held=0.3, stops=(0.0, 0.1))
    case = make_case(model="solid", path=path, fields_at=(0.1,))
    done = command_line(case.canonical(), f"--mesh={mesh_of(case)}")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    case_read, solution = record.read(tmp_path / "record")
    assert case_read.key == case.key
    assert solution.status is CaseStatus.CONVERGED
    assert solution.states["force"] == pytest.approx([671.42, 273.93], abs=1)
    assert solution.fields.keys() == {1}
    cost = json.loads((tmp_path / "cost").read_text())
    assert cost["status"] == "converged"
    assert 0 < cost["freefem_seconds"] < cost["total_seconds"]
    assert 10 < cost["freefem_peak_memory"] < 1000
    parts = [cost[f"freefem_{name}_seconds"] for name in PARTS]
    assert min(parts) >= 0
    assert sum(parts) == pytest.approx(cost["freefem_cpu_seconds"], rel=0.3, abs=0.1)
    assert cost["freefem_unknowns"] == 884
    assert cost["freefem_iterations"] >= cost["freefem_factorisations"] > 0
    assert sorted(p.name for p in tmp_path.iterdir()) == ["cost", "log", "record"]


def test_solved_twice_the_bytes_are_the_same(command_line, tmp_path, make_case, mesh_of):
    case = make_case()
    records = []
    for _ in range(2):
        assert command_line(case.canonical(), f"--mesh={mesh_of(case)}").returncode == 0
        records.append((tmp_path / "record").read_bytes())
    assert records[0] == records[1]


@pytest.mark.parametrize("model", ["geometric", "cylinder"])
def test_models_without_a_mesh(command_line, tmp_path, make_case, model):
    done = command_line(make_case(model=model).canonical())
    assert (done.returncode, done.stderr) == (0, "")
    assert record.read(tmp_path / "record")[1].status is CaseStatus.CONVERGED
    assert "freefem_seconds" not in json.loads((tmp_path / "cost").read_text())


def test_a_failing_case_ends_with_a_record(command_line, tmp_path, make_case):
    done = command_line(make_case().canonical(), f"--mesh={tmp_path / 'absent.mesh'}")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    _, solution = record.read(tmp_path / "record")
    assert solution.status is CaseStatus.MESH_FAILED
    assert "absent.mesh" in solution.reason
    assert json.loads((tmp_path / "cost").read_text())["status"] == "mesh_failed"


def test_a_time_limit_ends_with_a_record(command_line, tmp_path, make_case, mesh_of):
    case = make_case(model="solid")
    done = command_line(case.canonical(), f"--mesh={mesh_of(case)}", "--wall-time=0.05")
    assert (done.returncode, done.stderr) == (0, "")
    _, solution = record.read(tmp_path / "record")
    assert solution.status is CaseStatus.TIMEOUT


@pytest.mark.parametrize(
    "case",
    [
        "{",
        "",
        "null",
        "[]",
        '"solid"',
        "{}",
        '{"model": "shell"}',
        '{"model": "solid"}',
        '{"model": "solid", "muscle": {"inner_diameter": -1}}',
        '{"model": ["solid"]}',
    ],
)
def test_nonsense(command_line, tmp_path, case):
    done = command_line(case)
    assert done.returncode == 2
    assert done.stdout == ""
    assert len(done.stderr.splitlines()) == 1
    assert "Traceback" not in done.stderr
    assert done.stderr.startswith("no such case can be solved: ")
    assert list(tmp_path.iterdir()) == []


def test_a_muscle_that_cannot_be_built_is_named(command_line, make_case):
    values = json.loads(make_case().canonical())
    values["muscle"]["braid"]["layer_diameters"] = [20.6, 24.5]
    done = command_line(json.dumps(values))
    assert done.returncode == 2
    assert "layer_diameters = (20.6, 24.5) is refused" in done.stderr
