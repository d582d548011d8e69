"""Whatever FreeFEM does is a status in a record; whatever is done to it from outside is none."""

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

from geometry.seal import write_why_none
from solver import freefem, record, solve
from solver.follow import DamagedMesh
from solver.freefem import Interrupted, Limits, Outside
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
    f"printf '{HEADER}0,0,0.3,1\\n' > states.csv; head -c 200000000 /dev/zero": "cannot be read",
    "head -c 200000000 /dev/zero | tr '\\0' 1 > states.csv": "200000000 bytes",
    "head -c 200000000 /dev/zero | tr '\\0' 1 > reason.txt": "200000000 bytes",
    "yes": "wrote a file of more than 256 MB",
    "mkfifo states.csv": "states.csv is no ordinary file",
    "mkfifo reason.txt; sleep 0.1 > reason.txt &": "",
    "mkfifo unknowns.txt": "unknowns.txt is no ordinary file",
    "mkfifo cost.csv": "cost.csv is no ordinary file",
    "mkdir states.csv": "states.csv is no ordinary file",
    "ln -s /dev/zero states.csv": "states.csv is no ordinary file",
    "ln -s nowhere states.csv": "states.csv is no ordinary file",
    'rm -rf "$PWD"': "ended early",
    "echo many > unknowns.txt": "cannot be read",
    f"echo 1{'0' * 40} > unknowns.txt": "cannot be read",
    "echo -1 > unknowns.txt": "cannot be read",
    "echo name,value,more > cost.csv; echo a,b,c >> cost.csv": "cannot be read",
    "printf 'name,value\\nunknowns,inf\\n' > cost.csv": "cannot be read",
    "head -c 5000 /dev/urandom > cost.csv": "cannot be read",
    f"printf '{HEADER}inf,0.05,0.3,1\\n' > states.csv": "cannot be read",
    f"printf '{HEADER}-1,0.05,0.3,1\\n' > states.csv": "cannot be read",
    f"printf '{HEADER}0.5,0.05,0.3,1\\n' > states.csv": "cannot be read",
    f"printf '{HEADER}{{stop}},0.05,0.3,inf\\n' > states.csv": "force is inf",
    f"printf '{HEADER}{{stop}},0.05,0.3,1e999\\n' > states.csv": "force is inf",
    f"printf '{HEADER}{{stop}},0.05,0.3,nan\\n' > states.csv": "whose force is nan",
    f"printf '{HEADER}{{stop}},0.05,0.3,1\\n{{stop}},0.05,0.3,2\\n' > states.csv": "two states",
    f"printf 'waypoint,{'x' * 200_000}\\n' > states.csv": "cannot be read",
    "exit 1": "status 1: the program does not compile",
    "exit 77": "status 77: see its log",
    "kill -SEGV $$": "SIGSEGV",
    "kill -ABRT $$": "SIGABRT",
}
FROM_OUTSIDE = {
    "kill -KILL $$": "SIGKILL",  # twice: it is run once more
    "kill -TERM $$": "SIGTERM",
    "kill -USR1 $$": "SIGUSR1",
    "kill -XCPU $$": "SIGXCPU",
    "sh -c 'kill -KILL $$'; exit $?": "SIGKILL",
    "exec /nowhere/FreeFem++": "cannot be run",
    "echo Load error: gmsh; exit 2": "a plugin is missing",
}


@pytest.mark.parametrize("script", RUBBISH)
def test_rubbish_is_a_solver_error(solved_by, script, case, tmp_path):
    way = case.path.ways()[0]
    stop = next(number for number, point in enumerate(way) if point.stop is not None)
    memory, start = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, time.monotonic()
    solution = solved_by(script.replace("{stop}", str(stop)))
    assert time.monotonic() - start < 20
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - memory < 100 * 1024  # KB
    assert (tmp_path / "log").stat().st_size < 2 * freefem.LARGEST_LOG
    assert solution.status is CaseStatus.SOLVER_ERROR
    assert RUBBISH[script] in solution.reason
    assert solution.state_status == [StateStatus.NOT_REACHED] * 2
    record.write(tmp_path / "case.h5", case, solution)  # whatever it said
    assert record.read(tmp_path / "case.h5")[1].reason == solution.reason


@pytest.mark.parametrize("script", FROM_OUTSIDE)
def test_what_comes_from_outside_is_no_status(solved_by, script):
    with pytest.raises(Outside, match=FROM_OUTSIDE[script]):
        solved_by(script)


@pytest.mark.parametrize("leaves", ["", "setsid", "env -i setsid nohup"])
def test_children_do_not_survive(solved_by, tmp_path, leaves):
    pid = tmp_path / "pid"
    child = f'echo $$ > "{pid}.new"; mv "{pid}.new" "{pid}"; exec sleep 600'
    solved_by(f"{leaves} sh -c '{child}' & while [ ! -e '{pid}' ]; do sleep 0.01; done")
    assert not Path("/proc", pid.read_text().strip()).exists()


