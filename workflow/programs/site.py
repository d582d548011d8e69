"""Make the site of docs/ with Sphinx: guides, theory, reference made of the code, gallery."""

import argparse
from pathlib import Path

from workflow.study.errors import StudyError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    parser.add_argument("--output", type=Path, default=Path("results/site"), help="folder")


def run(given: argparse.Namespace) -> int:
    """Make it; what is wrong with a page, also a number without a source, is an error."""
    try:
        from workflow.report.site import build  # late: Sphinx is there for who writes pages
    except ModuleNotFoundError as error:
        raise StudyError(f"{error}; ./setup.sh installs what the site needs") from error
    status = build.build(given.output)
    if status == 0:
        print(given.output / "index.html")
    return status
