"""Solving a case always ends with a status, a reason where it failed, and the states reached."""

import math
from pathlib import Path

import numpy as np
import pytest

from geometry.mesh_settings import SectionMesh
from geometry.seal import seal
from solver import freefem, output, solve
from solver.effects import Effects
from solver.freefem import Limits
from solver.load_path import LoadPath
from solver.models import MODELS
from solver.numerics import Newton, Numerics
from solver.program import waypoint_text
from solver.record import VARIABLES
from solver.status import CaseStatus, StateStatus

LIMITS = Limits(wall_time=60, memory=4000)
PATHS = {
    "isobaric": LoadPath(kind="isobaric", held=0.3, stops=(-0.02, 0.0, 0.1), zero_force=True),
    "isometric": LoadPath(kind="isometric", held=0.1, stops=(0.2, 0.3), zero_force=True),
    "isotonic": LoadPath(kind="isotonic", held=200.0, stops=(0.1, 0.3)),
}


@pytest.mark.parametrize("kind", PATHS)
@pytest.mark.parametrize("model", ["geometric", "cylinder", "membrane", "solid"])
def test_states_are_where_the_path_asks_for_them(solve_case, make_case, model, kind):
    path = PATHS[kind]
    solution = solve_case(make_case(model=model, path=path))
    assert solution.status is CaseStatus.CONVERGED, solution.reason
    assert solution.reason == ""
    assert solution.state_status == [StateStatus.CONVERGED] * path.states
    states = solution.states
    assert all(values.shape == (path.states,) for values in states.values())
    swept = "contraction" if kind == "isobaric" else "pressure"
    held = {"isobaric": "pressure", "isometric": "contraction", "isotonic": "force"}[kind]
    np.testing.assert_allclose(states[swept][: len(path.stops)], path.stops, atol=1e-9)
    np.testing.assert_allclose(states[held], path.held, rtol=1e-6, atol=1e-9)
    if path.zero_force:
        assert states["force"][-1] == pytest.approx(0, abs=1e-5)


@pytest.mark.parametrize("model", ["membrane", "solid"])
def test_fields_are_those_of_the_stops_asked_for(solve_case, make_case, model):
    path = LoadPath(kind="isobaric", held=0.3, stops=(0.0, 0.05, 0.1))
    plain = solve_case(make_case(model=model, path=path))
    assert plain.fields == {}
    solution = solve_case(make_case(model=model, path=path, fields_at=(0.0, 0.1)))
    assert solution.fields.keys() == {0, 2}
    np.testing.assert_array_equal(solution.states["force"], plain.states["force"])
    shape = "meridian" if model == "membrane" else "corners"
    for number, contraction in ((0, 0.0), (2, 0.1)):
        R, Z, r, z = solution.fields[number][shape].T
        assert R.min() == 10
        middle = (np.abs(Z) < 1e-9) & (R == 10)
        inner = solution.states["inner_diameter_inflated"][number] / 2
        np.testing.assert_allclose(r[middle], inner, rtol=1e-12)
        np.testing.assert_allclose(z[np.abs(Z) < 1e-9], 0, atol=1e-9)
        cap = np.abs(Z - 150) < 1e-9  # a clamped wall gives way there by some tenths of a mm
        np.testing.assert_allclose(z[cap], 150 * (1 - contraction), atol=0.5)
    if model == "solid":
        assert solution.fields[0]["stress"].shape == solution.fields[0]["corners"].shape
        assert R.max() == 12


def test_a_narrowing_tube_has_a_smaller_outer_diameter(solve_case, make_case, bare_tube):
    """The largest outer diameter anywhere, also if that is less than it was."""
    path = LoadPath(kind="isobaric", held=0.0, stops=(-0.2,))
    case = make_case(model="solid", muscle=bare_tube, effects=Effects(end="sliding"), path=path)
    outer = solve_case(case).states["outer_diameter"][0]
    assert outer == pytest.approx(24 / math.sqrt(1.2), rel=1e-3)  # incompressible, stretch 1.2


