"""Files that are whole or absent, and sealed: what is in ``results`` can be compared later.

A file is written beside its place, then renamed. The seal of ``results/<file>`` is
``results/seals/<file>``: SHA-256 and number of bytes. It is there before the file itself, so that
a process that is killed leaves no file that would be taken for whole.
"""

import hashlib
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

RESULTS, SEALS = Path("results"), Path("results/seals")


@contextmanager
def aside(path: Path) -> Iterator[Path]:
    """A path to write to, which becomes ``path`` if the block ends well and vanishes if not."""
    path.parent.mkdir(parents=True, exist_ok=True)
    beside = path.with_name(f".{os.getpid()}.{path.name}")
    try:
        yield beside
        put(beside, path)
    finally:
        beside.unlink(missing_ok=True)


def put(beside: Path, path: Path) -> None:
    """Give a file that is whole its name, and its seal if it is one of ``results``."""
    absolute, folder = Path(os.path.abspath(path)), Path.cwd() / RESULTS
    if absolute.is_relative_to(folder):
        _seal(beside, SEALS / absolute.relative_to(folder))
    os.replace(beside, path)


def seal_of(path: Path) -> str:
    """The seal of a file as it is now."""
    with path.open("rb") as file:
        return f"{hashlib.file_digest(file, 'sha256').hexdigest()} {path.stat().st_size}\n"


def _seal(path: Path, seal: Path) -> None:
    seal.parent.mkdir(parents=True, exist_ok=True)
    beside = seal.with_name(f".{os.getpid()}.{seal.name}")
    try:
        beside.write_text(seal_of(path))
        os.replace(beside, seal)
    finally:
        beside.unlink(missing_ok=True)
