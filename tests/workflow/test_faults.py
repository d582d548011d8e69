"""A campaign loses nothing: whatever is done to a run, the next one ends with the same bytes."""

import contextlib
import os
import random
import resource
import shutil
import signal
import time
from pathlib import Path

import pytest
import xarray as xr

from workflow.run.lock import MARK

KILLED = signal.SIGKILL


def processes(project):
    """All that runs of a project have started and that still lives, by process number."""
    mark = f"{MARK}={project.folder / '.snakemake/run.lock'}".encode()
    found = {}
    for entry in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            if mark in (entry / "environ").read_bytes().split(b"\0"):
                found[int(entry.name)] = (entry / "cmdline").read_bytes()
    return found


def finish(project, *arguments):
    """A plain run, which must succeed and give the bytes of the undisturbed one."""
    status, output = project.run(*arguments)
    assert status == 0, output
    assert "Traceback" not in output


def assert_undisturbed(project, reference):
    """Same bytes, nothing beside them, nothing that still runs."""
    found = project.results()
    assert found.keys() == reference.undisturbed.keys()
    assert [name for name in found if found[name] != reference.undisturbed[name]] == []
    assert processes(project) == {}


def kill(project, run, chance):
    """Kill one of: the whole group, Snakemake alone, a job or FreeFEM. Says which."""
    jobs = processes(project)
    freefem = [pid for pid, command in jobs.items() if b"FreeFem++" in command]
    kind = chance.choice(["group", "snakemake", "job", "job", "freefem"])
    with contextlib.suppress(ProcessLookupError):
        if kind == "freefem" and freefem:
            os.kill(chance.choice(freefem), KILLED)
        elif kind in ("job", "freefem") and jobs:
            os.kill(chance.choice(list(jobs)), KILLED)
        elif kind == "group":
            os.killpg(run.pid, KILLED)
        else:
            os.kill(run.pid, KILLED)
    return kind


def campaign(project, reference, kills, seed):
    """Runs that are killed at random moments; then a plain one gives what it should."""
    chance = random.Random(seed)
    done = rounds = 0
    while done < kills:
        if project.results().keys() >= reference.undisturbed.keys():
            finish(project)
            assert_undisturbed(project, reference)
            project.clear()
            rounds += 1
        run = project.start()
        with contextlib.suppress(Exception):
            run.communicate(timeout=chance.uniform(1, 7))
        if run.poll() is None:
            done += 1
            if kill(project, run, chance) in ("job", "freefem"):
                with contextlib.suppress(Exception):  # Snakemake lives: it may go on for a while
                    run.communicate(timeout=chance.uniform(0, 3))
            with contextlib.suppress(ProcessLookupError):
                os.killpg(run.pid, KILLED)
        run.communicate()
    finish(project)
    assert_undisturbed(project, reference)
    return rounds


@pytest.fixture
def copy(project, tmp_path):
    """A project in which everything has run, to do anything to."""
    return project.copy(tmp_path / "project")


def test_killed_at_random_moments(project, copy):
    copy.clear()
    campaign(copy, project, kills=4, seed=1)


@pytest.mark.campaign
@pytest.mark.parametrize("seed", range(4))
def test_killed_many_times(project, copy, seed):
    copy.clear()
    campaign(copy, project, kills=10, seed=100 + seed)


def test_one_core_and_a_second_run(project, copy):
    """The second is refused while the first lives; one core gives the bytes of two."""
    copy.clear()
    first = copy.start(program=("snakemake", "--cores", "1"))
    lock = copy.folder / ".snakemake/run.lock"
    while not (lock.exists() and lock.read_text().endswith("\n")):
        assert first.poll() is None
        time.sleep(0.05)
    status, output = copy.run()
    assert status == 1
    assert f"Another run works in this folder (process {first.pid})" in output
    output, _ = first.communicate()
    assert first.returncode == 0, output
    assert_undisturbed(copy, project)


@pytest.mark.parametrize("size", [30_000])
def test_a_full_disk(project, copy, size):
    copy.clear()
    limit = (resource.RLIMIT_FSIZE, (size, size))
    status, _ = copy.run(preexec_fn=lambda: resource.setrlimit(*limit))
    assert status != 0
    finish(copy)
    assert_undisturbed(copy, project)


@pytest.mark.campaign
@pytest.mark.parametrize("size", [0, 500, 3_000, 10_000, 60_000, 150_000])
def test_a_full_disk_of_any_size(project, copy, size):
    test_a_full_disk(project, copy, size)


def flip(path):
    """One bit, and nothing else that can be seen from outside."""
    before, content = path.stat(), bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)
    os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))


def cut(path):
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def to_folder(path):
    path.unlink()
    path.mkdir()
    (path / "something").touch()