def test_one_that_is_nobodys_child_of_ours_lives_on(solved_by):
    other = subprocess.Popen(["sleep", "600"])
    try:
        solved_by("true")
        assert other.poll() is None
    finally:
        other.kill()
        other.wait()


def test_the_time_limit_is_that_of_all_ways(make_case, mesh_of, tmp_path, monkeypatch):
    """Each way alone keeps it, all together do not."""
    path = LoadPath(kind="isobaric", held=0.3, stops=(0.05, 0.1))
    case = make_case(path=path)
    way = path.ways()[0]
    monkeypatch.setattr(LoadPath, "ways", lambda self: [way] * 10)
    program = tmp_path / "FreeFem++"
    program.write_text("#!/bin/sh\nsleep 0.4\necho why > reason.txt\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:{os.environ['PATH']}")
    limits = Limits(wall_time=1, memory=2000)
    start = time.monotonic()
    solution, _ = solve.solve(case, mesh_of(case), tmp_path / "log", limits)
    assert time.monotonic() - start < 3
    assert (solution.status, "1 s" in solution.reason) == (CaseStatus.TIMEOUT, True)


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
    with pytest.raises(DamagedMesh, match="is damaged"):
        solve.solve(case, mesh, tmp_path / "log", LIMITS)
    done = run_program(case, mesh, tmp_path)
    assert (done.returncode, "tried again" in done.stderr) == (1, True)
    assert not mesh.exists()  # so that it is made again
    assert not (tmp_path / "record").exists()


def test_why_there_is_no_mesh_is_the_reason(case, tmp_path):
    mesh = tmp_path / "a.mesh"
    write_why_none(mesh, "the wall\nis too thin")
    solution, _ = solve.solve(case, mesh, tmp_path / "log", LIMITS)
    assert solution.status is CaseStatus.MESH_FAILED
    assert solution.reason == "the wall is too thin"


def program(case, mesh, folder):
    names = {name: str(folder / name) for name in ("record", "cost", "log")}
    options = [text for name, path in names.items() for text in (f"--{name}", path)]
    return [sys.executable, "-m", "solver", "--case", case.canonical(), "--mesh", mesh, *options]


def run_program(case, mesh, folder, **options):
    return subprocess.run(
        program(case, mesh, folder),
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
        **options,
    )


@pytest.mark.parametrize("size", [0, 100, 5000, 20000])
def test_a_full_disk_leaves_nothing_and_says_so(case, mesh_of, tmp_path, size):
    """Nothing that a full disk has cut off is a result."""
    limit = (resource.RLIMIT_FSIZE, (size, size))
    mesh = mesh_of(case)
    done = run_program(case, mesh, tmp_path, preexec_fn=lambda: resource.setrlimit(*limit))
    assert done.returncode == 1
    assert "not solved, to be tried again" in done.stderr
    assert "Traceback" not in done.stderr
    assert {path.name for path in tmp_path.iterdir()} <= {"log"}


@pytest.mark.parametrize("script", FROM_OUTSIDE)
def test_what_comes_from_outside_is_no_record(case, mesh_of, tmp_path, script):
    (tmp_path / "FreeFem++").write_text(f"#!/bin/sh\n{script}\n")
    (tmp_path / "FreeFem++").chmod(0o755)
    path = {"PATH": f"{tmp_path}:{os.environ['PATH']}"}
    done = run_program(case, mesh_of(case), tmp_path, env=os.environ | path)
    assert done.returncode == 1
    assert "not solved, to be tried again: FreeFEM" in done.stderr
    assert "Traceback" not in done.stderr
    assert {path.name for path in tmp_path.iterdir()} == {"FreeFem++", "log"}


def test_less_memory_than_the_limit_is_no_record(case, mesh_of, tmp_path):
    limit = (resource.RLIMIT_AS, (2**31, 2**31))
    mesh = mesh_of(case)
    done = run_program(case, mesh, tmp_path, preexec_fn=lambda: resource.setrlimit(*limit))
    assert (done.returncode, "ulimit -v" in done.stderr) == (1, True)


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
        freefem.run(Path("any.edp"), {}, tmp_path, tmp_path / "log", LIMITS)


def test_a_full_disk_is_no_record(case, tmp_path, monkeypatch):
    """Not even one beside its place."""
    path = tmp_path / "case.h5"
    monkeypatch.setattr(os, "replace", lambda *_: (_ for _ in ()).throw(OSError(28, "full")))
    with pytest.raises(OSError, match="full"):
        record.write(path, case, solve.failure(case, CaseStatus.STALLED, "why"))
    assert list(tmp_path.iterdir()) == []
