"""setup.sh asks only for what is missing; lock, hooks and container are as it and pyproject say."""

import re
import shutil
import subprocess
import tomllib
from pathlib import Path

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parent.parent
# all that setup.sh may call before it installs anything
TOOLS = ["awk", "bash", "dirname", "env", "readlink", "rm", "sha256sum", "uname"]


LOCKS = ("requirements.lock", "requirements-slurm.lock")


def locked_versions(lock: str = LOCKS[0]) -> dict[str, str]:
    """Versions of a lock by canonical name."""
    pins = re.findall(r"^([\w.-]+)==([^\s;]+)", (ROOT / lock).read_text(), re.M)
    return {canonicalize_name(name): version for name, version in pins}


def declared() -> list[Requirement]:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    return [
        Requirement(r) for r in project["dependencies"] + project["optional-dependencies"]["dev"]
    ]


@pytest.mark.parametrize("requirement", declared(), ids=lambda r: r.name)
def test_lock_holds_a_version_in_range(requirement: Requirement) -> None:
    assert locked_versions()[canonicalize_name(requirement.name)] in requirement.specifier


def test_the_lock_for_slurm_has_what_the_extra_adds() -> None:
    added = locked_versions(LOCKS[1])
    name = "snakemake-executor-plugin-slurm"
    assert added.keys() == {name, f"{name}-jobstep"}
    assert not added.keys() & locked_versions().keys()
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    (wanted,) = map(Requirement, project["optional-dependencies"]["slurm"])
    assert added[wanted.name] in wanted.specifier


@pytest.mark.parametrize("name", LOCKS)
def test_lock_names_no_host_and_hashes_everything(name: str) -> None:
    lock = (ROOT / name).read_text()
    assert "://" not in lock
    entries = re.split(r"\n(?=\w)", lock[lock.index("\n", lock.rindex("\n#") + 1) + 1 :])
    assert len(entries) == len(locked_versions(name))
    assert all("--hash=sha256:" in entry for entry in entries)


@pytest.fixture
def bare_machine(tmp_path: Path):
    """Run setup.sh where the programs and libraries given are all there is, without root."""
    checkout, programs = tmp_path / "checkout", tmp_path / "bin"
    checkout.mkdir()
    programs.mkdir()
    for name in ("setup.sh", "requirements.lock"):
        shutil.copy(ROOT / name, checkout)
    for tool in TOOLS:
        (programs / tool).symlink_to(shutil.which(tool))

    def program(name: str, body: str) -> None:
        path = programs / name
        path.write_text(f"#!/bin/sh\n{body}\n")
        path.chmod(0o755)

    def run(
        libraries: list[str], *, freefem: bool, python: Path = Path("/bin/false")
    ) -> subprocess.CompletedProcess[str]:
        program("id", "echo 1000")
        program(
            "ldconfig", "\n".join(f"echo '{name} (libc6) => /lib/{name}'" for name in libraries)
        )
        program("dpkg-query", "exit 1")
        if freefem:
            program("FreeFem++", "exit 0")
        return subprocess.run(
            [programs / "bash", checkout / "setup.sh"],
            env={"PATH": str(programs), "PYTHON": str(python)},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=30,
        )

    return run


def test_without_root_names_the_missing_packages(bare_machine) -> None:
    result = bare_machine(["libGL.so.1", "libgomp.so.1"], freefem=False)
    assert result.returncode == 1
    (command,) = re.findall(r"apt-get install .*", result.stderr)
    assert {"freefem++", "libfreefem++", "libopenblas0-serial", "libglu1-mesa"} <= set(
        command.split()
    )
    assert not {"libgl1", "libgomp1"} & set(command.split())


def test_another_freefem_is_enough(bare_machine) -> None:
    result = bare_machine(["libGL.so.1"], freefem=True)
    assert result.returncode == 1
    (command,) = re.findall(r"apt-get install .*", result.stderr)
    assert "libglu1-mesa" in command
    assert "freefem" not in command
    assert "blas" not in command


def test_old_python_is_refused(bare_machine) -> None:
    source = (ROOT / "setup.sh").read_text()
    libraries = re.findall(r"(lib\w+\.so\.\d+):", source)
    assert len(libraries) > 5
    result = bare_machine(libraries, freefem=True)
    assert result.returncode == 1
    assert "Python 3.11 or newer" in result.stderr


def test_what_a_link_leads_to_is_not_cleared(bare_machine, tmp_path) -> None:
    theirs = tmp_path / "theirs"
    (theirs / "bin").mkdir(parents=True)
    (tmp_path / "checkout" / ".venv").symlink_to(theirs)
    python = tmp_path / "python"  # makes none, and would empty what it is told to make anew
    python.write_text('#!/bin/sh\n[ "$2" != venv ] || rm -rf .venv/bin && [ "$2" != venv ]\n')
    python.chmod(0o755)
    libraries = re.findall(r"(lib\w+\.so\.\d+):", (ROOT / "setup.sh").read_text())
    result = bare_machine(libraries, freefem=True, python=python)
    assert "could not make .venv" in result.stderr
    assert (theirs / "bin").is_dir()


def test_hooks_before_a_commit_are_the_linters_of_ci():
    hooks = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text())["repos"][0]["hooks"]
    steps = re.findall(r"^step (\S+)(.*?)(?: #.*)?$", (ROOT / ".ci/run").read_text(), re.M)
    linters = ("ruff", "mypy", "snakefmt", "lint-workflow")
    asked = {
        f"{program}{words}".partition(" Snakefile")[0].strip()
        for program, words in steps
        if Path(program).name in linters
    }
    assert {hook["entry"] for hook in hooks} == asked
    assert len(asked) == 5
    assert all(hook["language"] == "system" for hook in hooks)


def test_the_container_is_set_up_by_setup():
    """It brings what setup.sh itself needs on a bare Debian, and nothing that setup.sh installs."""
    text = (ROOT / "Containerfile").read_text()
    setup = (ROOT / "setup.sh").read_text()
    assert "FROM debian:12\n" in text
    assert "cd /muscle && ./setup.sh \\\n" in text
    (installed,) = re.findall(r"apt-get install --yes --no-install-recommends (.*) \\", text)
    assert set(installed.split()) == {"ca-certificates", "python3", "python3-venv"}
    assert "pip install" not in text
    (launcher,) = re.findall(r"cat >(\S+/muscle) <<", setup)
    assert f'ENTRYPOINT ["/muscle/{launcher}"]' in text
    ignored = (ROOT / ".containerignore").read_text().split()
    assert {".git", ".venv", "results"} <= set(ignored)


def test_the_catalog_names_the_command_and_the_report():
    usage = yaml.safe_load((ROOT / ".snakemake-workflow-catalog.yml").read_text())["usage"]
    assert usage["report"] is True
    assert "./setup.sh" in usage["mandatory-flags"]["desc"]
    assert usage["mandatory-flags"]["flags"] == "--cores"
