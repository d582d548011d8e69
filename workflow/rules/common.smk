# The study, its plan, and what rules depend on. No rules in this file.
#
#   in   the study file: config/config.yaml, or the one of --config study=FILE
#
# Only workflow/study/study.py reads a study file, so it is no configfile: and no input of a rule.
# What a job takes from it is one parameter of its rule, so a job runs again when that changes and not
# when the file is reordered, commented or touched. So it is with sources: the parameter is a digest of
# their contents, and no date of theirs matters.
import os
import re
import shlex
import sys
from pathlib import Path

CHECKOUT = workflow.basedir
sys.path.insert(0, CHECKOUT)

from geometry.files import seal_of
from solver import sources
from solver.case import digest
from workflow.analyses import analysis
from workflow.analyses.registry import ANALYSES
from workflow.data import bench
from workflow.figures import update
from workflow.plan.plan import read
from workflow.run import batches
from workflow.study import folders
from workflow.study.errors import StudyError
from workflow.study.schema import SHEET
from workflow.study.study import given_settings

# Programs are those of this checkout, from whatever folder they are run (and whatever that folder
# has of the same name). They run with the Python of Snakemake itself, whether or not its environment
# is activated, and on one core each; a batch has one process for every core that it is given. They
# open no window, and lock no file of HDF5, which are whole or absent.
PROGRAMS = shlex.quote(str(Path(sys.executable).parent))
SETTINGS = f"PATH={PROGRAMS}:$PATH PYTHONPATH={shlex.quote(CHECKOUT)} PYTHONSAFEPATH=1"
SETTINGS += " OPENBLAS_NUM_THREADS=1 MPLBACKEND=agg HDF5_USE_FILE_LOCKING=FALSE"
shell.prefix(f"set -euo pipefail; export {SETTINGS}; ")

try:
    STUDY, BATCHES = given_settings(config)
    folders.check_owner(STUDY)
    PLAN = read(STUDY, bench.refused)
except StudyError as error:
    sys.exit(str(error))  # the message and no traceback
for line in PLAN.study.warnings:
    print(f"warning: {line}", file=sys.stderr)

RESULTS = folders.of_study(STUDY)  # its dataset, tables, figures; records are those of all studies
DRAWN = update.scenes(PLAN)


wildcard_constraints:
    asked="study|(scene|analysis)-[^/]+",
    batch="[0-9]+",
    muscle="|".join(map(re.escape, PLAN.shown)) or "none",
    figure="|".join(map(re.escape, DRAWN)) or "none",


def code(*modules):
    """Digest of the sources of some modules. Ask late: parsing all of them takes half a second."""
    return sources.digest(tuple(sources.sources(*modules)))


def cases_of_analysis(name):
    """Cases of an analysis by key; making them takes a second, so not before it is asked for."""
    return {asked.key: asked for asked in analysis.cases(name, STUDY)}


def cases_asked(asked):
    """Cases by key: of ``study``, of ``scene-NAME``, of ``analysis-NAME``."""
    kind, _, name = asked.partition("-")
    if kind == "analysis":
        return cases_of_analysis(name)
    return PLAN.cases_of(name) if kind == "scene" else PLAN.cases


def cases_of_batch(wildcards):
    return batches.of_batch(cases_asked(wildcards.asked), int(wildcards.batch), BATCHES)


def cores_of_batch(_):
    """All that there are; in a job of a cluster those that it was given of its node's."""
    given = os.environ.get("SLURM_CPUS_PER_TASK") if workflow.remote_exec else None
    return int(given or workflow.cores or 1)


def solved(asked):
    """What tells that cases are solved: a file for each of their batches."""
    numbers = batches.numbers(cases_asked(asked), BATCHES)
    return [f"{RESULTS}/solved/{asked}/{number}of{BATCHES}.txt" for number in numbers]


def deviations():
    """The table of deviations, where a force map is of a muscle with isobaric curves."""
    isobaric = {p.muscle for s in PLAN.scenes.values() for p in s if p.group == "isobaric"}
    measured = any(PLAN.study.muscles[muscle].reference for muscle in isobaric)
    return [f"{RESULTS}/tables/deviation.csv"] if measured else []


def program_option(asked):
    """Which cases, as the program is told."""
    kind, _, name = asked.partition("-")
    return {"study": [], "scene": ["--scene", name], "analysis": ["--name", name]}[kind]


class Batch:
    """The cases that a job will solve, in messages: ``{BATCH:study 0}``."""

    def __format__(self, text):
        asked, _, batch = text.rpartition(" ")
        cases = batches.of_batch(cases_asked(asked), int(batch), BATCHES)
        return batches.described(cases)


BATCH = Batch()


class Figures:
    """Those that will be drawn, in a message."""

    def __format__(self, _):
        found = [scene for scene in DRAWN if will_be_drawn(scene)]
        return ", ".join(found) or "nothing: all figures are there"


def will_be_drawn(scene):
    cases = PLAN.cases_of(scene)
    return update.why_drawn(PLAN, scene, RESULTS) or batches.to_solve(cases)


FIGURES = Figures()


def sheets():
    """Pages of all scenes that ask for sheets."""
    asking = [name for name, asked in PLAN.study.scenes.items() if SHEET in asked.quantities]
    return [f"{RESULTS}/sheets/{scene}.html" for scene in asking]


def design_digest(wildcards):
    """Digest of what a design takes from the study."""
    asked = PLAN.study.design[wildcards.design]
    bases = sorted({asked.base, *(asked.free.muscle or ())})
    made_of = [(name, PLAN.study.muscles[name]) for name in bases]
    return digest(repr((asked, made_of, sorted(PLAN.study.rubbers.items()))))


def maps_of_pair(wildcards):
    """Maps of the two muscles of a pair."""
    asked = PLAN.study.pairs[wildcards.pair]
    names = dict.fromkeys((asked.agonist, asked.antagonist or asked.agonist))
    return [f"{RESULTS}/maps/{name}.nc" for name in names]


def map_digest(wildcards):
    """Digest of what a map takes from the study."""
    asked = PLAN.study.maps[wildcards.map]
    made_of = PLAN.study.muscles[asked.muscle], PLAN.study.variants[asked.variant]
    return digest(repr((asked, made_of)))


def added_to(page):
    """What is added to the table of a page when analyses end, so that the page comes after that."""
    if page != "failures":
        return []
    fitting = [each for each in ANALYSES.values() if each.fits(PLAN.study) and each.solves_cases]
    return [f"{RESULTS}/tables/{each.failures}" for each in fitting if not each.takes_hours]


def reported(page):
    """A page that is there, as the report has it."""
    return report(
        f"{RESULTS}/report/{page.name}.html",
        caption=os.path.relpath(page.caption, CHECKOUT),
        category=page.chapter,
        labels={"page": page.title},
    )


def explored():
    """The explorer, as the report has it, if it is there."""
    file = f"{RESULTS}/explorer.html"
    if not Path(file).exists():
        return []
    words = "workflow/report/explorer.rst"
    return [report(file, caption=words, category="0 Explorer", labels={"page": "All curves"})]
