"""A process and all that it starts. The only module that starts one."""

import ctypes
import os
import select
import signal
import subprocess
import sys
import threading
import traceback
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import IO, ClassVar

INTERRUPTED = 128 + signal.SIGINT  # exit status, as a shell gives it
LIBC = ctypes.CDLL(None)  # loaded before a child forks
PR_SET_PDEATHSIG, PR_SET_CHILD_SUBREAPER = 1, 36  # linux/prctl.h


class Family:
    """A process and all that it starts, of which nothing survives.

    What leaves the group of the process, to go on after it, becomes a child of this process and is
    known by that.
    """

    lock = threading.Lock()
    running: ClassVar[set[int]] = set()  # first processes of all families

    def __enter__(self) -> "Family":
        LIBC.prctl(PR_SET_CHILD_SUBREAPER, 1)
        self.others = _children()
        return self

    def __exit__(self, *_: object) -> None:
        if not self.running:
            LIBC.prctl(PR_SET_CHILD_SUBREAPER, 0)

    def start(
        self,
        arguments: list[str],
        workdir: Path,
        environment: Mapping[str, str],
        output: IO[str],
        limit: Callable[[], None],
    ) -> subprocess.Popen[bytes]:
        """Start its first process, which ends with this one, however that ends.

        ``limit`` is called in the new process before the program starts.
        """

        def prepare() -> None:
            LIBC.prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
            limit()

        with self.lock:
            self.process = subprocess.Popen(
                arguments,
                cwd=workdir,
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                start_new_session=True,
                preexec_fn=prepare,
            )
            self.running.add(self.process.pid)
        return self.process

    def end(self) -> None:
        """End all of it, whatever ended the wait."""
        with suppress(ProcessLookupError):
            os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()
        with self.lock:
            self.running.discard(self.process.pid)
            while orphans := _children() - self.others - self.running:
                for orphan in orphans:
                    with suppress(OSError):
                        os.kill(orphan, signal.SIGKILL)
                        os.waitpid(orphan, 0)


def wait(process: subprocess.Popen[bytes], seconds: float) -> int:
    """Exit status of a process as soon as it has ended, which subprocess notices up to 50 ms late.

    Raises
    ------
    subprocess.TimeoutExpired
        If it has not by then.
    """
    try:
        handle = os.pidfd_open(process.pid)
    except OSError:  # a kernel before Linux 5.3
        return process.wait(seconds)
    try:
        if not select.select([handle], [], [], min(seconds, threading.TIMEOUT_MAX))[0]:
            raise subprocess.TimeoutExpired(process.args, seconds)
    finally:
        os.close(handle)
    return process.wait()


def fork(task: Callable[[], int]) -> int:
    """Do a task in a copy of this process, which ends with its status, or with this process.

    Gives the number of the copy; whoever starts one waits for it. Ctrl-C reaches all processes of a
    terminal, and this one ends its copies then, by SIGTERM.
    """
    parent = os.getpid()
    sys.stdout.flush()
    sys.stderr.flush()
    number = os.fork()
    if number:
        return number
    status = 1
    try:
        LIBC.prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        signal.signal(signal.SIGTERM, signal.default_int_handler)
        if os.getppid() == parent:  # else it has ended before it was asked for
            status = task()
    except KeyboardInterrupt:
        status = INTERRUPTED
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)


def _children() -> set[int]:
    """Processes whose parent this one is."""
    try:
        os.waitid(os.P_ALL, 0, os.WEXITED | os.WNOHANG | os.WNOWAIT)
    except ChildProcessError:
        return set()  # as nearly always, and there is nothing to look through
    found = set()
    for entry in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            if int((entry / "stat").read_text().rpartition(")")[2].split()[1]) == os.getpid():
                found.add(int(entry.name))
    return found
