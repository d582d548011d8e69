"""Write the fields of a recorded state for ParaView."""

import argparse
from pathlib import Path

from workflow.data import paraview


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    parser.add_argument("--record", type=Path, required=True)
    parser.add_argument("--state", type=int, required=True, help="number of the stop, from 0")
    parser.add_argument("--output", type=Path, required=True, help=".vtu")


def run(given: argparse.Namespace) -> int:
    """Write them."""
    paraview.write(given.record, given.state, given.output)
    return 0
