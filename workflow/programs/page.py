"""Write a page of the report."""

import argparse
from pathlib import Path

from workflow.report import html_page


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    parser.add_argument("--title", required=True)
    parser.add_argument("--caption", type=Path, required=True)
    parser.add_argument("--pictures", type=Path, nargs="*", default=[])
    parser.add_argument("--tables", type=Path, nargs="*", default=[])
    parser.add_argument("--output", type=Path, required=True, help=".html")


def run(given: argparse.Namespace) -> int:
    """Write it."""
    html_page.write(given.output, given.title, given.caption, given.pictures, given.tables)
    return 0
