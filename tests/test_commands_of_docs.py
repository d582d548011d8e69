"""Commands in README and docs: cheap ones are run, runs are dry, of all that they name is there.

A block below ``<!-- run -->`` is run as it stands, those of a page one after the other in a folder
of their own, with the files that the page asks to save (``<!-- file: NAME -->``). What a page shows
as the output of a command is what that says.
"""

import argparse
import ast
import os
import re
import shlex
import subprocess
import sys
from functools import cache
from importlib import import_module
from pathlib import Path

import pytest

from workflow.__main__ import names

ROOT = Path(__file__).parents[1]
DOCUMENTS = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "config/README.md"]
DOCUMENTS += sorted((ROOT / "docs").rglob("*.md"))
PARTS = ("geometry", "solver", "workflow", "config", "profiles", "pyproject.toml", "Snakefile")
STARTS = (".venv/bin/", "./setup.sh", ".ci/run", "muscle ", "snakemake ", "python -m ")
RUN = re.compile(r"^<!-- (run|file: (\S+)) -->\n```(\w+)\n(.*?)^```$", re.M | re.S)
OUTPUT = re.compile(r"^<!-- output of: (.*?) -->\n\n((?:    .*\n)+)", re.M)
FENCE = re.compile(r"^( *)```sh\n(.*?)^\1```$", re.M | re.S)


def blocks_to_run(document: Path) -> list[tuple[str, str, str]]:
    """Name of the file or "", language and text of each marked block."""
    text = document.read_text(encoding="utf-8")
    return [(found[2] or "", found[3], found[4]) for found in RUN.finditer(text)]


TO_RUN = [document for document in DOCUMENTS if any(not f for f, *_ in blocks_to_run(document))]


def commands(document: Path) -> list[str]:
    """Every command of a document: of blocks, and in a line of text."""
    text = document.read_text(encoding="utf-8")
    lines = [line for found in FENCE.finditer(text) for line in found[2].splitlines()]
    lines += re.findall(r"^ {4,}(\S.*)$", text, re.M)
    lines += re.findall(r"`([^`\n]+)`", re.sub(r"^```.*?^```", "", text, flags=re.M | re.S))
    found = []
    for line in lines:
        for part in line.split(" && "):
            words = re.split(r" {3,}| # ", part.strip())[0]
            if words.startswith(STARTS) and "<" not in words and "..." not in words:
                found.append(words)
    return found


COMMANDS = sorted({command for document in DOCUMENTS for command in commands(document)})


@cache
def targets() -> set[str]:
    """Names of rules and analyses."""
    from workflow.analyses.registry import ANALYSES

    files = [ROOT / "Snakefile", *(ROOT / "workflow/rules").glob("*.smk")]
    rules = {name for f in files for name in re.findall(r"^ *rule (\w+):", f.read_text(), re.M)}
    return rules | {each.target or each.name for each in ANALYSES.values()}


class Refused(Exception):
    """A parser that does not know what it is given."""


class Parser(argparse.ArgumentParser):
    def error(self, message):
        raise Refused(message)


def check_program(words: list[str]) -> None:
    """The arguments of ``muscle``."""
    if words == ["--help"] or not words:
        return
    name, *given = words
    assert name in names(), f"there is no muscle {name}"
    program = import_module(f"workflow.programs.{name.replace('-', '_')}")
    parser = Parser()
    program.add_arguments(parser)
    if given:
        parser.parse_args(given)
    if name == "run":
        check_targets(given)


def check_targets(words: list[str]) -> None:
    """Targets of Snakemake among words; options, their values and files are left out."""
    takes = ("--config", "--default-resources")
    known, skip = targets(), False
    for word in words:
        if word.startswith("-"):
            skip = word in ("--cores", "--study", "--report", "--profile", "--set-threads")
            skip = skip or word in takes or word.startswith("--slurm")
            continue
        if skip or "=" in word or "/" in word or word.isupper():
            skip = False
            continue
        assert word in known, f"there is no target {word}"


@pytest.mark.parametrize("command", COMMANDS)
def test_what_a_command_names_is_there(command):
    words = shlex.split(command)
    first, rest = words[0], words[1:]
    if words[:2] == ["python", "-m"]:
        assert (ROOT / words[2] / "__main__.py").is_file()
        return
    name = Path(first).name
    if name == "python":
        module = rest[1] if rest[:1] == ["-m"] else ""
        if module == "workflow":
            check_program(rest[2:])
        return
    if name == "muscle":
        check_program(rest)
    elif name == "snakemake":
        check_targets(rest)
    elif name == "setup.sh":
        known = re.findall(r"^ +(--\w+)\)", (ROOT / "setup.sh").read_text(), re.M)
        assert set(rest) <= set(known)
    elif name == "pytest":
        folders = [word for word in rest if word.startswith("tests")]
        assert all((ROOT / folder).exists() for folder in folders)
    else:
        assert name in ("run", "ruff", "mypy", "snakefmt", "pip"), f"unknown: {command}"


