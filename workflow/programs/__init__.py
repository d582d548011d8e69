"""The programs of the workflow, one module each: ``python -m workflow NAME``.

A module has a docstring that says what it does, ``add_arguments(parser)`` and ``run(given)``, which
returns the exit status. Rules call some of them, people the others; its imports are what a job of
such a rule depends on (solver/sources.py).
"""

import argparse
from pathlib import Path

from workflow.plan.plan import Plan, read
from workflow.study.folders import DEFAULT, check_owner, of_study


def add_study(parser: argparse.ArgumentParser) -> None:
    """The option that names the study file."""
    parser.add_argument("--study", type=Path, default=DEFAULT, help=f"file, by default {DEFAULT}")


def results_of(given: argparse.Namespace) -> Path:
    """The folder of the results of the study file that was given."""
    check_owner(given.study)
    return of_study(given.study)


def plan_of(given: argparse.Namespace) -> Plan:
    """The plan of the study file that was given."""
    return read(given.study)
