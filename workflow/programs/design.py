"""Find the muscle that meets the requirements of a design of the study file.

Looked for by the cylinder, judged by the solid; what is solved is kept in results/cases, so that a
design that was broken off goes on where it was. Without a name all designs are made.
"""

import argparse
from pathlib import Path

from workflow.programs import add_study
from workflow.study import folders
from workflow.study.errors import StudyError, choices
from workflow.study.study import load


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    parser.add_argument("names", nargs="*", help="designs of the study file; by default all")
    parser.add_argument("--folder", type=Path, help="by default design in the study's results")
    add_study(parser)


def run(given: argparse.Namespace) -> int:
    """Make them; that no muscle fits is an answer too."""
    from workflow.answers.design import result
    from workflow.report import html_page

    study = load(given.study)
    for name in given.names:
        if name not in study.design:
            raise StudyError(f"{name}: no such design\n  allowed: {choices(name, study.design)}")
    if not study.design:
        raise StudyError(f"{given.study}: there is no design in it")
    for name in given.names or study.design:
        results = result.designed(study, name)
        for found in results:
            print("\n".join(result.report(found)))
        folder = given.folder or folders.of_study(given.study) / "design"
        output = folder / f"{name}.yaml"
        result.write(study, name, results, output)
        html_page.write_beside(output, f"Design {name}", "design")
    return 0
