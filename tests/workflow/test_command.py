"""The command ``muscle``: one door to everything, from any folder."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from workflow.__main__ import OF_RULES, main, names
from workflow.programs import run

ROOT = Path(__file__).parents[2]
SETUP = (ROOT / "setup.sh").read_text()
PARTS = ("geometry", "solver", "workflow", "config", "profiles", "Snakefile", "pyproject.toml")
SMOKE = ROOT / "config" / "smoke" / "study.yaml"


@pytest.fixture
def muscle(tmp_path):
    """A function that calls the launcher of setup.sh in a folder that has modules of our names."""
    programs = tmp_path / "checkout" / ".venv" / "bin"
    programs.mkdir(parents=True)
    for name in (
        "geometry",
        "solver",
        "workflow",
        "config",
        "profiles",
        "Snakefile",
        "pyproject.toml",
    ):
        (tmp_path / "checkout" / name).symlink_to(ROOT / name)
    (programs / "python").write_text(f'#!/bin/sh\nexec "{sys.executable}" "$@"\n')
    (programs / "python").chmod(0o755)
    text = re.search(r"muscle <<'END'\n(.*?)^END$", SETUP, re.M | re.S)[1]
    (programs / "muscle").write_text(text)
    (programs / "muscle").chmod(0o755)
    mine = tmp_path / "mine"
    for name in ("geometry", "solver", "workflow"):
        (mine / name).mkdir(parents=True)
        (mine / name / "__init__.py").write_text("raise ImportError('not this one')\n")

    def call(*arguments):
        return subprocess.run(
            [programs / "muscle", *arguments],
            cwd=mine,
            capture_output=True,
            text=True,
            check=False,
            env={"PATH": "/usr/bin:/bin", "PYTHONPATH": str(mine)},
        )

    return call


def test_it_lists_a_study_from_another_folder(muscle):
    done = muscle("list", "--study", str(SMOKE))
    assert done.returncode == 0, done.stderr
    assert "short " in done.stdout
    assert "fig04" in done.stdout
    assert "not solved" in done.stdout
    assert "robustness" in done.stdout


def test_it_runs_a_study_in_another_folder(muscle):
    done = muscle("run", "--study", str(SMOKE), "--dry-run", "--cores", "1")
    assert done.returncode == 0, done.stderr
    assert "Drawing fig04" in done.stdout + done.stderr


def test_who_reads_a_part_only_is_no_error(muscle, tmp_path):
    program = tmp_path / "checkout/.venv/bin/muscle"
    done = subprocess.run(
        ["bash", "-c", f"{program} list --study {SMOKE} | head -1; echo ${{PIPESTATUS[0]}}"],
        cwd=tmp_path / "mine",
        capture_output=True,
        text=True,
        check=True,
        env={"PATH": "/usr/bin:/bin"},
    )
    assert done.stdout.splitlines()[0] == "muscles"
    assert done.stdout.splitlines()[1] in {"0", "141"}
    assert done.stderr == ""


def test_help_names_every_program(capsys):
    with pytest.raises(SystemExit) as ended:
        main(["--help"])
    assert ended.value.code == 0
    said = capsys.readouterr().out
    assert all(f"\n    {name}" in said for name in names())
    assert said.index("\n    sheet ") < said.index("\n    analysis ")
    assert set(names()) >= OF_RULES
    assert {"run", "explain", "check", "retry", "list"} <= set(names()) | {"check"}


@pytest.mark.parametrize(
    ("name", "nearest"), [("explian", "explain"), ("fit_rubber", "fit-rubber"), ("asks", "ask")]
)
def test_a_name_that_is_none_is_refused(name, nearest, capsys):
    assert main([name, "--study", "mine.yaml"]) == 2
    assert f"(nearest: {nearest})" in capsys.readouterr().err


@pytest.mark.parametrize("targets", [[], ["claims"], ["results/figures/fig04.png", "everything"]])
def test_targets_are_not_taken_for_settings(targets):
    parser = run.argparse.ArgumentParser()
    run.add_arguments(parser)
    words = run.command(parser.parse_args(["--study", "a.yaml", *targets]))
    assert words[words.index("--config") + 1] == "study=a.yaml"
    assert words[words.index("--") + 1 :] == targets


def test_a_study_that_is_not_there_is_refused(capsys):
    assert main(["run", "--study", "nowhere.yaml"]) == 1
    assert "nowhere.yaml: there is no such study file" in capsys.readouterr().err
