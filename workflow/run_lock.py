"""One run at a time in a folder; the lock of a run that was killed is no lock."""

import fcntl
import os
import sys
from pathlib import Path

_held = []  # open files: a lock lives as long as its file is open in a living process


def take(path: Path) -> None:
    """Lock a file until this process ends, however it ends.

    The kernel drops the lock with the process, so nothing stale can be left (Snakemake's own
    locks are files that outlive a kill; the profile turns them off).

    Raises
    ------
    SystemExit
        If a living process holds the lock, with a message that names it.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    file = path.open("a+")
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        file.seek(0)
        owner = file.read().strip() or "unknown"
        sys.exit(f"Another run works in this folder (process {owner}): wait for it or stop it.")
    file.truncate(0)
    file.write(f"{os.getpid()}\n")
    file.flush()
    _held.append(file)
