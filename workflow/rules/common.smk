# The study, its plan, and what rules depend on. No rules in this file.
#
#   in   the study file: config/config.yaml, or the one of --config study=FILE
#
# Only workflow/config.py reads a study file, so it is no configfile: and no input of a rule. What a
# job takes from it is one parameter of its rule, so a job runs again when that changes and not
# when the file is reordered, commented or touched. Sources are inputs, compared by content.
import re
import shlex
import sys
from pathlib import Path

from workflow import run_lock
from workflow.config import load
from workflow.figure import drawn
from workflow.plan import plan
from workflow.study_error import StudyError

# Programs run with the Python of Snakemake itself, whether or not its environment is activated.
PROGRAMS = shlex.quote(str(Path(sys.executable).parent))
shell.prefix(f"set -euo pipefail; export PATH={PROGRAMS}:$PATH; ")

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
    muscle="|".join(map(re.escape, PLAN.shown)) or "none",
    figure="|".join(map(re.escape, filter(drawn, PLAN.study.scenes))) or "none",


onstart:
    run_lock.take(Path(".snakemake/run.lock"))


def sources(*patterns, without=()):
    """Source files of some folders, except those named."""
    found = {str(path) for pattern in patterns for path in Path().glob(pattern)}
    return sorted(found.difference(without))


def record_of(case):
    return f"results/cases/{case}.h5"


def mesh_sources(wildcards):
    """All of geometry/ but what makes other kinds of files."""
    other = "section" if wildcards.mesh.endswith(".mesh") else "meridian"
    return sources("geometry/*.py", without=["geometry/whole.py", f"geometry/{other}.py"])


def mesh_of(wildcards):
    mesh = PLAN.cases[wildcards.case].mesh
    return f"results/meshes/{mesh}" if mesh else []


# Of all sources of the solver, those that only one model reads.
MODEL_SOURCES = {
    "geometric": sources("solver/geometric.py"),
    "cylinder": sources("solver/cylinder.py"),
    "membrane": sources("solver/edp/membrane*"),
    "solid": sources("solver/edp/solid*", "solver/edp/ends_*"),
}


def solver_sources(wildcards):
    """Sources that decide the result of a case; what geometry makes of it is in its mesh."""
    case = PLAN.cases[wildcards.case]
    edp = ["solver/edp/*.edp", "solver/edp/*.idp"] if case.mesh else []
    others = [
        f for model, files in MODEL_SOURCES.items() if model != case.case.model for f in files
    ]
    return sources("solver/*.py", "geometry/muscle.py", "geometry/refusal.py", *edp, without=others)


def figures():
    """Pictures of all scenes that have a figure; a scene without one is in the dataset only."""
    return [f"results/figures/{scene}.png" for scene in PLAN.study.scenes if drawn(scene)]


def records_of_scene(wildcards):
    return [record_of(case) for case in sorted(set(PLAN.scenes.get(wildcards.figure, {}).values()))]


def figure_sources(wildcards):
    """A figure's own module, what all figures share, and what reads the records."""
    own = f"workflow/figures/{wildcards.figure}.py"
    others = [file for file in sources("workflow/figures/fig*.py") if file != own]
    shown = [] if wildcards.figure in PLAN.scenes else ["geometry/*.py"]
    return sources("workflow/figures/*.py", "workflow/*.py", *shown, without=others)
