"""One run at a time; a file system that has no locks is no reason not to run."""

import errno
import fcntl
import os
import subprocess
import sys
from pathlib import Path

import pytest

from workflow.run import lock

ROOT = Path(__file__).parents[3]
HOLD = """\
import sys
from pathlib import Path
from workflow.run import lock
lock.take(Path(sys.argv[1]))
print("held", flush=True)
sys.stdin.read()
"""


@pytest.fixture(autouse=True)
def let_go(monkeypatch):
    """What a test has locked."""
    monkeypatch.setattr(lock, "_held", [])
    monkeypatch.setenv(lock.MARK, "")
    yield
    for file in lock._held:
        file.close()


def test_a_second_run_names_the_first(tmp_path):
    path = tmp_path / "run.lock"
    with subprocess.Popen(
        [sys.executable, "-c", HOLD, str(path)],
        cwd=ROOT,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as first:
        assert first.stdout.readline() == "held\n"
        with pytest.raises(SystemExit, match=f"process {first.pid}"):
            lock.take(path)
        first.stdin.close()
        first.wait()
    lock.take(path)
    assert path.read_text() == f"{os.getpid()}\n"


@pytest.mark.parametrize("number", [errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP])
def test_a_file_system_without_locks_is_said_in_one_line(tmp_path, monkeypatch, capsys, number):
    def refuse(*_):
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(fcntl, "flock", refuse)
    lock.take(tmp_path / "run.lock")
    said = capsys.readouterr().err
    assert len(said.splitlines()) == 1
    assert "has no locks" in said
    with (tmp_path / "other").open("w") as file:
        lock.wait(file.fileno())


def test_without_locks_a_living_run_is_named_nonetheless(tmp_path, monkeypatch):
    def refuse(*_):
        raise OSError(errno.ENOLCK, "No locks available")

    monkeypatch.setattr(fcntl, "flock", refuse)
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "run.lock"
    with subprocess.Popen(["sleep", "60"], cwd=tmp_path) as first:
        path.write_text(f"{first.pid}\n")
        with pytest.raises(SystemExit, match=f"process {first.pid}"):
            lock.take(path)
        first.kill()
    lock.take(path)


def test_another_error_is_one(tmp_path, monkeypatch):
    def refuse(*_):
        raise OSError(errno.EIO, "Input/output error")

    monkeypatch.setattr(fcntl, "flock", refuse)
    with pytest.raises(OSError, match="Input/output"):
        lock.take(tmp_path / "run.lock")
