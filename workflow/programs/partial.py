"""Gather and draw what an unfinished study has solved so far, into results/partial."""

import argparse
import shutil

from geometry.files import RESULTS, SEALS
from solver.status import CaseStatus
from workflow.data import dataset, records, tidy
from workflow.data.states import Table
from workflow.figures import figure, update
from workflow.programs import add_study, results_of, settled_plan_of
from workflow.report.explorer import page
from workflow.run import failures


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_study(parser)


def run(given: argparse.Namespace) -> int:
    """Write them; cases without a record are not_solved. Status 1 if a figure cannot be drawn."""
    plan, folder = settled_plan_of(given), results_of(given) / "partial"
    curves = records.curves_of_study(plan, partial=True)
    solutions = {curve.key: curve.solution for curve in curves}
    missing = sum(found.status is CaseStatus.NOT_SOLVED for found in solutions.values())
    muscles, study = plan.study.muscles, given.study.name
    table = Table.of(curves, muscles)
    tree = dataset.build(curves, muscles, study=study, effects=True, table=table)
    dataset.write(tree, folder / "dataset.nc")
    tidy.write(table, folder / "states.parquet")
    failures.write(plan, solutions, folder / failures.TABLE)
    page.make(plan, f"{study}, unfinished", curves, table, folder)
    print(f"{len(solutions) - missing} of {len(solutions)} cases are solved", flush=True)
    drawn, status = 0, 0
    for scene in update.scenes(plan):
        try:
            figure.make(plan, scene, folder / f"figures/{scene}.png", partial=True)
            drawn += 1
        except Exception as error:  # a figure may need what is not there yet; the others do not
            print(f"{scene} cannot be drawn yet: {type(error).__name__}: {error}")
            status = 1
    seals = SEALS / folder.relative_to(RESULTS)  # of what is written as often as wanted
    shutil.rmtree(seals, ignore_errors=True)
    print(f"{folder}: dataset.nc, states.parquet, tables/failures.csv and {drawn} figures")
    return status
