"""Make maps of muscles for controllers and simulators: force and volume by pressure and length.

What is solved is kept in results/cases, so that a map that was broken off goes on where it was.
Without a name all maps of the study file are made.
"""

import argparse
from pathlib import Path

from workflow.programs import add_study
from workflow.study import folders
from workflow.study.errors import StudyError, choices
from workflow.study.study import load


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    parser.add_argument("names", nargs="*", help="maps of the study file; by default all")
    parser.add_argument("--folder", type=Path, help="by default maps in the study's results")
    add_study(parser)


def run(given: argparse.Namespace) -> int:
    """Make them."""
    from workflow.answers.maps import files
    from workflow.answers.maps.build import Builder
    from workflow.report import html_page

    study = load(given.study)
    for name in given.names:
        if name not in study.maps:
            raise StudyError(f"{name}: no such map\n  allowed: {choices(name, study.maps)}")
    if not study.maps:
        raise StudyError(f"{given.study}: there is no map in it")
    for name in given.names or study.maps:
        found = Builder(study, name).built()
        folder = given.folder or folders.of_study(given.study) / "maps"
        output = folder / f"{name}.nc"
        files.write(found, output)
        html_page.write(
            output.with_suffix(".html"),
            f"Map {name}",
            Path(html_page.__file__).with_name("map.rst"),
            [output.with_suffix(".png")],
            [],
        )
        print(
            f"{name}: {found.map.pressure.size} pressures, {found.map.contraction.size} "
            f"contractions; force within {found.error:.2g} N, near the threshold "
            f"{found.error_near:.2g} N, pressure within {found.error_inverse:.2g} MPa"
        )
    return 0
