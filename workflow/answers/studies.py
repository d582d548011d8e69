"""The study in which a muscle is looked for: that of a file, with what the library has."""

import re
from pathlib import Path

from workflow.study import library
from workflow.study.contents import Study
from workflow.study.errors import StudyError, choices
from workflow.study.folders import DEFAULT
from workflow.study.study import load, load_library


def with_muscle(study: Path | str, muscle: str) -> Study:
    """The study of a file, with a muscle of the library where the file has none of that name.

    Without a study file where it stands by default, the library alone.

    Raises
    ------
    StudyError
        If there is no such muscle, or the file is wrong.
    """
    if str(study) == str(DEFAULT) and not Path(study).exists():
        found, where = load_library(), "library"
    else:
        found, where = load(study, also=[muscle]), f"{study} or the library"
    if muscle not in found.muscles:
        if re.match(r"[-+]?\d", muscle) and re.search(r"[^\w.-]|[a-zA-Z]$", muscle):
            raise StudyError(f"{muscle}: the name of a muscle goes first\n  as dmsp20 {muscle}")
        allowed = choices(muscle, [*found.muscles, *library.names("muscles")])
        raise StudyError(f"{muscle}: no such muscle in {where}\n  allowed: {allowed}")
    return found
