"""Write what the planner knows of effects, from the solved analysis of effects."""

import argparse

from workflow.analyses.effects import weigh
from workflow.plan import effect_costs
from workflow.programs import add_study


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_study(parser)


def run(given: argparse.Namespace) -> int:
    """Write it."""
    weigh.measure(str(given.study))
    print(f"written: {effect_costs.FILE.name}, {effect_costs.origin()}")
    return 0
