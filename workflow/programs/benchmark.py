"""Measure where the time of a run goes on this machine, and what accuracy costs."""

import argparse
import os

from workflow.analyses.accuracy import benchmark
from workflow.analyses.accuracy.costs import BENCHMARK
from workflow.programs import add_study, results_of
from workflow.run import times


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_study(parser)
    parser.add_argument("--cores", type=int, default=os.cpu_count(), help="of the whole runs")
    parser.add_argument("--muscles", type=int, default=1000, help="of the study of one sweep")
    parser.add_argument("--runs", type=int, default=3, help="of every case; medians are taken")


def run(given: argparse.Namespace) -> int:
    """Measure it."""
    results = results_of(given)
    table = results / "tables" / "benchmark.csv"
    benchmark.make(given.study, given.runs, BENCHMARK, table)
    times.make(given.study, given.cores, given.muscles, results / "tables" / "times.csv", print)
    return 0
