"""The programs of the workflow, one module each: ``python -m workflow NAME``.

A module has a docstring that says what it does, ``add_arguments(parser)`` and ``run(given)``, which
returns the exit status. Rules call some of them, people the others; its imports are what a job of
such a rule depends on (solver/sources.py).
"""

import argparse
from pathlib import Path

from workflow.plan.plan import Plan, read

STUDY = Path("config/config.yaml")
DATASET = Path("results/dataset.nc")
STATES = Path("results/states.parquet")
FAILURES = Path("results/tables/failures.csv")


def add_study(parser: argparse.ArgumentParser) -> None:
    """The option that names the study file."""
    parser.add_argument("--study", type=Path, default=STUDY, help=f"file, by default {STUDY}")


def plan_of(given: argparse.Namespace) -> Plan:
    """The plan of the study file that was given."""
    return read(given.study)