@pytest.mark.parametrize("model", ["cylinder", "membrane", "solid"])
def test_a_bare_tube_has_no_thread_stretch(solve_case, make_case, bare_tube, model):
    path = LoadPath(kind="isobaric", held=0.02, stops=(0.0,))
    states = solve_case(make_case(model=model, muscle=bare_tube, path=path)).states
    assert np.isfinite(states["force"]).all()
    assert np.isnan(states["thread_stretch_min"]).all()
    assert np.isnan(states["thread_stretch_max"]).all()


def test_equivalent_diameter(solve_case, make_case):
    path = LoadPath(kind="isometric", held=0.1, stops=(0.0, 0.12, 0.3))
    states = solve_case(make_case(model="cylinder", path=path)).states
    none, pushing, pulling = states["equivalent_diameter"]
    assert math.isnan(none)
    assert pulling**2 * math.pi / 4 * 0.3 == pytest.approx(states["force"][2])
    assert pushing < 0
    assert -(pushing**2) * math.pi / 4 * 0.12 == pytest.approx(states["force"][1])


# --- failures -------------------------------------------------------------------------------------


def assert_partial(solution, reached: int) -> None:
    """The first states are there, the others are marked."""
    count = len(solution.state_status)
    assert np.isfinite(solution.states["force"][:reached]).all()
    assert np.isnan(solution.states["force"][reached:]).all()
    assert StateStatus.NOT_REACHED not in solution.state_status[:reached]
    assert solution.state_status[reached:] == [StateStatus.NOT_REACHED] * (count - reached)
    assert solution.reason
    assert "\n" not in solution.reason


@pytest.mark.parametrize("model", ["cylinder", "solid"])
@pytest.mark.parametrize(
    "path",
    [
        LoadPath(kind="isotonic", held=0.0, stops=(0.02, 0.05, 0.3, 0.4)),
        # begins with its highest pressure, which here does not exist
        LoadPath(kind="isometric", held=0.0, stops=(0.05, 0.1, 0.3)),
    ],
    ids=["isotonic", "isometric"],
)
def test_what_lies_below_the_largest_pressure_is_kept(
    solve_case, make_case, bare_tube, model, path
):
    """A bare tube has no state above 0.156 MPa at stretch 1, above 0.134 MPa without a load."""
    case = make_case(
        model=model,
        muscle=bare_tube,
        effects=Effects(end="sliding"),
        numerics=Numerics(section=SectionMesh(cap_step=5, growth=1, body_step=1)),
        path=path,
    )
    solution = solve_case(case)
    assert solution.status in (CaseStatus.LIMIT_POINT, CaseStatus.STALLED)
    assert_partial(solution, reached=2)
    assert np.all(solution.states["contraction"][:2] < 1)
    assert np.all(solution.states["inner_diameter_inflated"][:2] > 20)


def test_without_a_mesh(make_case, tmp_path):
    for mesh in (None, tmp_path / "absent.msh"):
        solution, usage = solve.solve(make_case(), mesh, tmp_path / "log", LIMITS)
        assert solution.status is CaseStatus.MESH_FAILED
        assert_partial(solution, reached=0)
        assert usage is None


def test_a_file_that_is_no_mesh(make_case, tmp_path):
    mesh = tmp_path / "bad.mesh"
    mesh.write_text("nonsense End\n")
    seal(mesh)
    solution, _ = solve.solve(make_case(), mesh, tmp_path / "log", LIMITS)
    assert solution.status in (CaseStatus.SOLVER_ERROR, CaseStatus.MESH_FAILED)
    assert_partial(solution, reached=0)
    assert solution.log


def test_without_freefem(make_case, mesh_of, tmp_path, monkeypatch):
    case = make_case()
    mesh = mesh_of(case)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(freefem.Outside, match=r"\./setup\.sh"):
        solve.solve(case, mesh, tmp_path / "log", LIMITS)


