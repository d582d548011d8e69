"""List the cases: key, status of the record, label."""

import argparse

from workflow.data import records
from workflow.programs.case_options import add_cases, cases_of


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_cases(parser)


def run(given: argparse.Namespace) -> int:
    """Print them."""
    for key, case in cases_of(given).items():
        print(f"{key}  {records.status(key, case.label):13}  {case.label}")
    return 0
