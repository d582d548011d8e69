"""Take over what guesses of errors are made of, from the analysis of the ladder."""

import argparse

from workflow.analyses.ladder.take_over import take_over
from workflow.plan import like_muscles
from workflow.programs import add_study, results_of


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_study(parser)


def run(given: argparse.Namespace) -> int:
    """Write it to the planner's tables."""
    take_over(results_of(given) / "tables")
    print(f"written: {like_muscles.CURVES.name}, {like_muscles.origin()}")
    return 0
