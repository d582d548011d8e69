"""Take over the errors of meshes that the analysis of accuracy has found."""

import argparse
from pathlib import Path

from workflow.analyses.accuracy.take_over import take_over


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    parser.add_argument("--table", type=Path, default=Path("results/tables/accuracy.csv"))


def run(given: argparse.Namespace) -> int:
    """Write them to the planner's table."""
    take_over(given.table)
    return 0
