"""Delete the records of failed cases, so that they are solved again."""

import argparse

from workflow.data import records
from workflow.programs.case_options import add_cases, cases_of
from workflow.study.folders import MESHES


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_cases(parser)


def run(given: argparse.Namespace) -> int:
    """Delete them, and the file that says why there is no mesh."""
    for key, case in cases_of(given).items():
        status = records.status(key, case.label)
        if status not in ("converged", "limit_point", "not solved"):
            records.path_of(key).unlink()
            if status == "mesh_failed" and case.mesh:
                (MESHES / case.mesh).unlink(missing_ok=True)
            print(f"will be solved again (was {status}): {case.label}")
    return 0
