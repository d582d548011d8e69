"""What has happened to results since they were written, by their seals (geometry/files.py)."""

import os
import shutil
import stat
import time
from collections.abc import Iterator
from pathlib import Path

from geometry.files import RESULTS, SEALS, seal_of
from workflow.study.errors import StudyError
from workflow.study.folders import STORE


def noticed() -> dict[str, str]:
    """What is missing or of another size, with what is wrong; no file is read for this."""
    found = {str(path): _at_a_glance(path, seal) for path, seal in _sealed()}
    return {path: wrong for path, wrong in found.items() if wrong}


def at_a_glance(path: Path) -> str:
    """What is wrong with a result, without reading it: missing, no file, of another size."""
    seal = SEALS / path.relative_to(RESULTS)
    return _at_a_glance(path, seal.read_text(errors="replace") if seal.is_file() else None)


def compared() -> tuple[int, dict[str, str]]:
    """How many files have a seal, and what is wrong with those that are not as it says."""
    found = {str(path): _wrong(path, seal) for path, seal in _sealed()}
    return len(found), {path: wrong for path, wrong in found.items() if wrong}


def end_future(folder: Path) -> None:
    """Date what is of tomorrow now: Snakemake refuses what is made of it, and its contents count.

    So it is after a clock was set back. ``folder`` is that of a study.
    """
    now = time.time()
    for place, inner, names in os.walk(folder):
        inner[:] = [name for name in inner if Path(place, name) not in STORE]
        for name in names:
            path = Path(place, name)
            if path.lstat().st_mtime > now and path.is_file():
                os.utime(path, (now, now))


def remove(path: Path) -> None:
    """Delete what stands in the place of a result, whatever it is."""
    make_room(path)
    path.unlink(missing_ok=True)


def make_room(path: Path) -> None:
    """Delete a folder that stands in the place of a result; a file can be replaced."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)


def report(delete: bool) -> bool:
    """Print what is not as it was written; whether all is.

    Raises
    ------
    StudyError
        If nothing has a seal.
    """
    count, damaged = compared()
    if not count:
        raise StudyError(f"{SEALS}: there are no seals of results; run snakemake")
    for path, wrong in damaged.items():
        print(f"{path}: {wrong}")
        if delete:
            remove(Path(path))
    if not damaged:
        print(f"{count} files are as they were written")
    elif delete:
        print(f"{len(damaged)} of {count} files are deleted; the next run makes them again")
    else:
        print(
            f"{len(damaged)} of {count} files are not as they were written; with --delete they are "
            "deleted, and the next run makes them again"
        )
    return not damaged


def _sealed() -> Iterator[tuple[Path, str]]:
    """Results that have a seal, and what it says."""
    for folder, _, names in sorted(os.walk(SEALS)):
        place = RESULTS / os.path.relpath(folder, SEALS)
        for name in sorted(names):
            if not name.startswith("."):
                with open(os.path.join(folder, name), errors="replace") as seal:
                    yield place / name, seal.read()


def _at_a_glance(path: Path, seal: str | None) -> str:
    """What is wrong with a file, without reading it."""
    try:
        found = path.stat()
    except OSError:
        return "missing"
    if not stat.S_ISREG(found.st_mode):
        return "no file"
    if seal is not None and seal.split()[1:] != [str(found.st_size)]:
        return f"of another size ({found.st_size} bytes)"
    return ""


def _wrong(path: Path, seal: str) -> str:
    return _at_a_glance(path, seal) or ("changed" if seal_of(path) != seal else "")