def to_pipe(path):
    path.unlink()
    os.mkfifo(path)


def to_nowhere(path):
    path.unlink()
    path.symlink_to("nowhere")


DAMAGE = {  # by kind of file, one of each at a time
    "dataset.nc": (cut, to_folder, Path.unlink, to_pipe),
    "states.parquet": (Path.unlink, cut, to_nowhere, to_folder),
    "tables/failures.csv": (Path.unlink, cut, to_folder, to_nowhere),
    "cases/*.h5": (cut, Path.unlink, to_nowhere, to_folder),
    "meshes/*.msh": (Path.unlink, cut, to_pipe, to_folder),
    "figures/fig90.svg": (Path.unlink, to_folder, cut, to_nowhere),
    "figures/fig90.csv": (cut, Path.unlink, to_folder, to_pipe),
    "figures/fig91.png": (cut, to_nowhere, Path.unlink, to_folder),
}


@pytest.mark.parametrize(
    "number", [0, *[pytest.param(k, marks=pytest.mark.campaign) for k in (1, 2, 3)]]
)
def test_damage_is_noticed_and_made_good_by_the_next_run(project, copy, number):
    results = copy.folder / "results"
    for pattern, kinds in DAMAGE.items():
        kinds[number](min(results.glob(pattern)))
    status, output = copy.run("check", program=("workflow",))
    assert status == 1
    assert f"{len(DAMAGE)} of " in output
    finish(copy)
    assert_undisturbed(copy, project)


def test_a_flipped_bit_anywhere_is_found_by_the_check(project, copy):
    results = copy.folder / "results"
    assert copy.run("check", program=("workflow",))[0] == 0
    kinds = ("cases/*", "figures/*", "meshes/*", "tables/*", "*.nc", "*.parquet", "*.html")
    chosen = [path for kind in kinds for path in results.glob(kind)]
    for path in chosen:
        flip(path)
    status, output = copy.run("check", "--delete", program=("workflow",))
    assert status == 1
    said = set(output.splitlines())
    assert {f"{path.relative_to(copy.folder)}: changed" for path in chosen} <= said
    assert f"{len(chosen)} of {len(chosen)} files are deleted; the next run" in output
    finish(copy)
    assert_undisturbed(copy, project)


def test_a_flipped_bit_is_never_read_as_data(project, copy):
    """Where the next run reads it, it says so; a mesh it makes again by itself."""
    results = copy.folder / "results"
    solid = next(p for p in results.glob("cases/*.h5") if b'"model": "solid"' in p.read_bytes())
    solid.unlink()
    (mesh,) = results.glob("meshes/*.msh")
    record = min(results.glob("cases/*.h5"))
    for path in (mesh, *results.glob("cost/*")):
        flip(path)
    (copy.folder / ".snakemake/run.lock").write_bytes(b"\xff")
    status, output = copy.run()
    assert status == 1
    assert f"{mesh.relative_to(copy.folder)} is damaged, and deleted" in output
    assert "Traceback" not in output
    finish(copy)
    flip(record)
    (results / "dataset.nc").unlink()
    status, output = copy.run()
    assert status == 1
    assert f"results/cases/{record.name}: should hold" in output
    assert "Traceback" not in output
    status, output = copy.run("retry", program=("workflow",))
    assert (status, "was damaged" in output) == (0, True)
    finish(copy)
    assert_undisturbed(copy, project)


FAKE = """\
#!/bin/sh
case "$*" in
  *check.edp*) exec {real} "$@" ;;
  *membrane.edp*) {membrane} ;;
  *) {solid} ;;
esac
"""


def fake(folder, **cases):
    """A folder with a FreeFEM that passes the check and then does something else."""
    program = folder / "bin/FreeFem++"
    program.parent.mkdir(exist_ok=True)
    program.write_text(FAKE.format(real=shutil.which("FreeFem++"), **cases))
    program.chmod(0o755)
    return program.parent


def test_a_solver_that_hangs_or_prints_rubbish(project, copy, tmp_path):
    for path in (copy.folder / "results/cases").iterdir():
        if b"section" in path.read_bytes() or b"meridian" in path.read_bytes():
            path.unlink()
    study = copy.read("config/config.yaml")
    copy.write("config/config.yaml", study.replace("wall_time: 60", "wall_time: 4"))
    path = fake(tmp_path, membrane="head -c 9999 /dev/urandom | tee states.csv", solid="sleep 600")
    status, output = copy.run(path=path)
    assert status == 1
    assert "one membrane isobaric 0.2 MPa: solver_error" in output
    assert "one solid isobaric 0.2 MPa: timeout, stopped after 4 s, the limit" in output
    assert "2 cases failed" in output
    assert "5 of 5 cases solved, 2 failed" in output
    assert "failed: one solid isobaric 0.2 MPa: timeout" in output
    assert (copy.folder / "results/dataset.nc").exists()
    assert processes(copy) == {}
    copy.write("config/config.yaml", study)
    copy.run("retry", program=("workflow",))
    finish(copy)
    assert_undisturbed(copy, project)


