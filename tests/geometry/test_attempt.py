"""Why a muscle has no mesh stands where that would be; what comes from outside leaves nothing."""

import faulthandler
import json
import mmap
import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from geometry import attempt
from geometry.attempt import Failed, why_not
from geometry.refusal import Refusal
from geometry.seal import is_sealed, why_none

ROOT = Path(__file__).parents[2]


def refuse():
    raise Refusal("muscle", 3, "a muscle")


def call(function, *arguments):
    return lambda: function(*arguments)


def fail(error):
    raise error


OWN = {  # what happens in the process that makes a mesh: what the reason says
    "refused": (refuse, "muscle = 3 is refused"),
    "gmsh": (call(fail, Exception("no elements in curve 3")), "no elements in curve 3"),
    "memory": (call(fail, MemoryError()), "not within 4000 MB, the limit"),
    "allocation": (call(bytearray, 2**33), "not within 4000 MB, the limit"),
    "crash": (lambda: os.kill(os.getpid(), signal.SIGSEGV), "SIGSEGV"),
    "abort": (os.abort, "SIGABRT"),
    "exit": (call(os._exit, 7), "status 7"),
    "time": (call(time.sleep, 60), "stopped after 0.5 s, the limit"),
}
FOREIGN = {
    "killed": (lambda: os.kill(os.getpid(), signal.SIGKILL), "SIGKILL"),
    "told to end": (lambda: os.kill(os.getpid(), signal.SIGTERM), "SIGTERM"),
    "full disk": (call(fail, OSError(28, "No space left on device")), "No space left"),
    "input/output": (call(fail, OSError(5, "Input/output error")), "Input/output"),
    "missing library": (call(fail, ImportError("no gmsh")), "no gmsh"),
    "interrupted": (call(fail, KeyboardInterrupt()), "KeyboardInterrupt"),
}


@pytest.fixture(autouse=True)
def quiet():
    """Crashes that are wanted print no stack."""
    faulthandler.disable()
    yield
    faulthandler.enable()


@pytest.mark.parametrize("kind", OWN)
def test_what_the_mesher_does_itself_is_a_reason(kind):
    make, said = OWN[kind]
    assert said in why_not(make, 0.5, 4000)


@pytest.mark.parametrize("kind", FOREIGN)
def test_what_comes_from_outside_is_none(kind):
    make, said = FOREIGN[kind]
    with pytest.raises(Failed, match=said):
        why_not(make, 60, 4000)


def test_what_the_process_around_it_has_is_not_counted():
    with mmap.mmap(-1, 2**32):
        assert why_not(call(bytearray, 2**24), 60, 1000) == ""
        assert "not within 1000 MB" in why_not(call(bytearray, 2**30), 60, 1000)


def test_one_that_was_killed_is_tried_once_more(tmp_path):
    flag = tmp_path / "was killed"

    def make():
        if not flag.exists():
            flag.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        (tmp_path / "made").touch()

    assert why_not(make, 60, 4000) == ""
    assert (tmp_path / "made").exists()


def test_limits_are_those_of_the_process():
    before = resource.getrlimit(resource.RLIMIT_AS), signal.getitimer(signal.ITIMER_REAL)
    assert attempt.why_not(lambda: None, 60, 4000) == ""
    after = resource.getrlimit(resource.RLIMIT_AS), signal.getitimer(signal.ITIMER_REAL)
    assert after == before


@pytest.fixture
def program(muscle, tmp_path):
    """The program with a section of the muscle; its end and the file it writes."""

    def run(mesh=None, seconds=60, **options):
        spec = {"kind": "section", "muscle": muscle.as_dict(), "mesh": mesh or {}, "end": "butt"}
        output = tmp_path / "a.msh"
        done = subprocess.run(
            [sys.executable, "-m", "geometry", "-", output, "--or-why", str(seconds), "4000"],
            input=json.dumps(spec),
            capture_output=True,
            text=True,
            cwd=ROOT,
            check=False,
            **options,
        )
        assert "Traceback" not in done.stderr
        return done.returncode, done.stderr, output

    return run


def test_a_mesh_or_why_there_is_none(program):
    status, said, output = program()
    assert (status, said, is_sealed(output), why_none(output)) == (0, "", True, "")
    status, said, output = program({"growth": 0.5})
    assert status == 0
    assert "growth = 0.5 is refused" in said
    assert "growth = 0.5 is refused" in why_none(output)
    assert not is_sealed(output)


@pytest.mark.parametrize("size", [0, 100, 2000])
def test_a_full_disk_leaves_nothing(program, size):
    limit = (resource.RLIMIT_FSIZE, (size, size))
    status, said, output = program(preexec_fn=lambda: resource.setrlimit(*limit))
    assert status == 1
    assert "not built, to be tried again" in said
    assert list(output.parent.iterdir()) == []
