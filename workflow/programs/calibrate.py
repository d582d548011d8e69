"""Fit muscles to measured forces, as the study file says."""

import argparse

from workflow.analyses.evaluate import evaluate
from workflow.programs import add_study, results_of


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_study(parser)


def run(given: argparse.Namespace) -> int:
    """Fit them."""
    evaluate("calibration", str(given.study), results_of(given))
    return 0
