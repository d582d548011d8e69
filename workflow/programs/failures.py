"""List what failed; status 1 if anything did."""

import argparse
import sys
from pathlib import Path

from workflow.programs import FAILURES
from workflow.run import failures
from workflow.study.errors import StudyError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    parser.add_argument("--table", type=Path, default=FAILURES)


def run(given: argparse.Namespace) -> int:
    """Print it."""
    if not given.table.exists():
        raise StudyError(f"{given.table}: there is no such table; run snakemake")
    text, failed = failures.report(given.table)
    if text:
        print(text, file=sys.stderr if failed else sys.stdout)
    return 1 if failed else 0
