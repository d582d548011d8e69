"""Write what the planner knows of effects, from the solved analysis of effects."""

import argparse

from workflow.analyses.effects import weigh
from workflow.plan import effect_costs, effect_states
from workflow.programs import add_study


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_study(parser)


def run(given: argparse.Namespace) -> int:
    """Write it."""
    weigh.measure(str(given.study))
    names = f"{effect_costs.FILE.name} and {effect_states.FILE.name}"
    print(f"written: {names}, {effect_costs.origin()}")
    return 0
