"""A gmsh model from nothing to a file that is whole or absent."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def writing(path: Path, suffix: str) -> Iterator[None]:
    """Build a gmsh model in the block; it is written to ``path`` when the block ends.

    gmsh chooses the format by ``suffix``. Nothing is written if the block raises. The user's own
    gmsh settings are not read, so that equal input gives equal bytes.
    """
    import gmsh  # 0.3 s: only where something is meshed

    aside = path.with_name(f".{path.name}.{os.getpid()}{suffix}")
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        yield
        gmsh.write(str(aside))
        os.replace(aside, path)
    finally:
        aside.unlink(missing_ok=True)
        gmsh.finalize()
