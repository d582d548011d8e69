# The study, its plan, and what rules depend on. No rules in this file.
#
#   in   the study file: config/config.yaml, or the one of --config study=FILE
#
# Only workflow/study/study.py reads a study file, so it is no configfile: and no input of a rule.
# What a job takes from it is one parameter of its rule, so a job runs again when that changes and not
# when the file is reordered, commented or touched. Sources are inputs, compared by content.
import json
import os
import re
import shlex
import sys
from pathlib import Path

CHECKOUT = workflow.basedir
sys.path.insert(0, CHECKOUT)

from solver import sources as closure
from solver.case import digest
from solver.record import code_digest
from workflow.analyses import analysis
from workflow.analyses.registry import ANALYSES
from workflow.data import bench, paraview
from workflow.plan.plan import read
from workflow.study.errors import StudyError
from workflow.study.figure_needs import drawn
from workflow.study.schema import FORCE_MAPS
from workflow.study.study import study_file

# Programs are those of this checkout, from whatever folder they are run (and whatever that folder
# has of the same name). They run with the Python of Snakemake itself, whether or not its environment
# is activated, and on one core each: there are as many at a time as there are cores.
PROGRAMS = shlex.quote(str(Path(sys.executable).parent))
SETTINGS = f"PATH={PROGRAMS}:$PATH PYTHONPATH={shlex.quote(CHECKOUT)} PYTHONSAFEPATH=1"
shell.prefix(f"set -euo pipefail; export {SETTINGS} OPENBLAS_NUM_THREADS=1; ")

try:
    STUDY = study_file(config)
    PLAN = read(STUDY, bench.refused)
except StudyError as error:
    sys.exit(str(error))  # the message and no traceback
for line in PLAN.study.warnings:
    print(f"warning: {line}", file=sys.stderr)


FIELD_FILES = paraview.files(PLAN)


class Label:
    """What a user calls a case, in messages: ``{LABEL:key}``. A parameter would be a reason to rerun."""

    def __format__(self, key):
        return case_of(key).label


LABEL = Label()


wildcard_constraints:
    case="[0-9a-f]{16}",
    file=r"[^/]+\.vtu",
    mesh=r"[0-9a-f]{16}\.(mesh|msh)",
    muscle="|".join(map(re.escape, PLAN.shown)) or "none",
    figure="|".join(map(re.escape, filter(drawn, PLAN.study.scenes))) or "none",


def of_checkout(file):
    """A file of this checkout, from the folder of the run."""
    return os.path.relpath(os.path.join(CHECKOUT, file))


def sources(*modules):
    """What some modules are made of. Ask late: parsing all of them takes half a second."""
    return [of_checkout(file) for file in closure.sources(*modules)]


def record_of(case):
    return f"results/cases/{case}.h5"


def mesh_sources(wildcards):
    """Sources of a kind of mesh."""
    kind = json.loads(spec_of_mesh(wildcards))["kind"]
    return [of_checkout(file) for file in closure.of_mesh(kind)]


ANALYSED = {}  # cases of the analyses that are asked for, by key


def cases_of_analysis(name):
    """Cases of an analysis by key; making them takes a second, so not before it is asked for."""
    found = {asked.case.key: asked for asked in analysis.cases(name, STUDY)}
    ANALYSED.update(found)
    return found


def case_of(key):
    """A case of the scenes or of an analysis."""
    if key not in PLAN.cases and key not in ANALYSED:
        for name, each in ANALYSES.items():
            if each.fits(PLAN.study):
                cases_of_analysis(name)
    return PLAN.cases.get(key) or ANALYSED[key]


def mesh_of(wildcards):
    mesh = case_of(wildcards.case).mesh
    return f"results/meshes/{mesh}" if mesh else []


def spec_of_mesh(wildcards):
    if wildcards.mesh in PLAN.meshes:
        return PLAN.meshes[wildcards.mesh]
    return next(a for a in ANALYSED.values() if a.mesh == wildcards.mesh).case.mesh_spec()


def solver_sources(wildcards):
    """Sources that decide the result of a case."""
    case = case_of(wildcards.case).case
    return [of_checkout(file) for file in closure.of_solve(case.model, case.rubber.law())]


def code_of(wildcards):
    """Their digest."""
    case = case_of(wildcards.case).case
    return code_digest(case.model, law=case.rubber.law())


def figures():
    """Pictures of all scenes that have a figure; a scene without one is in the dataset only."""
    return [f"results/figures/{scene}.png" for scene in PLAN.study.scenes if drawn(scene)]


def records_of_scene(wildcards):
    return [record_of(case) for case in sorted(set(PLAN.scenes.get(wildcards.figure, {}).values()))]


def deviations():
    """The table of deviations, where a force map is of a muscle with isobaric curves."""
    isobaric = {p.muscle for s in PLAN.scenes.values() for p in s if p.group == "isobaric"}
    measured = any(PLAN.study.muscles[muscle].reference for muscle in isobaric)
    return ["results/tables/deviation.csv"] if measured else []
