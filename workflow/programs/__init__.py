"""The programs of the workflow, one module each: ``muscle NAME``.

A module has a docstring that says what it does, ``add_arguments(parser)`` and ``run(given)``, which
returns the exit status. Rules call some of them, people the others; its imports are what a job of
such a rule depends on (solver/sources.py).
"""

import argparse
from collections.abc import Collection
from pathlib import Path

from workflow.data.settled import settled
from workflow.plan.plan import Plan, read
from workflow.study.errors import StudyError, choices
from workflow.study.folders import DEFAULT, check_owner, of_study


def add_study(parser: argparse.ArgumentParser) -> None:
    """The option that names the study file."""
    parser.add_argument("--study", type=Path, default=DEFAULT, help=f"file, by default {DEFAULT}")


def results_of(given: argparse.Namespace) -> Path:
    """The folder of the results of the study file that was given."""
    check_owner(given.study)
    return of_study(given.study)


def add_entries(parser: argparse.ArgumentParser, what: str, folder: str) -> None:
    """Names of entries of a section of the study file, and where what is made of them goes."""
    parser.add_argument("names", nargs="*", help=f"{what}s of the study file; by default all")
    parser.add_argument("--folder", type=Path, help=f"by default {folder} in the study's results")
    add_study(parser)


def entries(given: argparse.Namespace, there: Collection[str], what: str) -> list[str]:
    """The names of those that are meant.

    Raises
    ------
    StudyError
        If the study file has no such entry, or none at all.
    """
    if not there:
        raise StudyError(f"{given.study}: there is no {what} in it")
    for name in given.names:
        if name not in there:
            raise StudyError(f"{name}: no such {what}\n  allowed: {choices(name, there)}")
    return given.names or list(there)


def plan_of(given: argparse.Namespace) -> Plan:
    """The plan of the study file that was given."""
    return read(given.study)


def settled_plan_of(given: argparse.Namespace) -> Plan:
    """The same where climbs have ended: the cases that they have come to in their place."""
    return settled(plan_of(given))
