"""How the workflow says no: one exception, what and where, the value, what is allowed."""

import difflib
from collections.abc import Iterable

LONGEST = 60  # characters of a value in a message


class StudyError(Exception):
    """Something a user can put right: its text is a few lines and complete, no traceback needed."""


def shown(value: object) -> str:
    """A value as it stands in a message: quoted, on one line, not too long."""
    text = repr(value)
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 3]}..."


def choices(value: object, allowed: Iterable[str]) -> str:
    """The allowed names, the nearest one first where one is near."""
    names = list(allowed)
    near = difflib.get_close_matches(str(value), names, n=1)
    listed = ", ".join(names) if names else "none"
    return f"{listed} (nearest: {near[0]})" if near else listed
