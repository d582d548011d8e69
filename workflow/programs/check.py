"""Compare every byte of all results with what was written."""

import argparse

from workflow.run import damage


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    parser.add_argument("--delete", action="store_true", help="what is not as it was written")


def run(given: argparse.Namespace) -> int:
    """Name what has changed; status 1 if anything has."""
    return 0 if damage.report(given.delete) else 1
