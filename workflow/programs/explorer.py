"""Write the page in which all curves of a study can be looked at, with the claims judged so far."""

import argparse

from workflow.data import records
from workflow.data.states import Table
from workflow.programs import add_study, plan_of, results_of
from workflow.report.explorer import page


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_study(parser)


def run(given: argparse.Namespace) -> int:
    """Write it, of the records that there are."""
    plan = plan_of(given)
    results = results_of(given)
    curves = records.curves_of_study(plan, partial=True)
    table = Table.of(curves, plan.study.muscles)
    page.make(plan, given.study.name, curves, table, results)
    print(results / page.FILE)
    return 0
