"""The text of a file that a user names: whatever stands there, an answer in bounded time."""

import stat
from pathlib import Path

from workflow.study.errors import StudyError, printable

LARGEST = 1_000_000  # bytes; a study of a thousand muscles has a tenth of that


def text_of(path: Path) -> str:
    """The text of a regular file in UTF-8.

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
            data = stream.read(LARGEST + 1)
    except FileNotFoundError:
        raise StudyError(f"{name}: cannot be read (there is no such file)") from None
    except (OSError, ValueError) as error:  # a ValueError: a zero byte in the name
        why = error.strerror if isinstance(error, OSError) else error
        raise StudyError(f"{name}: cannot be read ({why})") from None
    if len(data) > LARGEST:
        raise StudyError(f"{name}: is too large\n  allowed: at most {LARGEST // 1000} kB")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise StudyError(f"{name}:{line}: cannot be read (it is no text in UTF-8)") from None
