"""Making a mesh in a process of its own, within limits of time and memory."""

import errno
import os
import resource
import signal
import sys
import traceback
from collections.abc import Callable
from pathlib import Path

from geometry.refusal import Refusal

OWN_SIGNALS = {  # what a process brings on itself; every other signal comes from outside
    signal.SIGABRT,
    signal.SIGBUS,
    signal.SIGFPE,
    signal.SIGILL,
    signal.SIGSEGV,
    signal.SIGSYS,
    signal.SIGTRAP,
}
MADE, CANNOT, FAILED = 0, 2, os.EX_TEMPFAIL  # exit statuses of the process
MIB = 1024**2


class Failed(Exception):
    """It failed for a reason that says nothing about what was to be made."""


def why_not(make: Callable[[], None], wall_time: float, memory: float) -> str:
    """Why ``make`` fails, by its own fault or at a limit [s, MB]; empty if it does not.

    The limit of memory is of what it takes beside what this process has.

    What a signal from outside has ended is tried once more.

    Raises
    ------
    Failed
        If it was stopped from outside, or could not read or write a file.
    """
    status, said = _run(make, wall_time, memory)
    if _is_foreign(status):
        status, said = _run(make, wall_time, memory)  # whoever stops it again means it
    if status == -signal.SIGALRM:
        return f"stopped after {wall_time:g} s, the limit"
    if status < 0:
        said = f"the mesher was ended by {signal.Signals(-status).name}"
    if status == FAILED or _is_foreign(status):
        raise Failed(said)
    if status in (MADE, CANNOT):
        return said
    return f"{said or f'the mesher stopped with status {status}'}; it may use {memory:g} MB"


def _is_foreign(status: int) -> bool:
    return status < 0 and -status not in {*OWN_SIGNALS, signal.SIGALRM}


def _run(make: Callable[[], None], wall_time: float, memory: float) -> tuple[int, str]:
    """Exit status of the process, negative for a signal, and what it says."""
    here, there = os.pipe()
    process = os.fork()
    if not process:
        status, said = _outcome(make, wall_time, memory)
        os.write(there, said.encode(errors="replace")[:4000])
        sys.stderr.flush()
        os._exit(status)
    os.close(there)
    with open(here, encoding="utf-8", errors="replace") as pipe:
        said = pipe.read()
    return os.waitstatus_to_exitcode(os.waitpid(process, 0)[1]), said


def _outcome(make: Callable[[], None], wall_time: float, memory: float) -> tuple[int, str]:
    """In the process: make it."""
    try:
        import gmsh  # noqa: F401  before the limit: a library that is not there is no fault of ours

        limit = _size() + int(memory * MIB)
        _, allowed = resource.getrlimit(resource.RLIMIT_AS)
        if allowed != resource.RLIM_INFINITY:
            limit = min(limit, allowed)
        resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.setitimer(signal.ITIMER_REAL, wall_time)
        make()
    except Refusal as error:
        return CANNOT, str(error)
    except MemoryError:
        return CANNOT, f"not within {memory:g} MB, the limit"
    except (OSError, ImportError) as error:
        own = isinstance(error, OSError) and error.errno == errno.ENOMEM
        return (CANNOT if own else FAILED), str(error)
    except Exception as error:  # gmsh has no class of its own
        traceback.print_exc()
        return CANNOT, f"{type(error).__name__}: {error}"
    except BaseException as error:
        return FAILED, type(error).__name__
    return MADE, ""


def _size() -> int:
    """Address space of this process [bytes].

    It has all that the process it was forked from had, which may be more than the limit of a mesh:
    a notebook, or a program that has imported much.
    """
    pages = Path("/proc/self/statm").read_text().split()[0]
    return int(pages) * resource.getpagesize()
