"""Take over the tables that numbers of the documentation are from, from the results of a run."""

import argparse
import shutil
import sys

from geometry.files import atomic_write
from workflow.report.site import numbers
from workflow.study.folders import DEFAULT, of_study


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    parser.add_argument("--check", action="store_true", help="only say what differs; status 1")


def run(given: argparse.Namespace) -> int:
    """Copy those that a run has made; then say which numbers of the pages are others now."""
    results = of_study(DEFAULT)
    there = list(numbers.copied(results))
    if not there:
        print(f"{results / 'tables'}: a run has made none of these tables here", file=sys.stderr)
    for path, made in there if not given.check else ():
        with atomic_write(path) as beside:
            shutil.copyfile(made, beside)
        print(path)
    numbers.table.cache_clear()
    wrong = [*numbers.outdated(results), *numbers.of_all_pages()]
    for line in wrong:
        print(line)
    return 1 if wrong else 0
