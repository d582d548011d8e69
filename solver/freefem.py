"""Run a FreeFEM program."""

import errno
import math
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from geometry.attempt import OWN_SIGNALS
from solver import files
from solver.process import Family, wait

PATH = Path(__file__).parent / "path"  # solution control, which every program includes
DEBIAN_PLUGINS = Path("/usr/lib/freefem++")  # where Debian puts them; its program looks elsewhere
CLOCK = Path(sys.prefix, "lib/muscle_clock.so")  # solver/clock.c, compiled by ./setup.sh
CHECK_ANSWER, CHECK_TIME = "FreeFEM is ready: 2", 20.0  # s
LONGEST = 200  # characters of a line that is quoted
LOG_TAIL = 15  # lines of the log that a message quotes
MIB = 1024**2
LARGEST_FILE = 256 * MIB  # that FreeFEM may write
LARGEST_LOG = MIB  # that is kept, its end
LARGEST_COST = 2**14
SIZES = {"unknowns"}  # parts of a usage that do not add up
NO_MEMORY = "failed to map segment"  # of a loader that may not use enough
NOT_RUN = {126, 127}  # exit statuses of a shell or loader that could not run the program
SIGNALLED = 128  # exit status of a shell whose program was ended by signal 0
OWN_EXITS = {64: "an argument is missing"}
FREEFEM_EXITS = {
    1: "the program does not compile",
    2: "a plugin is missing",
    8: "it broke off while computing",
}


class FreeFemError(RuntimeError):
    """FreeFEM cannot be run, or stopped with a non-zero status."""


class Outside(FreeFemError):
    """It failed for a reason that says nothing about the case."""


class Interrupted(Outside):
    """A signal from outside stopped it."""


class OutOfTime(FreeFemError):
    """The wall-time limit was reached."""


@dataclass(frozen=True, kw_only=True)
class Limits:
    """What a solve may use."""

    wall_time: float  # s
    memory: float  # MB of address space


@dataclass(frozen=True, kw_only=True)
class Usage:
    """What a solve has used.

    Attributes
    ----------
    parts : what the program says of itself (solver/path/cost.idp): CPU seconds by purpose,
        iterations, factorisations, unknowns; empty if it does not
    """

    seconds: float  # wall
    cpu_seconds: float
    peak_memory: float  # MB
    parts: dict[str, float] = field(default_factory=dict)

    def __add__(self, other: "Usage") -> "Usage":
        """What two runs of the same program, one after the other, have used."""
        names = [*self.parts, *(name for name in other.parts if name not in self.parts)]
        return Usage(
            seconds=self.seconds + other.seconds,
            cpu_seconds=self.cpu_seconds + other.cpu_seconds,
            peak_memory=max(self.peak_memory, other.peak_memory),
            parts={
                name: (max if name in SIZES else sum)(
                    (self.parts.get(name, 0.0), other.parts.get(name, 0.0))
                )
                for name in names
            },
        )


def executable() -> str:
    """Path of FreeFEM.

    Raises
    ------
    Outside
        If there is none on PATH.
    """
    found = shutil.which("FreeFem++")
    if found is None:
        raise Outside("FreeFem++ is not on PATH; ./setup.sh installs it")
    return found


def check() -> None:
    """Run a program that loads every plugin the models need and adds two numbers (30 ms).

    Raises
    ------
    FreeFemError
        If FreeFEM or a plugin is missing or does not work, with what to do in a few lines.
    """
    found = command(Path(__file__).with_name("check.edp"), {})
    try:
        done = subprocess.run(
            found,
            env=environment(),
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=CHECK_TIME,
            check=False,
        )
    except OSError as error:
        raise FreeFemError(f"{found[0]} cannot be run ({error.strerror})") from error
    except subprocess.TimeoutExpired as error:
        raise FreeFemError(f"{found[0]} hangs: it does not add 1 and 1") from error
    if done.returncode == 0 and CHECK_ANSWER in done.stdout:
        return
    said = done.stdout + done.stderr
    missing = re.search(r"Load error: (\S+)", said)
    if missing:
        raise FreeFemError(
            f"{found[0]} does not find its plugin {missing[1]}; ./setup.sh installs Debian's, "
            "FF_LOADPATH names their folder"
        )
    said = readable(" ".join(said.split()))
    how = explain(done.returncode) if done.returncode else "It does not add 1 and 1"
    raise FreeFemError(f"{found[0]} does not work. {how}: {said or 'it says nothing'}")


def command(program: Path, flags: dict[str, str | float]) -> list[str]:
    """Argument list: no graphics, quiet, the program, then its own flags without losing a digit."""
    arguments = [executable(), "-nw", "-v", "0", str(program)]
    for name, value in flags.items():
        arguments += [f"-{name}", value if isinstance(value, str) else repr(value)]
    return arguments


def environment(includes: Sequence[Path] = (PATH,)) -> dict[str, str]:
    """The caller's environment, with our folders of includes searched first and one thread.

    FreeFEM looks for an include in the working directory and in FF_INCLUDEPATH, not beside the
    program that includes it. It takes our clock, where that is compiled.
    """
    folders = [*map(str, includes), *filter(None, [os.environ.get("FF_INCLUDEPATH")])]
    own = {
        "FF_INCLUDEPATH": ";;".join(folders),
        "OMP_NUM_THREADS": "1",
        "OPENBLAS_NUM_THREADS": "1",
    }
    if DEBIAN_PLUGINS.is_dir():
        own["FF_LOADPATH"] = os.environ.get("FF_LOADPATH", str(DEBIAN_PLUGINS))
    if CLOCK.is_file() and not set(" :") & set(str(CLOCK)):  # these divide what is loaded
        own["LD_PRELOAD"] = f"{os.environ.get('LD_PRELOAD', '')} {CLOCK}".strip()
    return os.environ | own


