"""Whatever FreeFEM does, and whatever is done to it: a record with a status, or none at all."""

import os
import resource
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from solver import freefem, record, solve
from solver.freefem import Interrupted, Limits
from solver.load_path import LoadPath
from solver.status import CaseStatus, StateStatus

ROOT = Path(__file__).parents[2]
LIMITS = Limits(wall_time=30, memory=2000)
HEADER = "waypoint,contraction,pressure,force\n"


@pytest.fixture
def case(make_case):
    return make_case(path=LoadPath(kind="isobaric", held=0.3, stops=(0.05, 0.1)))


@pytest.fixture
def solved_by(case, mesh_of, tmp_path, monkeypatch):
    """Solves the case with a shell script for FreeFEM."""

    def run(script, limits=LIMITS):
        mesh = mesh_of(case)
        program = tmp_path / "bin/FreeFem++"
        program.parent.mkdir()
        program.write_text(f"#!/bin/sh\n{script}\n")
        program.chmod(0o755)
        monkeypatch.setenv("PATH", f"{program.parent}:{os.environ['PATH']}")
        return solve.solve(case, mesh, tmp_path / "log", limits)[0]

    return run


RUBBISH = {
    # what FreeFEM does: what the reason says
    "true": "ended early and did not say why",
    "echo Segmentation fault; exit 0": "ended early",
    "head -c 100000 /dev/urandom": "ended early",
    "head -c 5000 /dev/urandom > states.csv": "",
    f"printf '{HEADER}1,0.05,0.3,many\\n' > states.csv": "cannot be read",
    f"printf '{HEADER}1,0.05,0.3\\n' > states.csv": "cannot be read",
    f"printf '{HEADER}1,0.05,0.3,1,2,3\\n' > states.csv": "cannot be read",
    f"printf '{HEADER}99,0.05,0.3,1\\n' > states.csv": "cannot be read",
    f"printf '{HEADER}nan,0.05,0.3,1\\n' > states.csv": "cannot be read",
    f"printf '{HEADER}1,0.05,0.3,nan\\n' > states.csv": "cannot be read",
    ": > reason.txt": "ended early",
    "exit 1": "status 1: the program does not compile",
    "exit 77": "status 77: see its log",
    "kill -SEGV $$": "SIGSEGV",
    "kill -ABRT $$": "SIGABRT",
    "kill -KILL $$": "SIGKILL",  # twice: it is run once more
}


@pytest.mark.parametrize("script", RUBBISH)
def test_rubbish_is_a_solver_error(solved_by, script, case, tmp_path):
    solution = solved_by(script)
    assert solution.status is CaseStatus.SOLVER_ERROR
    assert RUBBISH[script] in solution.reason
    assert solution.state_status == [StateStatus.NOT_REACHED] * 2
    record.write(tmp_path / "case.h5", case, solution)  # whatever it said
    assert record.read(tmp_path / "case.h5")[1].reason == solution.reason


def test_one_that_hangs_is_stopped(solved_by):
    solution = solved_by("sleep 60", Limits(wall_time=0.3, memory=2000))
    assert (solution.status, "0.3 s" in solution.reason) == (CaseStatus.TIMEOUT, True)


def test_one_that_was_killed_from_outside_is_run_again(solved_by, solve_case, case, tmp_path):
    real = freefem.executable()
    flag = tmp_path / "was killed"
    solution = solved_by(f"[ -e '{flag}' ] || {{ : > '{flag}'; kill -9 $$; }}\nexec {real} \"$@\"")
    assert flag.exists()
    assert solution.status is CaseStatus.CONVERGED
    np.testing.assert_array_equal(solution.states["force"], solve_case(case).states["force"])


def test_a_damaged_mesh_is_not_used(case, mesh_of, tmp_path):
    mesh = tmp_path / "a.mesh"
    shutil.copy(mesh_of(case), mesh)
    mesh.write_text(mesh.read_text().replace("75", "76", 1))
    solution, _ = solve.solve(case, mesh, tmp_path / "log", LIMITS)
    assert (solution.status, solution.reason) == (CaseStatus.MESH_FAILED, f"{mesh} is damaged")


def program(case, mesh, folder):
    names = {name: str(folder / name) for name in ("record", "cost", "log")}
    options = [text for name, path in names.items() for text in (f"--{name}", path)]
    return [sys.executable, "-m", "solver", "--case", case.canonical(), "--mesh", mesh, *options]


@pytest.mark.parametrize("size", [0, 100, 5000, 20000])
def test_a_full_disk_leaves_nothing_and_says_so(case, mesh_of, tmp_path, size):
    """Nothing that a full disk has cut off is a result."""
    done = subprocess.run(
        program(case, mesh_of(case), tmp_path),
        cwd=ROOT,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size)),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1
    assert "cannot be written" in done.stderr
    assert "Traceback" not in done.stderr
    assert {path.name for path in tmp_path.iterdir()} <= {"log"}


def test_freefem_ends_with_the_program_that_runs_it(case, mesh_of, tmp_path):
    """Also if that is killed."""
    pid = tmp_path / "pid"
    (tmp_path / "FreeFem++").write_text(f"#!/bin/sh\necho $$ > '{pid}'\nexec sleep 60\n")
    (tmp_path / "FreeFem++").chmod(0o755)
    running = subprocess.Popen(
        program(case, mesh_of(case), tmp_path),
        cwd=ROOT,
        env=os.environ | {"PATH": f"{tmp_path}:{os.environ['PATH']}"},
    )
    while not pid.exists() or not pid.read_text().endswith("\n"):
        time.sleep(0.01)
    running.send_signal(signal.SIGKILL)
    running.wait()
    stat = Path(f"/proc/{int(pid.read_text())}/stat")
    for _ in range(200):
        if not stat.exists() or stat.read_text().rpartition(")")[2].split()[0] == "Z":
            return
        time.sleep(0.01)
    raise AssertionError("FreeFEM goes on")


def test_a_signal_from_outside_is_told_apart(tmp_path, monkeypatch):
    monkeypatch.setattr(freefem, "command", lambda *_: ["sh", "-c", "kill -TERM $$"])
    with pytest.raises(Interrupted, match="SIGTERM"):
        freefem.run("any.edp", {}, tmp_path, tmp_path / "log", LIMITS)


def test_a_full_disk_is_no_record(case, tmp_path, monkeypatch):
    """Not even one beside its place."""
    path = tmp_path / "case.h5"
    monkeypatch.setattr(os, "replace", lambda *_: (_ for _ in ()).throw(OSError(28, "full")))
    with pytest.raises(OSError, match="full"):
        record.write(path, case, solve.failure(case, CaseStatus.STALLED, "why"))
    assert list(tmp_path.iterdir()) == []
