"""Solve the cases of a study, of a scene or of an analysis, with their meshes."""

import argparse
import sys
from pathlib import Path

from geometry.files import atomic_write
from solver.freefem import Limits
from workflow.programs.case_options import add_cases, cases_of
from workflow.run import batches


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_cases(parser)
    parser.add_argument("--batch", type=int, default=0, help="number of this batch, from 0")
    parser.add_argument("--batches", type=int, default=1, help="how many there are")
    parser.add_argument("--cores", type=int, default=1, help="cases at a time")
    parser.add_argument("--wall-time", type=float, default=3600.0, help="limit of a case [s]")
    parser.add_argument("--memory", type=float, default=4000.0, help="limit of a case [MB]")
    parser.add_argument("--log", type=Path, required=True, help="a line when a case begins or ends")
    parser.add_argument("--stamp", type=Path, required=True, help="what tells that it has ended")


def run(given: argparse.Namespace) -> int:
    """Solve what has no right record; a case that has none in the end stops no other one."""
    cases = batches.of_batch(cases_of(given), given.batch, given.batches)
    limits = Limits(wall_time=given.wall_time, memory=given.memory)
    lost = batches.solve(cases, given.cores, limits, given.log)
    if lost:
        print(f"{lost} of {len(cases)} cases have no record; the next run tries", file=sys.stderr)
    with atomic_write(given.stamp, sealed=False) as beside:
        beside.write_text(batches.stamp(cases))
    return 0
