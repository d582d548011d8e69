"""Tasks in processes of their own."""

import os
import signal
import time
from functools import partial

import pytest

from workflow.run.pool import Task, run


def task(name, do=lambda: 0, after=None):
    return Task(name=name, label=name, do=do, after=after)


def ends(tasks, cores=2):
    """Names of tasks as they begin, and how they end by name."""
    begun = []
    ended = {e.task.name: e.status for e in run(tasks, cores, lambda t: begun.append(t.name))}
    return begun, ended


def killed():
    os.kill(os.getpid(), signal.SIGKILL)


def broken():
    raise RuntimeError("of one task")


def test_what_one_does_stops_no_other_one(capfd):
    kinds = {"well": lambda: 0, "badly": lambda: 3, "killed": killed, "broken": broken}
    _, ended = ends([task(name, do) for name, do in kinds.items()] + [task("last")])
    assert ended == {"well": 0, "badly": 3, "killed": -9, "broken": 1, "last": 0}
    assert "of one task" in capfd.readouterr().err


@pytest.mark.parametrize("cores", [1, 2, 8])
def test_a_task_waits_for_another_and_no_core_for_it(cores, tmp_path):
    def last():
        return 0 if (tmp_path / "first").exists() else 1

    def first():
        time.sleep(0.1)
        (tmp_path / "first").touch()
        return 0

    tasks = [task("first", first), task("last", last, after="first"), task("other", after="none")]
    begun, ended = ends(tasks, cores)
    assert ended == {"first": 0, "last": 0, "other": 0}
    assert begun == (["first", "last", "other"] if cores == 1 else ["first", "other", "last"])


def test_as_many_at_a_time_as_there_are_cores(tmp_path):
    """All begin before any of the first ones ends, and no other one does."""

    def meet(name):
        (tmp_path / name).touch()
        until = time.monotonic() + 30
        while len(list(tmp_path.iterdir())) < 3 and time.monotonic() < until:
            time.sleep(0.01)
        return len(list(tmp_path.iterdir()))

    names = ["a", "b", "c"]
    _, ended = ends([task(name, partial(meet, name)) for name in names], cores=3)
    assert ended == dict.fromkeys(names, 3)
    for path in tmp_path.iterdir():
        path.unlink()

    def count(name):
        (tmp_path / name).touch()
        found = len(list(tmp_path.iterdir()))
        (tmp_path / name).unlink()
        return found

    _, ended = ends([task(f"{k}", partial(count, f"{k}")) for k in range(6)], cores=2)
    assert max(ended.values()) <= 2


def test_processes_that_nobody_waits_for_are_ended(tmp_path):
    def sleep():
        try:
            time.sleep(60)
        finally:
            (tmp_path / "tidied").touch()

    running = run([task("short", lambda: time.sleep(0.2) or 0), task("long", sleep)], 2, print)
    assert next(running).task.name == "short"
    running.close()
    assert (tmp_path / "tidied").exists()
