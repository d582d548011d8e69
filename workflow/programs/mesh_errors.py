"""Take over the errors of meshes that the analysis of accuracy has found."""

import argparse

from workflow.analyses.accuracy.take_over import take_over
from workflow.programs import add_study, results_of


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_study(parser)


def run(given: argparse.Namespace) -> int:
    """Write them to the planner's table."""
    take_over(results_of(given) / "tables" / "accuracy.csv")
    return 0
