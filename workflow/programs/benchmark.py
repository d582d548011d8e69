"""Measure where the time of a run goes on this machine, what accuracy and steps of time cost."""

import argparse
import os

from workflow.analyses.accuracy import benchmark
from workflow.analyses.accuracy.costs import BENCHMARK
from workflow.analyses.time import benchmark as steps_of_time
from workflow.programs import add_study, results_of
from workflow.run import times
from workflow.study.study import load


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_study(parser)
    parser.add_argument("--cores", type=int, default=os.cpu_count(), help="of the whole runs")
    parser.add_argument("--muscles", type=int, default=1000, help="of the study of one sweep")
    parser.add_argument("--runs", type=int, default=3, help="of every case")


def run(given: argparse.Namespace) -> int:
    """Measure it."""
    tables = results_of(given) / "tables"
    benchmark.make(given.study, given.runs, BENCHMARK, tables / "benchmark.csv")
    study = load(given.study)
    steps_of_time.make(study, given.runs, tables / "time_steps.csv", print)
    solid = benchmark.of_solid(study, given.runs)
    times.make(given.study, given.cores, given.muscles, solid, tables / "times.csv", print)
    return 0