FLAWS = {  # what happens when the mesher gives its file its name
    "killed": "os.kill(os.getpid(), 9)",
    "full disk": "raise OSError(28, 'No space left on device')",
    "input/output error": "raise OSError(5, 'Input/output error')",
}
FLAWED = """\
import os, sys
real = os.replace
def replace(old, new):
    if str(new).endswith(".msh"): {flaw}
    real(old, new)
if "solve" in sys.orig_argv: os.replace = replace
"""


def test_what_stops_the_mesher_from_outside_is_tried_again(project, copy):
    """One after the other: a run that failed leaves nothing that the next one could go on with."""
    for path in (copy.folder / "results").glob("*/*.*"):
        if path.suffix == ".msh" or (path.suffix == ".h5" and b"section" in path.read_bytes()):
            path.unlink()
    customized = copy.folder / "sitecustomize.py"  # programs take modules from their checkout only
    for kind, flaw in FLAWS.items():
        customized.write_text(FLAWED.format(flaw=flaw))
        status, output = copy.run()
        assert status == 1, kind
        assert "not built, to be tried again" in output, kind
        assert "Traceback" not in output, kind
        assert list((copy.folder / "results/meshes").glob("[!.]*.msh")) == [], kind
    customized.unlink()
    finish(copy)
    assert_undisturbed(copy, project)


def test_what_stops_freefem_from_outside_is_tried_again(project, copy, tmp_path):
    copy.clear()
    path = fake(tmp_path, membrane="kill -9 $$", solid="exec /nowhere/FreeFem++")
    status, output = copy.run(path=path)
    assert status == 1
    assert "not solved, to be tried again: FreeFEM was ended by SIGKILL" in output
    assert "not solved, to be tried again: FreeFEM cannot be run" in output
    assert "Traceback" not in output
    assert len(list((copy.folder / "results/cases").glob("*.h5"))) == 3
    finish(copy)
    assert_undisturbed(copy, project)


@pytest.mark.parametrize(
    ("script", "said"),
    [
        ('exec env FF_LOADPATH=/nowhere {real} "$@"', "does not find its plugin gmsh"),
        ("exit 1", "does not work. FreeFEM stopped with status 1"),
    ],
)
def test_a_broken_freefem_stops_at_once(copy, tmp_path, script, said):
    next((copy.folder / "results/cases").glob("*.h5")).unlink()
    copy.write("solver/path/newton.idp", copy.read("solver/path/newton.idp") + "// edited\n")
    program = tmp_path / "FreeFem++"
    program.write_text("#!/bin/sh\n" + script.format(real=shutil.which("FreeFem++")))
    program.chmod(0o755)
    status, output = copy.run(path=tmp_path)
    assert status == 1
    assert said in output
    assert "Traceback" not in output
    assert "Solving" not in output


def test_an_unfinished_study_is_gathered_and_drawn(project, copy):
    """Beside the results, which the next run completes as if nobody had looked."""
    cases = copy.folder / "results/cases"
    lost = sorted(cases.glob("*.h5"))[:2]
    for path in lost:
        path.unlink()
    (copy.folder / "results/dataset.nc").unlink()
    status, output = copy.run("partial", program=("workflow",))
    assert (status, "Traceback" in output) == (0, False)
    assert "3 of 5 cases are solved" in output
    partial = copy.folder / "results/partial"
    with xr.open_datatree(partial / "dataset.nc", engine="h5netcdf") as tree:
        found = tree["isobaric"].to_dataset()
        asked = found.case_status.where(found.case_status != "", drop=True)
        assert set(asked.values.ravel()) >= {"not_solved", "converged"}
        gone = found.case_status == "not_solved"
        assert bool(found.force.where(gone).isnull().all())
        assert set(found.case.where(gone).values.ravel()) >= {path.stem for path in lost}
    rows = (partial / "tables/failures.csv").read_text()
    assert all(f"{path.stem}," in rows for path in lost)
    assert rows.count("not_solved") == 2
    assert "UNFINISHED" in "".join(p.read_text() for p in partial.glob("figures/*.svg"))
    shutil.rmtree(partial)
    finish(copy)
    assert_undisturbed(copy, project)


def test_a_report_of_nothing_says_so(copy):
    shutil.rmtree(copy.folder / "results")
    status, output = copy.run("--report", "report.html")
    assert status != 0
    assert "There is nothing to report yet: run snakemake --cores 2 first" in output
    assert not (copy.folder / "report.html").exists()
