"""Write the tables and the figures of an analysis of the models."""

import argparse

from workflow.analyses import additions, analysis
from workflow.analyses.evaluate import evaluate
from workflow.programs import add_study, explorer, results_of
from workflow.report.explorer import page


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_study(parser)
    parser.add_argument("--name", required=True)


def run(given: argparse.Namespace) -> int:
    """Write them, and add to a dataset, a table of failures and an explorer that are there."""
    results = results_of(given)
    evaluate(given.name, str(given.study), results)
    if analysis.named(given.name).in_dataset:
        additions.add(given.name, results)
    additions.add_failures(results)
    if analysis.named(given.name).on_figures and (results / page.FILE).exists():
        with additions.alone(results / "tables"), additions.same_time(results / page.FILE):
            explorer.run(given)
    return 0