def _whole(folder: Path, workdir: Path, number: int) -> Path:
    """A folder of includes by a name that FreeFEM does not divide: it does at a semicolon."""
    if ";" not in str(folder):
        return folder
    link = workdir / f"includes_{number}"
    link.unlink(missing_ok=True)
    link.symlink_to(folder)
    return link


def run(
    program: Path,
    flags: dict[str, str | float],
    workdir: Path,
    log: Path,
    limits: Limits,
    includes: Sequence[Path] = (PATH,),
) -> Usage:
    """Run a program in ``workdir`` to its end; the end of its output goes to ``log``.

    ``includes`` are the folders in which its includes are looked for.

    Raises
    ------
    OutOfTime
        If it runs longer than the limit; it and its children are gone then.
    Outside
        If it cannot be started; ``Interrupted`` if a signal from outside stopped it.
    OSError
        If it could not write a file to its end.
    FreeFemError
        If it ends with a non-zero status, by its own fault.
    """
    start = time.monotonic()
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    _check_memory(limits)
    with log.open("w") as stream, Family() as family:
        process = family.start(
            command(program, flags),
            workdir,
            environment([_whole(f, workdir, k) for k, f in enumerate(includes)]),
            stream,
            lambda: _limit(limits),
        )
        try:
            status = wait(process, limits.wall_time)
        except subprocess.TimeoutExpired as late:
            raise OutOfTime(f"stopped after {limits.wall_time:g} s, the limit") from late
        finally:
            family.end()
            _shorten(log)
    _check_status(status, log)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    parts = _parts(workdir / "cost.csv")
    # what the system says is the largest of all children, and of this process before it became one
    own_memory = parts.pop("peak_memory", 0.0)
    return Usage(
        seconds=time.monotonic() - start,
        cpu_seconds=after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime,
        peak_memory=own_memory or after.ru_maxrss / 1024,
        parts=parts,
    )


def _check_memory(limits: Limits) -> None:
    """Raise Outside if the limit is more than a process may have here."""
    _, allowed = resource.getrlimit(resource.RLIMIT_AS)
    if resource.RLIM_INFINITY != allowed < limits.memory * MIB:
        raise Outside(
            f"a process may take {allowed // MIB} MB of memory here (ulimit -v), fewer than the "
            f"limit of {limits.memory:g} MB"
        )


def _check_status(status: int, log: Path) -> None:
    """Raise what an exit status means, unless it is 0."""
    if status > SIGNALLED and status - SIGNALLED in set(signal.Signals):
        status = SIGNALLED - status  # FreeFEM was run by a shell
    if status == -signal.SIGXFSZ:
        if _largest_file() < LARGEST_FILE:
            raise OSError(errno.EFBIG, "FreeFEM has reached the limit of file sizes")
        raise FreeFemError(f"FreeFEM wrote a file of more than {LARGEST_FILE // MIB} MB")
    if status in NOT_RUN and NO_MEMORY not in tail(log):
        raise Outside(f"FreeFEM cannot be run: {' '.join(tail(log).split())}")
    if status < 0 and -status not in OWN_SIGNALS:
        raise Interrupted(explain(status))
    if status == 2 and "Load error" in tail(log):
        raise Outside(f"{explain(status)}; ./setup.sh installs Debian's")
    if status != 0:
        raise FreeFemError(explain(status))


def _parts(path: Path) -> dict[str, float]:
    """The rows of a program's cost.csv; none if it has written none.

    Raises
    ------
    FreeFemError
        If it holds anything else than names and numbers.
    """
    try:
        text = (files.read(path, LARGEST_COST) or b"").decode()
        rows = (line.split(",") for line in text.splitlines()[1:])
        found = {name: float(value) for name, value in rows}
        if not all(map(math.isfinite, found.values())):
            raise ValueError("a number is not finite")
    except ValueError as error:
        raise FreeFemError(f"what FreeFEM has written cannot be read ({error})") from error
    return found


def explain(status: int) -> str:
    """What an exit status of FreeFEM means."""
    if status < 0:
        known = -status in set(signal.Signals)
        name = signal.Signals(-status).name if known else f"signal {-status}"
        return f"FreeFEM was ended by {name}"
    meaning = (OWN_EXITS | FREEFEM_EXITS).get(status, "see its log")
    return f"FreeFEM stopped with status {status}: {meaning}"


def tail(log: Path) -> str:
    """The last lines of a log."""
    text = files.end(log, LOG_TAIL * LONGEST * 4).decode(errors="replace")
    return "\n".join(map(readable, text.splitlines()[-LOG_TAIL:]))


def _shorten(log: Path) -> None:
    """Keep the end of a log that is too long."""
    if log.is_file() and log.stat().st_size > LARGEST_LOG:
        kept = files.end(log, LARGEST_LOG)
        log.write_bytes(b"(only the end is kept)\n" + kept)


def readable(line: str) -> str:
    """A line of what may be rubbish, which a record can hold (no NUL) and a terminal survives."""
    return "".join(c if c.isprintable() or c == "\t" else "\ufffd" for c in line[:LONGEST])


def _limit(limits: Limits) -> None:
    """No endless file, no core file, and last no more memory than allowed.

    A copy of a large process has more than that already, and gets no more to go on with.
    """
    memory = int(limits.memory * MIB)
    size = min(_largest_file(), LARGEST_FILE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_AS, (memory, memory))


def _largest_file() -> int:
    """Size of the largest file that this process may write [bytes]."""
    allowed, _ = resource.getrlimit(resource.RLIMIT_FSIZE)
    return sys.maxsize if allowed == resource.RLIM_INFINITY else allowed
