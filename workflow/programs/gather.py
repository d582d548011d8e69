"""Write the dataset, the tables of states, failures and deviations, and the explorer."""

import argparse

from geometry.files import atomic_write
from workflow.analyses import additions
from workflow.analyses.registry import ANALYSES
from workflow.data import bench, dataset, deviation, records, strain, tidy
from workflow.data.states import Table
from workflow.programs import add_study, results_of, settled_plan_of
from workflow.report.explorer import page
from workflow.run import failures


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_study(parser)
    parser.add_argument(
        "--deviation", action="store_true", help="a table of deviations from the force maps as well"
    )


def run(given: argparse.Namespace) -> int:
    """Read all records of the study and write what is made of all."""
    plan = settled_plan_of(given)
    curves = records.curves_of_study(plan)
    results = results_of(given)
    tables = results / "tables"
    muscles, study = plan.study.muscles, given.study.name
    table = Table.of(curves, muscles)
    with additions.alone(results):
        groups = [name for name, each in ANALYSES.items() if each.in_dataset]
        others = additions.found(groups, tables)
        tree = dataset.build(curves, muscles, study=study, effects=True, others=others, table=table)
        dataset.write(tree, results / dataset.FILE)
    tidy.write(table, results / tidy.FILE)
    solved = {curve.key: curve.solution for curve in curves}
    with additions.alone(tables):
        strained = strain.summary(curves)
        failed = additions.failed(tables)
        failures.write(plan, solved, results / failures.TABLE, strained, failed)
    if given.deviation:
        rows = deviation.table(table, bench.of_muscles(muscles))
        with atomic_write(tables / "deviation.csv") as beside:
            rows.to_csv(beside, index=False, float_format="%.6g")
    with additions.alone(tables):
        page.make(plan, study, curves, table, results)
    return 0
