"""Write the data sheets of a scene, of the records of its curves."""

import argparse
import sys
from pathlib import Path

from workflow.answers import sheet, sheet_files
from workflow.programs import add_study, settled_plan_of
from workflow.report import html_page


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_study(parser)
    parser.add_argument("--scene", required=True)
    parser.add_argument("--output", type=Path, required=True, help=".html; others beside it")


def run(given: argparse.Namespace) -> int:
    """Write them; status 1 if the balance of energy of one does not close."""
    plan = settled_plan_of(given)
    found = sheet_files.of_scene(plan, given.scene)
    said = sheet.warnings(found)
    for line in said:
        print(line, file=sys.stderr)
    if said:
        return 1
    sheet_files.write(plan.study, found, given.output)
    html_page.write_beside(given.output, f"Sheets of {given.scene}", "sheet")
    return 0
