"""Batches on a cluster: a real Slurm of two nodes; and what a cluster means for a shared folder."""

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
from .test_faults import fake, processes

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


def until(ready, seconds=240):
    """Wait for what comes late on a busy machine."""
    deadline = time.monotonic() + seconds
    while not ready():
        assert time.monotonic() < deadline, f"not within {seconds} s"
        time.sleep(0.2)


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


def test_killed_cancelled_timed_out_and_resumed_the_bytes_are_those_of_one_machine(
    project, cluster, on_cluster, tmp_path
):
    """The run is killed while a job lives. The next ends that job; of its own one is cancelled, in
    which a solid hangs; the other, in which a membrane hangs beside three cases that are solved,
    is ended by Slurm's clock, which looks twice a minute.
    """
    hanging = fake(tmp_path, membrane="sleep 600", solid=f"touch {tmp_path}/solid; sleep 600")
    study = on_cluster.read("config/config.yaml")
    on_cluster.write("config/config.yaml", study.replace("wall_time: 60,", "wall_time: 600,"))
    run = on_cluster.start(*RUN, path=hanging, program=("snakemake",))
    first = cluster.wait_for_job()
    os.killpg(run.pid, signal.SIGKILL)
    run.communicate()
    assert first in cluster.jobs("RUNNING")

    (tmp_path / "solid").unlink(missing_ok=True)
    run = on_cluster.start(*RUN, path=hanging, program=("snakemake",))
    until(lambda: first not in cluster.jobs("RUNNING"))
    records = on_cluster.folder / "results/cases"
    until(lambda: len(list(records.glob("[!.]*.h5"))) == 3 and (tmp_path / "solid").exists())
    late, cancelled = (cluster.job_of_batch(number) for number in (0, 1))
    kept = {path.name: path.read_bytes() for path in records.iterdir()}
    cluster.run("scontrol", "update", f"JobId={late}", "EndTime=now+1")
    cluster.run("scancel", cancelled)
    output, _ = run.communicate(timeout=240)
    assert run.returncode == 1, output
    assert "of a run that was killed" in output
    assert "Traceback" not in output
    stays = "What it has solved stays; the next run solves the rest."
    assert f"job {cancelled} of the cluster was cancelled (CANCELLED). {stays}" in output
    assert f"job {late} of the cluster ended at its time limit; " in output
    assert f"gives more (TIMEOUT). {stays}" in output
    assert {path.name: path.read_bytes() for path in records.iterdir()} == kept
    assert not (on_cluster.folder / "results/solved").exists()
    until(lambda: processes(on_cluster) == {})

    on_cluster.write("config/config.yaml", study)
    status, output = on_cluster.run(*RUN, program=("snakemake",))
    assert status == 0, output
    assert "Traceback" not in output
    assert "of a run that was killed" not in output
    assert "5 of 5 cases solved, 0 failed" in output
    found, expected = (
        {name: content for name, content in p.items() if not name.startswith("solved/")}
        for p in (on_cluster.results(), project.undisturbed)
    )
    assert {name: found[f"cases/{name}"] for name in kept} == kept
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


@pytest.fixture
def slurm(tmp_path, monkeypatch):
    """Programs of a cluster in a folder of their own, which is the one of a run."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(lock, "_held", [])
    monkeypatch.setenv(lock.MARK, "")
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)

    def program(name, text):
        (tmp_path / name).write_text(text)
        (tmp_path / name).chmod(0o755)

    program("squeue", SQUEUE)
    program("scancel", '#!/bin/sh\necho "$@" >> cancelled\n')
    yield program
    for file in lock._held:
        file.close()


def killed(path):
    """A run on a cluster has held this lock, and has not ended."""
    lock.take(path, cluster=True)
    lock._held.pop().close()


def test_jobs_of_a_killed_run_are_cancelled_those_of_this_folder_only(slurm, tmp_path, capsys):
    killed(tmp_path / "run.lock")
    lock.take(tmp_path / "run.lock")
    assert (tmp_path / "cancelled").read_text() == "1\n"
    assert "Cancelling 1 jobs of a run that was killed" in capsys.readouterr().err


def test_a_cluster_that_does_not_answer_is_said_until_it_does(slurm, tmp_path, capsys):
    killed(tmp_path / "run.lock")
    slurm("squeue", "#!/bin/sh\necho 'Unable to contact slurm controller' >&2\nexit 1\n")
    for _ in range(2):
        lock.take(tmp_path / "run.lock")
        lock._held.pop().close()
        (said,) = capsys.readouterr().err.splitlines()
        assert "used a cluster and was killed; its jobs cannot be looked for (Unable to" in said
    slurm("squeue", SQUEUE)
    lock.take(tmp_path / "run.lock")
    assert (tmp_path / "cancelled").read_text() == "1\n"


@pytest.mark.parametrize("cluster", [True, False])
def test_no_cluster_is_asked_where_no_jobs_can_live(slurm, tmp_path, capsys, cluster):
    slurm("squeue", "#!/bin/sh\ntouch asked\nexit 1\n")
    lock.take(tmp_path / "run.lock", cluster=cluster)
    lock.ended(tmp_path / "run.lock")
    lock._held.pop().close()
    lock.take(tmp_path / "run.lock")
    assert capsys.readouterr().err == ""
    assert not (tmp_path / "asked").exists()


def test_a_job_of_a_cluster_takes_the_cores_that_it_was_given(project, tmp_path, monkeypatch):
    """Whose node has more, and does not keep them from it."""
    copy = project.copy(tmp_path / "project")
    copy.clear()
    monkeypatch.setenv("SLURM_CPUS_PER_TASK", "3")
    inside = ("snakemake", "--cores", "8", "--mode", "remote")
    batch = "results/solved/study/0of1.txt"
    status, said = copy.run(batch, "--dry-run", "--printshellcmds", program=inside)
    assert status == 0, said
    assert " --cores 3 " in said
    status, said = copy.run(batch, "--dry-run", "--printshellcmds", program=inside[:3])
    assert " --cores 8 " in said
