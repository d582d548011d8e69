"""Measure what the analysis of accuracy costs on this machine."""

import argparse

from workflow.analyses.accuracy import benchmark
from workflow.analyses.accuracy.costs import BENCHMARK
from workflow.programs import add_study, results_of


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_study(parser)
    parser.add_argument("--runs", type=int, default=3, help="of every case; medians are taken")


def run(given: argparse.Namespace) -> int:
    """Measure it."""
    table = results_of(given) / "tables" / "benchmark.csv"
    benchmark.make(given.study, given.runs, BENCHMARK, table)
    return 0
