# The study, its plan, and what rules depend on. No rules in this file.
#
#   in   the study file: config/config.yaml, or the one of --config study=FILE
#
# Only workflow/config.py reads a study file, so it is no configfile: and no input of a rule. What a
# job takes from it is one parameter of its rule, so a job runs again when that changes and not
# when the file is reordered, commented or touched. Sources are inputs, compared by content.
import shlex
import sys
from pathlib import Path

from workflow import run_lock
from workflow.config import load
from workflow.figure import drawn
from workflow.plan import plan
from workflow.study_error import StudyError

PYTHON = shlex.quote(sys.executable)
STUDY = config.get("study", "config/config.yaml")

try:
    PLAN = plan(load(STUDY))
except StudyError as error:
    sys.exit(str(error))  # the message and no traceback


class Label:
    """What a user calls a case, in messages: ``{LABEL:key}``. A parameter would be a reason to rerun."""

    def __format__(self, key):
        return PLAN.cases[key].label


LABEL = Label()


wildcard_constraints:
    case="[0-9a-f]{16}",
    mesh=r"[0-9a-f]{16}\.(mesh|msh)",
    figure="|".join(filter(drawn, PLAN.study.scenes)) or "none",


onstart:
    run_lock.take(Path(".snakemake/run.lock"))


def sources(*patterns, without=()):
    """Source files of some folders, except those named."""
    return sorted(
        str(path)
        for pattern in patterns
        for path in Path().glob(pattern)
        if path.name not in without
    )


def record_of(case):
    return f"results/cases/{case}.h5"


def figures():
    """Pictures of all scenes that have a figure; a scene without one is in the dataset only."""
    return [f"results/figures/{scene}.png" for scene in PLAN.study.scenes if drawn(scene)]
