"""Files that are whole or absent, and sealed: what is in ``results`` can be compared later.

A file is written beside its place, brought to the disk, then renamed. The seal of
``results/<file>`` is ``results/seals/<file>``: SHA-256 and number of bytes. It is there before the
file itself, so that a process that is killed leaves no file that would be taken for whole.
"""

import hashlib
import os
import re
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

RESULTS, SEALS = Path("results"), Path("results/seals")
HOST = re.sub("[^A-Za-z0-9-]", "-", socket.gethostname())[:64]  # jobs of a cluster share a folder


@contextmanager
def atomic_write(path: Path, *, suffix: str = "", sealed: bool = True) -> Iterator[Path]:
    """A path to write to, which becomes ``path`` if the block ends well and vanishes if not.

    It ends with ``suffix``, by which some programs choose a format. What differs from run to run
    without being another result is not ``sealed``.
    """
    absolute, results = Path(os.path.abspath(path)), Path.cwd() / RESULTS
    with _renamed(path, suffix) as beside:
        yield beside
        if sealed and absolute.is_relative_to(results):
            with _renamed(SEALS / absolute.relative_to(results)) as seal:
                seal.write_text(seal_of(beside))


@contextmanager
def _renamed(path: Path, suffix: str = "") -> Iterator[Path]:
    """A file beside ``path`` that is on the disk before it gets its name."""
    path.parent.mkdir(parents=True, exist_ok=True)
    beside = path.with_name(f".{HOST}.{os.getpid()}.{path.name}{suffix}")
    try:
        yield beside
        with beside.open("rb") as file:
            os.fsync(file.fileno())
        os.replace(beside, path)
    finally:
        beside.unlink(missing_ok=True)


def seal_of(path: Path) -> str:
    """The seal of a file as it is now."""
    with path.open("rb") as file:
        return f"{hashlib.file_digest(file, 'sha256').hexdigest()} {path.stat().st_size}\n"
