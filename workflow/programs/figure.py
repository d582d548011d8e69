"""Draw the figure of a scene and write its numbers."""

import argparse
from pathlib import Path

from workflow.figures import figure
from workflow.programs import add_study, plan_of


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_study(parser)
    parser.add_argument("--scene", required=True)
    parser.add_argument("--output", type=Path, required=True, help=".png; .svg and .csv beside it")


def run(given: argparse.Namespace) -> int:
    """Draw it."""
    figure.make(plan_of(given), given.scene, given.output)
    return 0
