"""Find the muscle that meets the requirements of a design of the study file.

Looked for by the cylinder, judged by the solid; what is solved is kept in results/cases, so that a
design that was broken off goes on where it was. Without a name all designs are made.
"""

import argparse

from workflow.programs import add_entries, entries, results_of
from workflow.study.study import load


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_entries(parser, "design", "design")


def run(given: argparse.Namespace) -> int:
    """Make them; that no muscle fits is an answer too."""
    from workflow.answers.design import result
    from workflow.report import html_page

    study = load(given.study)
    names = entries(given, study.design, "design")
    folder = given.folder or results_of(given) / "design"
    for name in names:
        results = result.designed(study, name)
        for own, found in zip(result.names(name, results), results, strict=True):
            print("\n".join(result.report(found, own)))
        output = folder / f"{name}.yaml"
        result.write(study, name, results, output)
        html_page.write_beside(output, f"Design {name}", "design")
    return 0
