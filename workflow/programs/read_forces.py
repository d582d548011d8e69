"""Say what is understood of a file of measured forces: columns, units, set pressures, loops."""

import argparse
import math

from workflow.data import bench
from workflow.study.errors import StudyError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    parser.add_argument("file", help="of measured pressures, lengths or contractions, and forces")
    parser.add_argument("--length", type=float, required=True, help="of the muscle at rest [mm]")


def run(given: argparse.Namespace) -> int:
    """Print it."""
    if not 0 < given.length < math.inf:
        raise StudyError(f"--length {given.length:g}: no length of a muscle\n  allowed: > 0 (mm)")
    found = bench.read(given.file, given.length)
    if isinstance(found, bench.Bench):
        for line in found.said:
            print(line)
    else:
        print(f"{found.label}: {len(found.points)} points")
    return 0
