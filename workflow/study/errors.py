"""How the workflow says no: one exception, what and where, the value, what is allowed."""

import difflib
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from itertools import islice

LONGEST = 60  # characters of a value in a message
LISTED = 20  # names in a message
SAID = 8  # refusals in a message: one screen
ENOUGH = 100  # refusals, after which no more are looked for
COMPARED = 1000  # names among which the nearest one is looked for


class StudyError(Exception):
    """Something a user can put right: its text is a few lines and complete, no traceback needed.

    Attributes
    ----------
    line : of the file, to sort by
    place : what it is about; of several errors that say the same of one place one is enough
    """

    def __init__(self, text: str = "", line: int = 0, place: object = None) -> None:
        super().__init__(text)
        self.line, self.place = line, place


class AlreadyRefused(StudyError):
    """What this is made of was refused itself, which says enough."""


class Enough(StudyError):
    """So much was found that no more is looked for."""


class Findings:
    """What is wrong with a file, gathered so that all of it is said at once."""

    def __init__(self) -> None:
        self.found: dict[object, StudyError] = {}

    @contextmanager
    def gathering(self) -> Iterator[None]:
        """Note the error that ends such a block, and go on behind it."""
        try:
            yield
        except AlreadyRefused:
            pass
        except Enough:
            raise
        except StudyError as error:
            self.add(error)

    def no_more(self, errors: Iterable[StudyError]) -> bool:
        """Note errors; whether there are none."""
        none = True
        for error in errors:
            self.add(error)
            none = False
        return none

    def add(self, error: StudyError) -> None:
        """Note an error."""
        said = str(error)
        key = said if error.place is None else (error.place, said.partition("\n")[2])
        self.found.setdefault(key, error)
        if len(self.found) >= ENOUGH:
            raise Enough(str(self.error()))

    def say(self) -> None:
        """Raise all that was found as one error, if anything was."""
        if self.found:
            raise self.error()

    def error(self) -> StudyError:
        """All that was found, by line; of much the first of it."""
        ordered = sorted(self.found.values(), key=lambda error: error.line)
        lines = [str(error) for error in ordered[:SAID]]
        if len(ordered) > SAID:
            lines.append(f"... and {len(ordered) - SAID} more")
        return StudyError("\n".join(lines))


def shown(value: object) -> str:
    """A value as it stands in a message: quoted, on one line, not too long."""
    text = repr(value)
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 3]}..."


def printable(text: str) -> str:
    """A text as it is, or quoted if it would break a line or the terminal."""
    return text if text.isprintable() else repr(text)


def choices(value: object, allowed: Iterable[str]) -> str:
    """The allowed names, the nearest one first where one is near."""
    names = list(dict.fromkeys(allowed))
    near = difflib.get_close_matches(str(value)[:LONGEST], names[:COMPARED], n=1)
    listed = ", ".join(islice(names, LISTED)) if names else "none"
    if len(names) > LISTED:
        listed += f" and {len(names) - LISTED} more"
    return f"{listed} (nearest: {near[0]})" if near else listed
