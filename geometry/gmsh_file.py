"""A gmsh model from nothing to a file that is whole or absent."""

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from geometry.files import atomic_write


@contextmanager
def writing(
    path: Path, suffix: str, finish: Callable[[Path], None] = lambda _: None
) -> Iterator[None]:
    """Build a gmsh model in the block; it is written to ``path`` when the block ends.

    gmsh chooses the format by ``suffix``; ``finish`` may still change the file before it gets its
    name. Nothing is written if the block raises. The user's own gmsh settings are not read, so
    that equal input gives equal bytes.

    Raises
    ------
    OSError
        If there is no such folder, or it cannot be written to.
    """
    import gmsh  # 0.3 s: only where something is meshed

    if not path.parent.is_dir():
        raise FileNotFoundError(f"{path.parent}: there is no such folder")
    with atomic_write(path, suffix=suffix) as beside:
        gmsh.initialize(readConfigFiles=False, interruptible=False)
        try:
            gmsh.option.setNumber("General.Terminal", 0)
            yield
            beside.touch()  # where it cannot be written to this says why, and gmsh does not
            with _silent():
                _write(beside)
            finish(beside)
        finally:
            gmsh.finalize()


def _write(path: Path) -> None:
    import gmsh

    try:
        gmsh.write(str(path))
    except Exception as error:  # gmsh has no class of its own
        raise OSError(f"{path}: gmsh cannot write it ({error})") from error


@contextmanager
def _silent() -> Iterator[None]:
    """No standard output, not even from C++: OpenCASCADE reports what it writes, unasked."""
    sys.stdout.flush()
    kept = os.dup(1)
    with open(os.devnull, "w") as nowhere:
        os.dup2(nowhere.fileno(), 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
