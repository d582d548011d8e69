"""Say what every scene wants, what it gets and why, and what the next run will do for it."""

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

from workflow.data import bench, records, settled
from workflow.figures import update
from workflow.plan import explain
from workflow.plan.plan import Plan, read
from workflow.programs import add_study, results_of
from workflow.run import batches


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_study(parser)


def run(given: argparse.Namespace) -> int:
    """Print it."""
    plan = read(given.study, bench.refused)
    for line in plan.study.warnings:
        print(f"warning: {line}", file=sys.stderr)
    for line in explain.lines(plan, settled.outcome, records.found):
        print(line)
    for line in bench.understood(plan.study):
        print(line)
    print("\nthe next run")
    for line in next_run(plan, results_of(given)):
        print(f"  {line}")
    return 0


def next_run(plan: Plan, results: Path) -> Iterator[str]:
    """What it will solve, mesh and draw, and why; one line if nothing."""
    solved = batches.to_solve(plan.cases)
    meshed = {case.mesh: (batches.why_meshed(case), case.label) for case in plan.cases.values()}
    yield f"solves {len(solved)} of {len(plan.cases)} cases"
    for key, why in solved.items():
        yield f"solve  {plan.cases[key].label}: {why}"
    for why, label in meshed.values():
        if why:
            yield f"mesh   {label}: {why}"
    for scene in update.scenes(plan):
        if why := update.why_drawn(plan, scene, results):
            yield f"draw   {scene}: {why}"
        elif solved.keys() & plan.cases_of(scene).keys():
            yield f"draw   {scene}: its cases are solved"
