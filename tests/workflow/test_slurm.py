"""Batches on a cluster: a real Slurm of two nodes; and what a cluster means for a shared folder."""

import contextlib
import importlib.util
import os
import shutil
import signal
import subprocess
import time
from pathlib import Path

import pytest
import yaml

from geometry.files import HOST
from workflow.run import lock

from .project import ROOT, Project, end
from .slurm import NODES, Cluster, install
from .test_faults import fake

PROFILE = "profiles/slurm"
SOON = ("--slurm-init-seconds-before-status-checks", "1", "--seconds-between-status-checks", "1")
RUN = ("--profile", PROFILE, *SOON, "--config", "batches=2")


SCENES = """\
  slow:
    path: isobaric
    muscles: [longer]
    pressure: [0.2]
    contraction: [0, 0.05]
    models: [membrane]
  impossible:
    path: isotonic
    muscles: [short]
    load: [10000000]
    pressure: [0.1]
    models: [cylinder]
limits: {wall_time: 6, memory: 2000}
"""
HANGS = """\
#!/bin/sh
case "$*" in
  *"-half_length 45.0 "*) exec sleep 600 ;;
  *) exec {real} "$@" ;;
esac
"""


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    """A cluster; it takes root to begin one, and where root is it must begin."""
    if os.geteuid() != 0:
        pytest.skip("only root can begin a cluster")
    assert importlib.util.find_spec("snakemake_executor_plugin_slurm"), "./setup.sh --slurm"
    install()
    with Cluster(tmp_path_factory.mktemp("slurm")) as made:
        yield made


@pytest.fixture
def on_cluster(project, cluster, tmp_path):
    """A project in which nothing has run yet; no run of it outlives the test."""
    copy, runs = project.copy(tmp_path / "project"), []
    copy.clear()

    def start(*arguments, **options):
        runs.append(Project.start(copy, *arguments, **options))
        return runs[-1]

    copy.start = start
    yield copy
    for run in runs:
        end(run)


def test_killed_cancelled_and_resumed_the_bytes_are_those_of_one_machine(
    project, cluster, on_cluster, tmp_path
):
    """The run is killed while a job lives; the next ends that job and its own one is cancelled."""
    hanging = fake(tmp_path, membrane="sleep 600", solid="sleep 600")
    run = on_cluster.start(*RUN, path=hanging, program=("snakemake",))
    first = cluster.wait_for_job()
    os.killpg(run.pid, signal.SIGKILL)
    run.communicate()
    assert first in cluster.jobs("RUNNING")

    run = on_cluster.start(*RUN, path=hanging, program=("snakemake",))
    deadline = time.monotonic() + 90
    while first in cluster.jobs("RUNNING"):
        assert time.monotonic() < deadline
        time.sleep(0.2)
    while not (running := set(cluster.jobs("RUNNING")) - {first}):
        assert time.monotonic() < deadline
        time.sleep(0.2)
    time.sleep(1)
    while run.poll() is None:
        running |= set(cluster.jobs("RUNNING"))
        for job in running:
            cluster.run("scancel", job)
        with contextlib.suppress(subprocess.TimeoutExpired):
            run.wait(2)
    output, _ = run.communicate()
    assert run.returncode == 1, output
    assert "of a run that was killed" in output
    assert "Traceback" not in output

    status, output = on_cluster.run(*RUN, program=("snakemake",))
    assert status == 0, output
    assert "Traceback" not in output
    assert "5 of 5 cases solved, 0 failed" in output
    found, expected = (
        {name: content for name, content in p.items() if not name.startswith("solved/")}
        for p in (on_cluster.results(), project.undisturbed)
    )
    assert found.keys() == expected.keys()
    assert [name for name in found if found[name] != expected[name]] == []
    assert cluster.jobs("RUNNING") == []


def smoke(folder, tmp_path, *arguments):
    """The smoke study in its own folder, with a case that fails and one that takes too long."""
    folder.mkdir()
    study = (ROOT / "config/smoke/study.yaml").read_text()
    longer = "  longer: {base: short, length: 90}\n\nnumerics:"
    text = study.replace("\nnumerics:", longer) + SCENES
    (folder / "smoke.yaml").write_text(text)
    program = tmp_path / "bin/FreeFem++"
    if not program.exists():
        program.parent.mkdir()
        program.write_text(HANGS.format(real=shutil.which("FreeFem++")))
        program.chmod(0o755)
    run = ("snakemake", "-s", str(ROOT / "Snakefile"), "-d", str(folder))
    made = Project.at(folder)
    status, said = made.run(*arguments, "study=smoke.yaml", program=run, path=program.parent)
    assert status == 1, said
    assert "2 cases failed" in said, said
    results = made.results().items()
    return said, {
        name: text for name, text in results if not {"logs", "solved"} & set(Path(name).parts)
    }


def test_the_smoke_study_on_two_nodes_gives_the_bytes_of_one_machine(cluster, tmp_path):
    _, expected = smoke(tmp_path / "here", tmp_path, "--cores", "2", "--config")
    profile = ("--profile", str(ROOT / PROFILE))
    said, found = smoke(tmp_path / "there", tmp_path, *profile, *RUN[2:])
    assert "longer membrane isobaric 0.2 MPa: timeout, stopped after 6 s, the limit" in said
    assert found.keys() == expected.keys()
    assert [name for name in found if found[name] != expected[name]] == []
    assert cluster.nodes_of_jobs() >= set(NODES)


def test_jobs_are_named_as_the_lock_looks_for_them():
    profile = yaml.safe_load((ROOT / PROFILE / "config.yaml").read_text())
    assert profile["slurm-jobname-prefix"] + "_" == lock.PREFIX


def test_what_another_machine_writes_is_let_alone(tmp_path):
    """A number of a process says nothing about another machine's."""
    (tmp_path / ".elsewhere.4194304.a.h5").touch()  # that number is nobody's
    (tmp_path / f".{HOST}.4194304.a.h5").touch()
    (tmp_path / ".keep").touch()
    lock.tidy(tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {".elsewhere.4194304.a.h5", ".keep"}


def test_what_is_being_written_here_is_let_alone(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with subprocess.Popen(["sleep", "60"], cwd=tmp_path) as writer:
        beside = tmp_path / f".{HOST}.{writer.pid}.a.h5"
        beside.touch()
        lock.tidy(tmp_path)
        there = beside.exists()
        writer.kill()
    assert there
    lock.tidy(tmp_path)
    assert not beside.exists()


SQUEUE = """\
#!/bin/sh
echo "1|muscle_12ab|$PWD"
echo "2|muscle_34cd|/somewhere/else"
echo "3|mine|$PWD"
"""


def test_jobs_of_a_killed_run_are_cancelled_those_of_this_folder_only(
    tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)
    programs = {"squeue": SQUEUE, "scancel": '#!/bin/sh\necho "$@" >> cancelled\n'}
    for name, text in programs.items():
        (tmp_path / name).write_text(text)
        (tmp_path / name).chmod(0o755)
    lock._cancel_orphans()
    assert (tmp_path / "cancelled").read_text() == "1\n"
    assert "Cancelling 1 jobs of a run that was killed" in capsys.readouterr().err
    (tmp_path / "squeue").write_text("#!/bin/sh\nexit 1\n")
    lock._cancel_orphans()
    assert "cannot be looked for" in capsys.readouterr().err
