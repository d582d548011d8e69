"""Make maps of muscles for controllers and simulators: force and volume by pressure and length.

What is solved is kept in results/cases, so that a map that was broken off goes on where it was.
Without a name all maps of the study file are made.
"""

import argparse

from geometry.readable import plain
from workflow.programs import add_entries, entries, results_of
from workflow.study.study import load


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_entries(parser, "map", "maps")


def run(given: argparse.Namespace) -> int:
    """Make them."""
    from workflow.answers.maps import files
    from workflow.answers.maps.build import Builder
    from workflow.report import html_page

    study = load(given.study)
    names = entries(given, study.maps, "map")
    folder = given.folder or results_of(given) / "maps"
    for name in names:
        found = Builder(study, name).built()
        output = folder / f"{name}.nc"
        compiled = files.write(found, output)
        html_page.write_beside(output, f"Map {name}", "map", rows=False)  # of thousands
        print(
            f"{name}: {found.map.pressure.size} pressures, {found.map.contraction.size} "
            f"contractions; force within {plain(found.error, 2)} N, near the threshold "
            f"{plain(found.error_near, 2)} N, pressure within {plain(found.error_inverse, 2)} MPa"
        )
        if not compiled:
            print(
                f"{name}.fmu holds its source alone, which few simulators take: there is no C "
                "compiler here that makes it (gcc on Debian)"
            )
    return 0
