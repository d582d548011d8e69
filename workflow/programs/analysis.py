"""Write the tables and the figures of an analysis of the models."""

import argparse
from pathlib import Path

from workflow.analyses import additions, analysis
from workflow.analyses.evaluate import evaluate
from workflow.programs import DATASET, FAILURES, add_study


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_study(parser)
    parser.add_argument("--name", required=True)
    parser.add_argument("--table", type=Path, required=True, help="its own; others beside it")
    parser.add_argument("--figures", type=Path, default=Path("results/figures"), help="folder")
    parser.add_argument("--files", type=Path, help="folder; by default results/NAME")
    parser.add_argument("--dataset", type=Path, default=DATASET)
    parser.add_argument("--failures", type=Path, default=FAILURES)


def run(given: argparse.Namespace) -> int:
    """Write them, and add to a dataset and a table of failures that are there."""
    files = given.files or Path("results", given.name)
    evaluate(given.name, str(given.study), given.table, given.figures, files)
    if analysis.named(given.name).in_dataset:
        additions.add(given.name, given.table, given.dataset)
    additions.add_failures(given.failures, given.table.parent)
    return 0
