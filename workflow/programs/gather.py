"""Write the dataset and the tables of states, failures and deviations."""

import argparse
from pathlib import Path

from geometry.files import atomic_write
from workflow.analyses import additions
from workflow.analyses.registry import ANALYSES
from workflow.data import dataset, deviation, records, reference, strain, tidy
from workflow.data.states import Table
from workflow.programs import DATASET, FAILURES, STATES, add_study, plan_of
from workflow.run import failures


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_study(parser)
    parser.add_argument("--dataset", type=Path, default=DATASET)
    parser.add_argument("--states", type=Path, default=STATES)
    parser.add_argument("--failures", type=Path, default=FAILURES)
    parser.add_argument("--deviation", type=Path, help="table of deviations from the force maps")


def run(given: argparse.Namespace) -> int:
    """Read all records of the study and write what is made of all."""
    plan = plan_of(given)
    curves = records.curves_of_study(plan)
    tables = given.failures.parent
    muscles, study = plan.study.muscles, given.study.name
    with additions.alone(given.dataset):
        groups = [name for name, each in ANALYSES.items() if each.in_dataset]
        others = additions.found(groups, tables)
        tree = dataset.build(curves, muscles, study=study, effects=True, others=others)
        dataset.write(tree, given.dataset)
    table = Table.of(curves, muscles)
    tidy.write(table, given.states)
    solved = {curve.key: curve.solution for curve in curves}
    with additions.alone(given.failures):
        strained = strain.summary(curves)
        failures.write(plan, solved, given.failures, strained, additions.failed(tables))
    if given.deviation:
        named = {name: muscle.reference for name, muscle in plan.study.muscles.items()}
        rows = deviation.table(table, reference.of_muscles(named))
        with atomic_write(given.deviation) as beside:
            rows.to_csv(beside, index=False, float_format="%.6g")
    return 0
