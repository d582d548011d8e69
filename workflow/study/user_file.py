"""The text of a file that a user names: whatever stands there, an answer in bounded time."""

import os
import stat
from pathlib import Path

from workflow.study.errors import StudyError, printable

KINDS: dict[bytes | tuple[bytes, ...], str] = {  # by first bytes
    (b"\xff\xfe", b"\xfe\xff"): 'UTF-16, as "Unicode text" of spreadsheets',
    (b"PK\x03\x04", b"\xd0\xcf\x11\xe0", b"\x1f\x8b"): "a file of a spreadsheet or an archive",
}
LARGEST = 1_000_000  # bytes; a study of a thousand muscles has a tenth of that


def named_by(study: Path, name: str) -> str:
    """The path of a file that a study names: beside the study, or else from where a run starts."""
    beside = study.parent / name
    return str(beside) if study.parent != Path() and os.path.isfile(beside) else name


def sought(study: Path, name: str) -> str:
    """A line: where a file was looked for; nothing if it is there, or there is one place only."""
    if os.path.exists(name) or Path(name).is_absolute() or study.resolve().parent == Path.cwd():
        return ""
    folders = f"{printable(str(study.parent))}, beside the study file, and {Path.cwd()}"
    return f"\n  looked for in {folders}"


def text_of(path: Path, largest: int = LARGEST) -> str:
    """The text of a regular file in UTF-8, of so many bytes at most.

    Raises
    ------
    StudyError
        If there is none, it is too large, or cannot be read.
    """
    name = printable(str(path))
    try:
        found = path.stat()
        if not stat.S_ISREG(found.st_mode):  # to open a pipe would be to wait for its other end
            kind = "a folder" if stat.S_ISDIR(found.st_mode) else "no regular file"
            raise StudyError(f"{name}: cannot be read (it is {kind})")
        with path.open("rb") as stream:
            data = stream.read(largest + 1)
    except FileNotFoundError:
        raise StudyError(f"{name}: cannot be read (there is no such file)") from None
    except (OSError, ValueError) as error:  # a ValueError: a zero byte in the name
        why = error.strerror if isinstance(error, OSError) else error
        raise StudyError(f"{name}: cannot be read ({why})") from None
    if len(data) > largest:
        raise StudyError(f"{name}: is too large\n  allowed: at most {largest // 1000} kB")
    for marks, kind in KINDS.items():
        if data.startswith(marks):
            raise StudyError(f"{name}: cannot be read (it is {kind}, no text in UTF-8; save it so)")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        byte = data[error.start : error.start + 1].decode("cp1252", "replace")
        guess = f"perhaps Latin-1, with {byte!r}; " if byte.isprintable() else ""
        why = f"it is no text in UTF-8; {guess}save it as UTF-8"
        raise StudyError(f"{name}:{line}: cannot be read ({why})") from None
    if text.count("\0") > len(text) / 4:  # every other byte
        raise StudyError(f"{name}: cannot be read (it is UTF-16, no text in UTF-8; save it so)")
    return text
