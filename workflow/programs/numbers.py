"""Take over the tables that numbers of the documentation are from, from the results of a run."""

import argparse
import shutil

from workflow.report.site import numbers
from workflow.study.folders import DEFAULT, of_study


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    parser.add_argument("--check", action="store_true", help="only say what differs; status 1")


def run(given: argparse.Namespace) -> int:
    """Copy those that a run has made; then say which numbers of the pages are others now."""
    results = of_study(DEFAULT)
    if not given.check:
        for path, made in numbers.copied(results):
            shutil.copyfile(made, path)
            print(path)
    numbers.table.cache_clear()
    wrong = [*numbers.outdated(results), *numbers.of_all_pages()]
    for line in wrong:
        print(line)
    return 1 if wrong else 0
