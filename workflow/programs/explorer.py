"""Write the page in which all curves of a study can be looked at."""

import argparse
from pathlib import Path

from workflow.data import records, reference
from workflow.data.states import Table
from workflow.programs import FAILURES, add_study, plan_of
from workflow.report.explorer import content, page


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_study(parser)
    parser.add_argument("--tables", type=Path, default=FAILURES.parent, help="folder of tables")
    parser.add_argument("--output", type=Path, required=True, help=".html")


def run(given: argparse.Namespace) -> int:
    """Write it."""
    plan = plan_of(given)
    curves = records.curves_of_study(plan)
    muscles = plan.study.muscles
    maps = reference.of_muscles({name: muscle.reference for name, muscle in muscles.items()})
    title = f"Pneumatic muscles: {given.study.stem}"
    shown = content.content(title, curves, Table.of(curves, muscles), maps, given.tables)
    page.write(given.output, shown)
    return 0
