"""Tasks in processes of their own, so many at a time, some after others."""

import gc
import os
import signal
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass

from solver.process import fork


@dataclass(frozen=True, kw_only=True)
class Task:
    """What one process does, as its exit status; it waits until ``after``, if named, has ended."""

    name: str
    label: str
    do: Callable[[], int]
    after: str | None = None


@dataclass(frozen=True)
class Ended:
    """How the process of a task ended: its status, negative for a signal, and wall seconds."""

    task: Task
    status: int
    seconds: float


def run(tasks: Iterable[Task], cores: int, begins: Callable[[Task], None]) -> Iterator[Ended]:
    """Do tasks, in this order as far as they need not wait; whatever one does, others go on.

    Processes that are not waited for any more are ended.
    """
    waiting, running = list(tasks), dict[int, tuple[Task, float]]()
    unfinished = {task.name for task in waiting}
    gc.freeze()  # else the first collection in a process copies all that it has of this one: 30 ms
    try:
        while waiting or running:
            ready = next((task for task in waiting if task.after not in unfinished), None)
            if ready is not None and len(running) < cores:
                waiting.remove(ready)
                begins(ready)
                running[fork(ready.do)] = ready, time.monotonic()
                continue
            number, status = os.wait()
            task, since = running.pop(number)
            unfinished.discard(task.name)
            yield Ended(task, os.waitstatus_to_exitcode(status), time.monotonic() - since)
    finally:
        for number in running:
            with suppress(ProcessLookupError):
                os.kill(number, signal.SIGTERM)
        for number in running:
            with suppress(ChildProcessError):
                os.waitpid(number, 0)
