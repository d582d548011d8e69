"""Tasks in processes beside this one, so many at a time, some after others.

A process does one task after another, since to begin one takes as long as a small task; one that
breaks or is killed loses the task that it was at, and another takes its place.
"""

import gc
import os
import select
import signal
import struct
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial

from solver.process import fork

ORDER = struct.Struct("i")  # what goes through a pipe: the number of a task, or its status
END = -1  # in place of a task
LOOK = 0.2  # s, how soon it is noticed that a process has ended, which nobody has to wait for


@dataclass(frozen=True, kw_only=True)
class Task:
    """What a process does, with a status; it waits until ``after``, if named, has ended."""

    name: str
    label: str
    do: Callable[[], int]
    after: str | None = None


@dataclass(frozen=True)
class Ended:
    """How a task ended: its status, negative for a signal, and wall seconds."""

    task: Task
    status: int
    seconds: float


def run(tasks: Iterable[Task], cores: int, begins: Callable[[Task], None]) -> Iterator[Ended]:
    """Do tasks, in this order as far as they need not wait; whatever one does, others go on.

    What is not waited for any more is ended.
    """
    every = list(tasks)
    waiting, workers = dict(enumerate(every)), list[_Worker]()
    unfinished = {task.name for task in every}
    gc.freeze()  # else the first collection in a process copies all that it has of this one: 30 ms
    try:
        while waiting or any(worker.task for worker in workers):
            ready = next((k for k, task in waiting.items() if task.after not in unfinished), None)
            idle = next((worker for worker in workers if worker.task is None), None)
            if ready is not None and idle is None and len(workers) < cores:
                workers.append(idle := _Worker(every))
            if ready is not None and idle is not None:
                task = waiting.pop(ready)
                begins(task)
                idle.begin(ready, task)
                continue
            for worker, status in _ended(workers):
                assert worker.task is not None
                task, worker.task = worker.task, None
                if not worker.lives:
                    workers.remove(worker)
                unfinished.discard(task.name)
                yield Ended(task, status, time.monotonic() - worker.since)
    finally:
        for worker in workers:
            worker.end()
        for worker in workers:
            worker.wait()


class _Worker:
    """A process that does those of some tasks that it is told to do.

    Attributes
    ----------
    task : that it is at, if any, ``since`` when [s]
    lives : False if it has been found to have ended
    answers : pipe from which its statuses are read
    """

    def __init__(self, tasks: Sequence[Task]) -> None:
        self.task: Task | None = None
        self.since, self.lives = 0.0, True
        orders, self.orders = os.pipe()
        self.answers, answers = os.pipe()
        self.number = fork(partial(_serve, tasks, orders, answers))
        os.close(orders)
        os.close(answers)

    def begin(self, number: int, task: Task) -> None:
        """Do a task, which has this number among all."""
        self.task, self.since = task, time.monotonic()
        with suppress(BrokenPipeError):  # it has ended, as will be noticed
            os.write(self.orders, ORDER.pack(number))

    def status(self) -> int | None:
        """How its task has ended; None if it has not."""
        if select.select([self.answers], [], [], 0)[0]:
            answer = os.read(self.answers, ORDER.size)
            if answer:
                return int(ORDER.unpack(answer)[0])
            return self.wait()
        number, status = os.waitpid(self.number, os.WNOHANG)
        return self._closed(status) if number else None

    def end(self) -> None:
        """Let it end; what it is at is stopped."""
        with suppress(ProcessLookupError, BrokenPipeError):
            if self.task is None:
                os.write(self.orders, ORDER.pack(END))
            else:
                os.kill(self.number, signal.SIGTERM)

    def wait(self) -> int:
        """Its exit status, negative for a signal, when it has ended."""
        return self._closed(os.waitpid(self.number, 0)[1])

    def _closed(self, status: int) -> int:
        self.lives = False
        os.close(self.orders)
        os.close(self.answers)
        return os.waitstatus_to_exitcode(status)


def _ended(workers: Sequence[_Worker]) -> Iterator[tuple[_Worker, int]]:
    """Those whose task has ended, and how; waits a while for one."""
    busy = [worker for worker in workers if worker.task]
    select.select([worker.answers for worker in busy], [], [], LOOK)
    for worker in busy:
        status = worker.status()
        if status is not None:
            yield worker, status


def _serve(tasks: Sequence[Task], orders: int, answers: int) -> int:
    """In the process: do what is ordered."""
    while order := os.read(orders, ORDER.size):
        (number,) = ORDER.unpack(order)
        if number == END:
            break
        status = tasks[number].do()
        sys.stdout.flush()
        sys.stderr.flush()
        os.write(answers, ORDER.pack(status))
    return 0
