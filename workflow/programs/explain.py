"""Say what every scene wants, what it gets and why, and which scenes share that."""

import argparse
import sys

from workflow.data import bench
from workflow.plan import explain
from workflow.plan.plan import read
from workflow.programs import add_study


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_study(parser)


def run(given: argparse.Namespace) -> int:
    """Print it."""
    plan = read(given.study, bench.refused)
    for line in plan.study.warnings:
        print(f"warning: {line}", file=sys.stderr)
    for line in explain.lines(plan):
        print(line)
    for line in bench.understood(plan.study):
        print(line)
    return 0
