"""One run at a time in a folder; what a killed run left does not disturb the next."""

import errno
import fcntl
import os
import re
import signal
import subprocess
import sys
from pathlib import Path
from typing import TextIO

from geometry.files import HOST

MARK = "MUSCLE_RUN"  # environment variable of all that a run starts: the lock it holds
PREFIX = "muscle_"  # of the names of a run's jobs on a cluster (profiles/slurm)
NO_LOCKS = {errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP}
ANSWER = 10.0  # s, for a cluster's programs
_held: list[TextIO] = []  # open files: a lock lives as long as its file is open in a living process


def take(path: Path, *, cluster: bool = False) -> None:
    """Lock a file until this process ends, however it ends, and end what a killed run left.

    The kernel drops the lock with the process, so nothing stale can be left (Snakemake's own
    locks are files that outlive a kill; the profile turns them off). A run on a ``cluster`` leaves
    a file beside it until ``ended``, by which the next one knows that jobs may live.

    Raises
    ------
    SystemExit
        If a living process holds the lock, with a message that names it.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    file = path.open("a+", errors="replace")
    file.seek(0)
    owner = file.read().strip() or "unknown"
    try:
        free = _lock(file.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB) or not (
            owner.isdigit() and _writes_here(owner)
        )
    except BlockingIOError:
        free = False
    if not free:
        sys.exit(f"Another run works in this folder (process {owner}): wait for it or stop it.")
    file.truncate(0)
    file.write(f"{os.getpid()}\n")
    file.flush()
    _held.append(file)
    os.environ[MARK] = str(path.resolve())
    _end_orphans(os.environ[MARK])
    jobs = _jobs(path)
    if jobs.exists() and _cancel_orphans():
        jobs.unlink()
    if cluster:
        jobs.touch()


def ended(path: Path) -> None:
    """The run that has locked this file has no jobs any more, here or on a cluster."""
    _jobs(path).unlink(missing_ok=True)


def _jobs(path: Path) -> Path:
    return path.with_suffix(".cluster")


def wait(file: int) -> None:
    """Lock an open file or folder as soon as no other process has locked it."""
    _lock(file, fcntl.LOCK_EX)


def _lock(file: int, how: int) -> bool:
    """Lock an open file; False, and a warning, where the file system has no locks."""
    try:
        fcntl.flock(file, how)
    except OSError as error:
        if error.errno not in NO_LOCKS:
            raise
        print(
            f"warning: the file system of this folder has no locks ({error.strerror}): let no two "
            "computers work here at a time",
            file=sys.stderr,
        )
        return False
    return True


def _end_orphans(lock: str) -> None:
    """End jobs that outlived their run, before their results come in between."""
    for process in Path("/proc").glob("[0-9]*"):
        try:
            marks = (process / "environ").read_bytes().split(b"\0")
            if f"{MARK}={lock}".encode() in marks and int(process.name) != os.getpid():
                os.kill(int(process.name), signal.SIGKILL)
        except OSError:
            continue  # ended, or somebody else's


def _cancel_orphans() -> bool:
    """End jobs of a cluster that outlived the run which began them in this folder.

    False, and a warning, where the cluster cannot be asked.
    """
    asked = ["squeue", "--me", "--noheader", "--format=%i|%j|%Z"]
    try:
        answer = subprocess.run(asked, capture_output=True, text=True, timeout=ANSWER, check=True)
        jobs = [line.split("|", 2) for line in answer.stdout.splitlines() if line.count("|") > 1]
        here = [job for job, name, folder in jobs if name.startswith(PREFIX) and _is_here(folder)]
        if here:
            print(f"Cancelling {len(here)} jobs of a run that was killed", file=sys.stderr)
            subprocess.run(["scancel", *here], timeout=ANSWER, check=True, capture_output=True)
    except (OSError, subprocess.SubprocessError) as error:
        said = error.stderr if isinstance(error, subprocess.CalledProcessError) else ""
        print(
            "warning: the last run in this folder used a cluster and was killed; its jobs "
            f"cannot be looked for ({said.strip() or error}): if some go on, end them with scancel",
            file=sys.stderr,
        )
        return False
    return True


def _is_here(folder: str) -> bool:
    try:
        return Path(folder).samefile(Path.cwd())
    except OSError:
        return False


def tidy(folder: Path) -> None:
    """Delete files that processes of this machine were writing, which are gone by now."""
    for path in folder.rglob(".*"):
        writer = re.match(rf"\.{re.escape(HOST)}\.(\d+)\.", path.name)
        if writer and path.is_file() and not _writes_here(writer[1]):
            path.unlink(missing_ok=True)


def _writes_here(process: str) -> bool:
    """Whether a process lives and works in this folder; its number may be another's by now."""
    try:
        there = Path("/proc", process, "cwd").readlink()
        return there == Path.cwd() and process != str(os.getpid())
    except OSError:
        return False  # gone, or somebody else's
