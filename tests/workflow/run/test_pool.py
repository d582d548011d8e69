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


def test_no_more_at_a_time_than_cores(tmp_path):
    def count(name):
        (tmp_path / name).touch()
        time.sleep(0.05)
        found = len(list(tmp_path.iterdir()))
        (tmp_path / name).unlink()
        return found

    _, ended = ends([task(f"{k}", partial(count, f"{k}")) for k in range(8)], cores=3)
    assert max(ended.values()) <= 3
    assert max(ended.values()) > 1


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
