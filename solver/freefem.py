"""Run a FreeFEM program of solver/edp. The only module that starts a process."""

import ctypes
import errno
import os
import re
import resource
import shutil
import signal
import subprocess
import time
from dataclasses import dataclass, field
from pathlib import Path

EDP = Path(__file__).parent / "edp"
DEBIAN_PLUGINS = Path("/usr/lib/freefem++")  # where Debian puts them; its program looks elsewhere
FROM_OUTSIDE = {-signal.SIGKILL, -signal.SIGTERM, -signal.SIGINT, -signal.SIGHUP}
CHECK_ANSWER, CHECK_TIME = "FreeFEM is ready: 2", 20.0  # s
LONGEST = 200  # characters of a line that is quoted
LOG_TAIL = 15  # lines of the log that a message quotes
MIB = 1024**2
SIZES = {"unknowns"}  # parts of a usage that do not add up
LIBC = ctypes.CDLL(None)  # loaded before a child forks
PR_SET_PDEATHSIG = 1  # linux/prctl.h
OWN_EXITS = {64: "an argument is missing"}
FREEFEM_EXITS = {
    1: "the program does not compile",
    2: "a plugin is missing",
    8: "it broke off while computing",
}


class FreeFemError(RuntimeError):
    """FreeFEM cannot be run, or stopped with a non-zero status."""


class Interrupted(FreeFemError):
    """It was stopped from outside, which says nothing about the case."""


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
    parts : what the program says of itself (solver/edp/cost.idp): CPU seconds by purpose,
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
    FreeFemError
        If there is none on PATH.
    """
    found = shutil.which("FreeFem++")
    if found is None:
        raise FreeFemError("FreeFem++ is not on PATH; ./setup.sh installs it")
    return found


def check() -> None:
    """Run a program that loads every plugin the models need and adds two numbers (30 ms).

    Raises
    ------
    FreeFemError
        If FreeFEM or a plugin is missing or does not work, with what to do in a few lines.
    """
    found = command("check.edp", {})
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


def command(program: str, flags: dict[str, str | float]) -> list[str]:
    """Argument list: no graphics, quiet, the program, then its own flags without losing a digit."""
    arguments = [executable(), "-nw", "-v", "0", str(EDP / program)]
    for name, value in flags.items():
        arguments += [f"-{name}", value if isinstance(value, str) else repr(value)]
    return arguments


def environment() -> dict[str, str]:
    """The caller's environment, with our includes searched first and one thread.

    FreeFEM looks for an include in the working directory and in FF_INCLUDEPATH, not beside the
    program that includes it.
    """
    includes = [str(EDP), *filter(None, [os.environ.get("FF_INCLUDEPATH")])]
    own = {
        "FF_INCLUDEPATH": ";;".join(includes),
        "OMP_NUM_THREADS": "1",
        "OPENBLAS_NUM_THREADS": "1",
    }
    if DEBIAN_PLUGINS.is_dir():
        own["FF_LOADPATH"] = os.environ.get("FF_LOADPATH", str(DEBIAN_PLUGINS))
    return os.environ | own


def run(
    program: str, flags: dict[str, str | float], workdir: Path, log: Path, limits: Limits
) -> Usage:
    """Run a program of solver/edp in ``workdir`` to its end; its output goes to ``log``.

    Raises
    ------
    OutOfTime
        If it runs longer than the limit; it and its children are gone then.
    Interrupted
        If a signal from outside stopped it.
    OSError
        If it could not write a file to its end.
    FreeFemError
        If it cannot be started or ends with a non-zero status.
    """
    start = time.monotonic()
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with log.open("w") as stream:
        process = subprocess.Popen(
            command(program, flags),
            cwd=workdir,
            env=environment(),
            stdin=subprocess.DEVNULL,
            stdout=stream,
            stderr=subprocess.STDOUT,
            start_new_session=True,
            preexec_fn=lambda: _limit(limits),
        )
        try:
            status = process.wait(limits.wall_time)
        except subprocess.TimeoutExpired as late:
            raise OutOfTime(f"stopped after {limits.wall_time:g} s, the limit") from late
        finally:
            _end(process)
    if status == -signal.SIGXFSZ:
        raise OSError(errno.EFBIG, "FreeFEM has reached the limit of file sizes")
    if status != 0:
        raise (Interrupted if status in FROM_OUTSIDE else FreeFemError)(explain(status))
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


def _parts(path: Path) -> dict[str, float]:
    """The rows of a program's cost.csv; none if it has written none."""
    if not path.exists():
        return {}
    rows = (line.split(",") for line in path.read_text().splitlines()[1:])
    return {name: float(value) for name, value in rows}


def explain(status: int) -> str:
    """What an exit status of FreeFEM means."""
    if status < 0:
        return f"FreeFEM was ended by {signal.Signals(-status).name}"
    meaning = (OWN_EXITS | FREEFEM_EXITS).get(status, "see its log")
    return f"FreeFEM stopped with status {status}: {meaning}"


def tail(log: Path) -> str:
    """The last lines of a log."""
    if not log.exists():
        return ""
    return "\n".join(map(readable, log.read_text(errors="replace").splitlines()[-LOG_TAIL:]))


def readable(line: str) -> str:
    """A line of what may be rubbish, which a record can hold (no NUL) and a terminal survives."""
    return "".join(c if c.isprintable() or c == "\t" else "\ufffd" for c in line[:LONGEST])


def _limit(limits: Limits) -> None:
    """In the child, before FreeFEM starts: no more memory than allowed, and no core file.

    It ends with this process, however that ends.
    """
    LIBC.prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    memory = int(limits.memory * MIB)
    resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def _end(process: subprocess.Popen[bytes]) -> None:
    """Nothing of the process survives, whatever ended the wait."""
    if process.poll() is None:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
