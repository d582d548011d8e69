"""Measure where the time of a run goes on this machine, what accuracy and steps of time cost."""

import argparse
import os
from pathlib import Path

from solver.sources import ROOT
from workflow.analyses import analysis
from workflow.analyses.accuracy import benchmark
from workflow.analyses.accuracy.analysis import BENCHMARK
from workflow.analyses.time import benchmark as steps_of_time
from workflow.plan.plan import plan
from workflow.programs import add_study, results_of
from workflow.run import times
from workflow.study.contents import Study
from workflow.study.errors import StudyError
from workflow.study.folders import DEFAULT
from workflow.study.study import load


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_study(parser)
    parser.add_argument("--cores", type=int, default=os.cpu_count(), help="of the whole runs")
    parser.add_argument("--muscles", type=int, default=1000, help="of the study of one sweep")
    parser.add_argument("--runs", type=int, default=3, help="of a curve, if it takes no minutes")


def run(given: argparse.Namespace) -> int:
    """Measure it; whole runs come first, as most ask for those.

    Raises
    ------
    StudyError
        If there is nothing to measure.
    """
    for name in ("cores", "muscles", "runs"):
        if getattr(given, name) < 1:
            raise StudyError(f"--{name} {getattr(given, name)} is refused\n  allowed: 1 or more")
    tables, say = results_of(given) / "tables", benchmark.say
    study = load(given.study)
    papers_file = _papers(given.study, study)
    papers, curves = load(papers_file), benchmark.chosen(papers_file)
    whole = sum(benchmark.expected_seconds(each.case) for each in plan(study).cases.values())
    seconds = times.expected_seconds(whole, given.cores, given.muscles)
    seconds += benchmark.expected_of_all(curves, given.runs)
    seconds += given.runs * (steps_of_time.EXPECTED + benchmark.EXPECTED_OF_SOLID)
    say(f"all of it takes about {benchmark.duration(seconds * benchmark.slowness(curves))}\n")
    solid = benchmark.of_solid(papers, given.runs)
    times.make(
        given.study,
        given.cores,
        given.muscles,
        solid,
        tables / "times.csv",
        benchmark.machine("one run of each study, the least of several of the solid"),
        print,
    )
    benchmark.make(curves, given.runs, BENCHMARK, tables / "benchmark.csv")
    steps_of_time.make(papers, given.runs, tables / "time_steps.csv", print)
    return 0


def _papers(file: Path, study: Study) -> Path:
    """A study with the muscles that curves are measured on: this one, else the default one."""
    named = analysis.named("accuracy").muscles
    return file if all(name in study.muscles for name in named) else ROOT / DEFAULT
