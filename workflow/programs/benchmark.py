"""Measure what the analysis of accuracy costs on this machine."""

import argparse
from pathlib import Path

from workflow.analyses.accuracy import benchmark
from workflow.programs import add_study


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_study(parser)
    parser.add_argument("--runs", type=int, default=3, help="of every case; medians are taken")
    parser.add_argument("--costs", type=Path, default=Path("results/cost.csv"))
    parser.add_argument("--table", type=Path, default=Path("results/tables/benchmark.csv"))


def run(given: argparse.Namespace) -> int:
    """Measure it."""
    benchmark.make(given.study, given.runs, given.costs, given.table)
    return 0
