"""Take over what guesses are made of, from the analysis of the ladder or of effects."""

import argparse

from workflow.analyses.ladder import take_over as of_ladder
from workflow.analyses.like_effects import take_over as of_effects
from workflow.plan import like_effects, like_muscles
from workflow.programs import add_study, results_of


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_study(parser)
    told = "what effects are worth, by the analysis like_effects; else errors of rungs, by ladder"
    parser.add_argument("--effects", action="store_true", help=told)


def run(given: argparse.Namespace) -> int:
    """Write it to the planner's tables."""
    tables = results_of(given) / "tables"
    if given.effects:
        of_effects.take_over(tables)
        print(f"written: {like_effects.FILE.name}, {like_effects.origin()}")
        return 0
    of_ladder.take_over(tables)
    print(f"written: {like_muscles.CURVES.name}, {like_muscles.origin()}")
    return 0
