"""List what failed; status 1 if anything did."""

import argparse
import sys

from workflow.programs import add_study, results_of
from workflow.run import failures
from workflow.study.errors import StudyError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_study(parser)


def run(given: argparse.Namespace) -> int:
    """Print it."""
    table = results_of(given) / failures.TABLE
    if not table.exists():
        raise StudyError(f"{table}: there is no such table; run snakemake")
    text, failed = failures.report(table)
    if text:
        print(text, file=sys.stderr if failed else sys.stdout)
    return 1 if failed else 0
