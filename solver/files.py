"""Reading what a program has left that may have written anything."""

import stat
from pathlib import Path


def read(path: Path, most: int) -> bytes | None:
    """The bytes of a file; None if there is none.

    Raises
    ------
    ValueError
        If it has more than ``most`` bytes, or is no ordinary file: a pipe never ends.
    """
    try:
        found = path.lstat()
    except FileNotFoundError:
        return None
    if not stat.S_ISREG(found.st_mode):
        raise ValueError(f"{path.name} is no ordinary file")
    if found.st_size > most:
        raise ValueError(f"{path.name} has {found.st_size} bytes, more than {most}")
    return path.read_bytes()


def end(path: Path, most: int) -> bytes:
    """The last bytes of a file, at most ``most``; none if there is no such file."""
    if not path.is_file():
        return b""
    with path.open("rb") as file:
        file.seek(max(path.stat().st_size - most, 0))
        return file.read(most)
