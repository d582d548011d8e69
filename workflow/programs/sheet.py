"""Print the data sheet of a muscle at a pressure: forces, stroke, stiffness, work, air, limits.

As ``muscle sheet dmsp20 --pressure 3bar --load 20kg``. What has to be solved for it is kept in
results/cases. With --output it is also written as .html, .csv and .json.
"""

import argparse
import json
from pathlib import Path

from workflow.answers import quantities
from workflow.programs import add_study
from workflow.study.errors import StudyError, choices
from workflow.study.limits import HIGHEST


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    parser.add_argument("muscle", help="its name in the study file")
    parser.add_argument("--pressure", required=True, help="as 0.3MPa or 3bar")
    parser.add_argument("--load", help="as 200N or 20kg; by default half of the blocked force")
    parser.add_argument("--model", default="solid", help="what computes it; by default solid")
    parser.add_argument("--variant", default="default", help="effects and numerics of the study")
    parser.add_argument("--json", action="store_true", help="print it as JSON")
    parser.add_argument("--output", type=Path, help="a page to write, .html; others beside it")
    add_study(parser)


def run(given: argparse.Namespace) -> int:
    """Print it; status 1 if its balance of energy does not close."""
    from workflow.answers import sheet
    from workflow.answers.studies import with_muscle
    from workflow.study.schema import QUANTITIES

    study = with_muscle(given.study, given.muscle)
    for kind, name, known in (
        ("variant", given.variant, study.variants),
        ("model for sheets", given.model, QUANTITIES["sheet"]),
    ):
        if name not in known:
            raise StudyError(f"{name}: no such {kind}\n  allowed: {choices(name, known)}")
    length = study.muscles[given.muscle].muscle.length
    _, pressure = quantities.read(given.pressure, length, quantities.PRESSURE)
    if not 0 < pressure <= HIGHEST:
        allowed = f"more than 0, at most {HIGHEST:g} MPa"
        raise StudyError(f"pressure {pressure:g} MPa\n  allowed: {allowed}")
    weight = None
    if given.load is not None:
        _, weight = quantities.read(given.load, length, quantities.FORCE)
    found = sheet.solved(
        study, given.muscle, pressure, model=given.model, variant=given.variant, load=weight
    )
    if given.json:
        print(json.dumps(sheet.as_dict(found), indent=1))
    else:
        print("\n".join(sheet.lines(found)))
    if given.output is not None:
        from workflow.answers import sheet_files
        from workflow.report import html_page

        sheet_files.write(study, [found], given.output)
        html_page.write_beside(given.output, f"{given.muscle} at {pressure:g} MPa", "sheet")
    return int(not found.closes)
