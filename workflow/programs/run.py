"""Run a study in this folder: all its figures, or the targets that are named."""

import argparse
import os
import sys
from pathlib import Path

from workflow.programs import add_study
from workflow.study.errors import StudyError
from workflow.study.folders import DEFAULT

CHECKOUT = Path(__file__).parents[2]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    parser.add_argument("targets", nargs="*", help="files, analyses, everything; else all figures")
    add_study(parser)
    parser.add_argument("--cores", default="all", help="how many at most; by default all")
    parser.add_argument("--dry-run", action="store_true", help="only say what would run")


def run(given: argparse.Namespace) -> int:
    """Become Snakemake; nothing that is there is computed again."""
    if not given.study.exists():
        raise StudyError(f"{given.study}: there is no such study file; --study names another")
    os.execv(command(given)[0], command(given))


def command(given: argparse.Namespace) -> list[str]:
    """Snakemake's command line. Targets stand behind ``--``, else ``--config`` would take them."""
    snakemake = str(Path(sys.executable).with_name("snakemake"))
    words = [snakemake, "--snakefile", str(CHECKOUT / "Snakefile"), "--cores", given.cores]
    words += ["--profile", str(CHECKOUT / "profiles" / "default")]
    words += ["--dry-run"] * given.dry_run
    if given.study != DEFAULT:
        words += ["--config", f"study={given.study}"]
    return [*words, "--", *given.targets]