def test_time_limit_keeps_what_was_reached(make_case, mesh_of, tmp_path, monkeypatch):
    """The walk is held up after its second state; both are in the record."""
    slow = tmp_path / "membrane.edp"
    text = MODELS["membrane"].program.read_text()
    walk, writing = ((freefem.PATH / name).read_text() for name in ("output.idp", "states.idp"))
    assert "states.flush;" in writing
    (tmp_path / "slow_states.idp").write_text(
        writing.replace("states.flush;", 'states.flush; if (number == 5) exec("exec sleep 60");')
    )
    (tmp_path / "slow_output.idp").write_text(walk.replace('"states.idp"', '"slow_states.idp"'))
    slow.write_text(text.replace('"output.idp"', '"slow_output.idp"'))
    monkeypatch.setenv("FF_INCLUDEPATH", str(tmp_path))
    monkeypatch.setattr(
        freefem,
        "command",
        lambda program, flags, make=freefem.command: make(slow, flags),
    )
    path = LoadPath(kind="isobaric", held=0.3, stops=(0.0, 0.05, 0.1, 0.15))
    case = make_case(path=path)
    limits = Limits(wall_time=2, memory=4000)
    solution, _ = solve.solve(case, mesh_of(case), tmp_path / "log", limits)
    assert solution.status is CaseStatus.TIMEOUT
    assert "2 s" in solution.reason
    assert_partial(solution, reached=2)


def test_memory_limit(make_case, mesh_of, tmp_path):
    case = make_case(model="solid")
    solution, _ = solve.solve(
        case, mesh_of(case), tmp_path / "log", Limits(wall_time=60, memory=60)
    )
    assert solution.status is CaseStatus.SOLVER_ERROR
    assert_partial(solution, reached=0)


def test_steps_that_may_not_be_small_enough(make_case, solve_case):
    """One Newton iteration a step is too few: the walk gives up, with a reason."""
    impatient = Numerics(newton=Newton(iterations=1, smallest_step=0.5))
    solution = solve_case(make_case(numerics=impatient))
    assert solution.status is CaseStatus.STALLED
    assert_partial(solution, reached=0)


@pytest.mark.parametrize("torn", ["0.1,0.3,27", "0.1,0.3,", "0.1,", "", "0.1,0.3,273.5"])
def test_a_torn_last_line_is_no_state(tmp_path, torn):
    table = tmp_path / "states.csv"
    table.write_text(f"contraction,pressure,force\n0,0.3,671.4\n{torn}")
    assert output.rows(table) == [{"contraction": 0, "pressure": 0.3, "force": 671.4}]


def test_no_table_is_no_state(tmp_path):
    assert output.rows(tmp_path / "states.csv") == []


def test_waypoints_keep_every_digit(make_case):
    third = 1 / 3
    path = LoadPath(kind="isobaric", held=0.1, stops=(0.05, third))
    case = make_case(path=path, fields_at=(third,))
    number, _, *lines = waypoint_text(case, path.ways()[0]).splitlines()
    assert int(number.split()[0]) == len(lines)
    *_, last, final = (line.split() for line in lines)
    assert [float(v) for v in last] == [1, 0.1, 0, 0.05, 1]
    assert [float(v) for v in final] == [1, 0.1, 0, third, 2]


def test_failure_has_every_variable(make_case):
    failed = solve.failure(make_case(), CaseStatus.MESH_FAILED, "why")
    assert failed.states.keys() == VARIABLES.keys()
    assert failed.reason == "why"


def test_the_log_is_not_left_in_the_scratch_folder(make_case, mesh_of, tmp_path):
    """Nothing but the log stays behind, and a relative mesh is found."""
    case = make_case()
    mesh = mesh_of(case)
    log = tmp_path / "logs.txt"
    relative = Path(*[".."] * len(Path.cwd().parts[1:]), *mesh.parts[1:])
    solution, usage = solve.solve(case, relative, log, LIMITS)
    assert solution.status is CaseStatus.CONVERGED
    assert usage is not None
    assert list(tmp_path.iterdir()) == [log]
