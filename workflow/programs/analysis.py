"""Write the table and the figures of an analysis of the models."""

import argparse
from pathlib import Path

from workflow.analyses import dataset_groups
from workflow.analyses.evaluate import evaluate
from workflow.programs import DATASET, add_study


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_study(parser)
    parser.add_argument("--name", required=True)
    parser.add_argument("--table", type=Path, required=True)
    parser.add_argument("--figures", type=Path, default=Path("results/figures"), help="folder")
    parser.add_argument("--dataset", type=Path, default=DATASET)


def run(given: argparse.Namespace) -> int:
    """Write them, and add the table to a dataset that is there."""
    evaluate(given.name, str(given.study), given.table, given.figures)
    dataset_groups.add(given.name, given.table, given.dataset)
    return 0
