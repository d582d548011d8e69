"""Fit muscles to measured forces, as the study file says."""

import argparse
from pathlib import Path

from workflow.analyses.evaluate import evaluate
from workflow.programs import add_study


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_study(parser)
    parser.add_argument("--tables", type=Path, default=Path("results/tables"), help="folder")
    parser.add_argument("--figures", type=Path, default=Path("results/figures"), help="folder")
    parser.add_argument("--muscles", type=Path, default=Path("results/calibration"), help="folder")


def run(given: argparse.Namespace) -> int:
    """Fit them."""
    table = given.tables / "calibration.csv"
    evaluate("calibration", str(given.study), table, given.figures, given.muscles)
    return 0