def test_commands_are_found():
    assert "./setup.sh" in COMMANDS
    assert ".venv/bin/snakemake --cores 2" in COMMANDS
    assert ".venv/bin/muscle ask dmsp20 0.25MPa 12%" in COMMANDS
    with pytest.raises(AssertionError, match="no target"):
        check_targets(["--cores", "2", "smoke"])
    with pytest.raises(Refused):
        check_program(["ask", "--presure", "x"])


def test_the_readme_has_its_two_commands():
    text = (ROOT / "README.md").read_text()
    assert "    ./setup.sh && .venv/bin/snakemake --cores 2\n" in text
    assert "    ./setup.sh && .venv/bin/pytest\n" in text
    assert len(text.splitlines()) <= 65
    assert len(re.findall(r"^\d+\. ", text, re.M)) == 10


def test_what_setup_says_next_can_be_done():
    text = (ROOT / "setup.sh").read_text()
    said = re.findall(r"^    (\.venv/bin/snakemake.*?)(?: {2,}.*)?$", text, re.M)
    assert len(said) == 2
    for command in said:
        check_targets(shlex.split(command)[1:])


@pytest.fixture
def checkout(tmp_path):
    """A folder with what a checkout has after setup.sh."""
    for name in PARTS:
        (tmp_path / name).symlink_to(ROOT / name)
    programs = tmp_path / ".venv/bin"
    programs.mkdir(parents=True)
    launcher = re.search(
        r"muscle <<'END'\n(.*?)^END$", (ROOT / "setup.sh").read_text(), re.M | re.S
    )
    texts = {
        "python": f'#!/bin/sh\nexec "{sys.executable}" "$@"\n',
        "snakemake": f'#!/bin/sh\nexec "{sys.executable}" -m snakemake "$@"\n',
        "muscle": launcher[1],
    }
    for name, text in texts.items():
        (programs / name).write_text(text)
        (programs / name).chmod(0o755)
    return tmp_path


@pytest.mark.slow
def test_runs_that_take_long_are_possible(checkout):
    """All targets that documents name, in one dry run of the study of the paper."""
    named = {
        word
        for command in COMMANDS
        if Path(shlex.split(command)[0]).name == "snakemake" and "--config" not in command
        for word in shlex.split(command)[1:]
        if word in targets() or word.startswith("results/figures/")
    }
    assert {"everything", "claims", "accuracy", "results/figures/fig04.png"} <= named
    done = subprocess.run(
        [
            ".venv/bin/snakemake",
            "--dry-run",
            "--quiet",
            "all",
            "--cores",
            "2",
            "--",
            *sorted(named),
        ],
        cwd=checkout,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("document", TO_RUN, ids=lambda d: str(d.relative_to(ROOT)))
def test_marked_blocks_run(checkout, document):
    for file, language, text in blocks_to_run(document):
        if file:
            (checkout / file).write_text(text)
            continue
        if language == "python":
            ast.parse(text)
            command = [".venv/bin/python", "-c", text]
        else:
            command = ["bash", "-euo", "pipefail", "-c", text]
        done = subprocess.run(
            command,
            cwd=checkout,
            env=os.environ | {"PYTHONPATH": str(checkout)},
            capture_output=True,
            text=True,
            timeout=300,
        )
        assert done.returncode == 0, f"{text}\n{done.stdout}{done.stderr}"


SHOWN = [found.groups() for d in DOCUMENTS for found in OUTPUT.finditer(d.read_text("utf-8"))]


@pytest.mark.slow
@pytest.mark.parametrize(("command", "shown"), SHOWN)
def test_what_is_shown_is_what_a_command_says(checkout, command, shown):
    done = subprocess.run(
        shlex.split(command), cwd=checkout, capture_output=True, text=True, timeout=300, check=True
    )
    lines = [line.removeprefix("    ") for line in shown.splitlines()]
    expected = [line for line in lines if line.strip() != "..."]
    assert len(expected) > 1
    assert done.stdout.splitlines()[: len(expected)] == expected


def test_outputs_are_found():
    assert [command for command, _ in SHOWN] == [".venv/bin/muscle ask dmsp20 0.25MPa 12%"]
