"""What several tests share: the muscle of the paper and its materials, and solves kept by case.

Tests run in several processes (pytest-xdist), file by file. What takes long is made by one of them
and found by the others in a folder that they share. Without FreeFEM a test that needs it ends with
an error that says so; it is not skipped.
"""

import csv
import fcntl
import json
import pickle
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import pytest

from geometry.make import make
from geometry.muscle import Braid, Muscle
from solver import freefem, in_time
from solver.case import Case, digest
from solver.load_path import LoadPath, Waypoint
from solver.material import Thread
from solver.models import MODELS
from solver.program import composition, flags, includes, waypoint_text
from solver.record import Solution
from solver.rubber.mooney_rivlin.law import MooneyRivlin
from solver.solve import solve

LONGEST = ("test_cell.py", "test_faults.py", "test_rules.py", "test_slurm.py")  # begun first
LIMITS = freefem.Limits(wall_time=300, memory=4000)  # a busy machine takes its time
Rows = list[dict[str, float]]


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """The longest files first."""
    items.sort(key=lambda item: item.path.name not in LONGEST)


@contextmanager
def alone(path: Path) -> Iterator[None]:
    """Keeps the other processes from making the same."""
    with path.with_name(f"{path.name}.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


@pytest.fixture(scope="session")
def shared(tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest) -> Path:
    """A folder of all processes of these tests."""
    own = tmp_path_factory.getbasetemp()
    folder = (own.parent if hasattr(request.config, "workerinput") else own) / "shared"
    folder.mkdir(exist_ok=True)
    return folder


@pytest.fixture(scope="session")
def muscle() -> Muscle:
    """DMSP-20-300 of the paper, spacing 2.4 mm."""
    return Muscle(
        inner_diameter=20,
        wall_thickness=2,
        length=300,
        braid=Braid(lead=144, threads=60, layer_diameters=(20.6, 21.8)),
    )


@pytest.fixture(scope="session")
def bare_tube() -> Muscle:
    """The tube of the muscle without braid; short, for where nothing changes along it."""
    return Muscle(inner_diameter=20, wall_thickness=2, length=20, braid=None)


@pytest.fixture(scope="session")
def nbr() -> MooneyRivlin:
    return MooneyRivlin(c10=0.345083, c01=0.083805)


@pytest.fixture(scope="session")
def silicone() -> MooneyRivlin:
    return MooneyRivlin(c10=0.028, c01=0.018)


@pytest.fixture(scope="session")
def thread() -> Thread:
    return Thread(stiffness=315)


@pytest.fixture(scope="session")
def make_case(muscle: Muscle, nbr: MooneyRivlin, thread: Thread) -> Callable[..., Case]:
    """A case of the normal muscle at 0.3 MPa and 10 %; keywords are fields of Case to change."""

    def make(**changes) -> Case:
        values = {
            "muscle": muscle,
            "rubber": nbr,
            "thread": thread,
            "path": LoadPath(kind="isobaric", held=0.3, stops=(0.1,)),
            "model": "membrane",
        } | changes
        if values["muscle"].braid is None:
            values["thread"] = None
        return Case(**values)

    return make


@pytest.fixture(scope="session")
def mesh_of(shared: Path) -> Callable[[Case], Path | None]:
    """The mesh of a case; None for a model without one. Made once for all cases that share it."""

    def mesh(case: Case) -> Path | None:
        spec = case.mesh_spec()
        if spec is None:
            return None
        path = shared / f"{digest(spec)}.{MODELS[case.model].suffix}"
        with alone(path):
            if not path.exists():
                make(json.loads(spec), path)
        return path

    return mesh


@pytest.fixture(scope="session")
def solve_case(mesh_of: Callable[[Case], Path | None], shared: Path) -> Callable[[Case], Solution]:
    """Solves a case as ``python -m solver`` does; one that was solved before is remembered."""
    known: dict[str, Solution] = {}

    def solution(case: Case) -> Solution:
        if case.key not in known:
            path = shared / f"{case.key}.pickle"
            with alone(path):
                if not path.exists():
                    if case.mesh_spec() is not None:
                        freefem.executable()  # raises: FreeFEM is not there
                    solved, _ = solve(case, mesh_of(case), path.with_suffix(".log"), LIMITS)
                    path.write_bytes(pickle.dumps(solved))
            known[case.key] = pickle.loads(path.read_bytes())
        return known[case.key]

    return solution


@pytest.fixture(scope="session")
def run_program(
    mesh_of: Callable[[Case], Path | None], tmp_path_factory: pytest.TempPathFactory
) -> Callable[..., Path]:
    """Runs a FreeFEM program with flags, effects and way of a case; gives its folder."""

    def run(
        case: Case, program: Path | None = None, way: Sequence[Waypoint] = (), **more: float
    ) -> Path:
        work = tmp_path_factory.mktemp(case.key)
        (work / "composition.idp").write_text(composition(case))
        (work / "waypoints.txt").write_text(waypoint_text(case, list(way)))
        if case.path.history is not None:
            in_time.write(case, work)
        model = MODELS[case.model]
        program = program or model.program
        mesh = mesh_of(case)
        assert mesh is not None
        try:
            given = flags(case, mesh) | more
            freefem.run(program, given, work, work / "log", LIMITS, includes(case))
        except freefem.FreeFemError as error:
            raise AssertionError(f"{error}\n{freefem.tail(work / 'log')}") from error
        return work

    return run


@pytest.fixture(scope="session")
def walk(run_program: Callable[..., Path]) -> Callable[..., Rows]:
    """Walks a FreeFEM model along any waypoints; gives the rows of states.csv."""

    def rows(case: Case, way: Sequence[Waypoint]) -> Rows:
        with (run_program(case, way=way) / "states.csv").open() as file:
            return [{k: float(v) for k, v in row.items()} for row in csv.DictReader(file)]

    return rows
