"""Running FreeFEM: what it is given, how it ends, and that nothing of it survives its limits."""

import mmap
import os
import re
import resource
import signal
import time
from pathlib import Path

import pytest

from solver import freefem
from solver.freefem import PATH, FreeFemError, Limits, OutOfTime

LIMITS = Limits(wall_time=30, memory=2000)


@pytest.fixture
def run(tmp_path):
    """Runs the text of a program; gives its usage."""

    def run_text(text: str, limits: Limits = LIMITS, includes=(PATH,), **flags):
        program = tmp_path / "program.edp"
        program.write_text(text)
        return freefem.run(program, flags, tmp_path, tmp_path / "log", limits, includes)

    return run_text


def test_a_program_runs_in_its_folder(run, tmp_path):
    usage = run('ofstream out("found.txt"); out << 1 + 1 << endl;')
    assert (tmp_path / "found.txt").read_text() == "2\n"
    assert 0 < usage.cpu_seconds <= usage.seconds + 1
    ours = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024  # a child begins as a copy
    assert 5 < usage.peak_memory < max(500, 1.1 * ours)


def test_flags_arrive_to_the_last_digit(run, tmp_path):
    run(
        'include "arguments.idp"\n'
        'ofstream out("found.txt"); out.precision(17);\n'
        'out << requireReal("-third") << " " << requireInt("-count") << " "\n'
        '    << requireReal("-small") << " " << requireReal("-minus") << endl;',
        third=1 / 3,
        count=7,
        small=1e-300,
        minus=-0.1,
    )
    third, count, small, minus = (tmp_path / "found.txt").read_text().split()
    assert float(third) == 1 / 3
    assert count == "7"
    assert float(small) == 1e-300
    assert float(minus) == -0.1


def test_a_missing_flag_is_named(run, tmp_path):
    with pytest.raises(FreeFemError, match="status 64: an argument is missing"):
        run('include "arguments.idp"\nreal x = requireReal("-absent");', present=1)
    assert "missing flag -absent" in freefem.tail(tmp_path / "log")


@pytest.mark.parametrize(
    ("text", "meaning"),
    [
        ("real x = ;", "status 1: the program does not compile"),
        ('load "NoSuchPlugin"', "status 2: a plugin is missing"),
        ("assert(1 == 2);", "it broke off while computing"),
        ("exit(77);", "status 77: see its log"),
    ],
)
def test_exit_codes_are_explained(run, text, meaning):
    with pytest.raises(FreeFemError, match=meaning):
        run(text)


def test_a_signal_is_named():
    assert "SIGSEGV" in freefem.explain(-signal.SIGSEGV)
    assert "SIGKILL" in freefem.explain(-signal.SIGKILL)


def alive(pid: int) -> bool:
    """Whether a process still runs; one that only waits to be collected does not."""
    try:
        return (Path("/proc") / str(pid) / "stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def test_the_time_limit_ends_the_whole_group(run, tmp_path):
    """Also a child that FreeFEM has started; and at once."""
    start = time.monotonic()
    with pytest.raises(OutOfTime, match=r"0\.7 s"):
        run('exec("echo $$ > pid; exec sleep 60");', Limits(wall_time=0.7, memory=2000))
    assert time.monotonic() - start < 10
    pid = int((tmp_path / "pid").read_text())
    for _ in range(50):
        if not alive(pid):
            break
        time.sleep(0.1)
    assert not alive(pid)


def test_an_endless_loop_is_ended(run):
    with pytest.raises(OutOfTime):
        run("real x = 0; while (true) x += 1;", Limits(wall_time=0.5, memory=2000))


def test_an_interruption_ends_it_too(run, tmp_path, monkeypatch):
    """Ctrl-C while waiting leaves no process behind."""

    def interrupt(process, seconds):
        while not (tmp_path / "pid").exists():
            time.sleep(0.01)
        raise KeyboardInterrupt

    monkeypatch.setattr(freefem, "wait", interrupt)
    with pytest.raises(KeyboardInterrupt):
        run('exec("echo $$ > new; mv new pid; exec sleep 60");')
    pid = int((tmp_path / "pid").read_text())
    for _ in range(50):
        if not alive(pid):
            break
        time.sleep(0.1)
    assert not alive(pid)


def test_the_memory_limit_is_kept(run):
    """An allocation beyond it fails, and is an error like any other."""
    with pytest.raises(FreeFemError):
        run("real[int] x(100000000); x = 1;", Limits(wall_time=30, memory=700))
    run("real[int] x(1000000); x = 1;", Limits(wall_time=30, memory=700))


def test_no_core_file_is_left(run, tmp_path):
    with pytest.raises(FreeFemError, match="SIGSEGV"):
        run('exec("kill -SEGV $PPID; sleep 1");')
    assert not list(tmp_path.glob("core*"))


def test_without_freefem_the_message_says_what_to_do(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(FreeFemError, match=r"FreeFem\+\+ is not on PATH; \./setup\.sh"):
        freefem.executable()


def test_environment_searches_our_includes_first(monkeypatch):
    monkeypatch.setenv("FF_INCLUDEPATH", "/theirs")
    monkeypatch.setenv("FF_LOADPATH", "/their/plugins")
    found = freefem.environment()
    assert found["FF_INCLUDEPATH"] == f"{PATH};;/theirs"
    assert found["FF_LOADPATH"] == "/their/plugins"
    assert found["OMP_NUM_THREADS"] == found["OPENBLAS_NUM_THREADS"] == "1"
    assert found["PATH"] == os.environ["PATH"]


def test_a_semicolon_in_a_path_divides_nothing(run, tmp_path):
    includes = tmp_path / "a;b"
    includes.mkdir()
    (includes / "there.idp").write_text("int there = 3;\n")
    run('include "there.idp"\nofstream out("found.txt"); out << there;', includes=[includes])
    assert (tmp_path / "found.txt").read_text() == "3"


def test_command_is_a_list_without_a_shell():
    given = freefem.command(Path("solid.edp"), {"mesh": "a b;c.msh", "kappa": 1000.0, "count": 3})
    assert given[1:5] == ["-nw", "-v", "0", "solid.edp"]
    assert given[5:] == ["-mesh", "a b;c.msh", "-kappa", "1000.0", "-count", "3"]


def test_tail_of_a_log(tmp_path):
    log = tmp_path / "log"
    assert freefem.tail(log) == ""
    log.write_bytes(b"\xff\n" + b"\n".join(str(k).encode() for k in range(100)))
    assert freefem.tail(log).splitlines() == [str(k) for k in range(85, 100)]


def test_what_a_program_says_of_its_cost(run, tmp_path):
    """Its own peak of memory is taken before that of all children of this process."""
    usage = run(
        'ofstream out("cost.csv");\n'
        'out << "name,value" << endl << "factor_seconds,0.25" << endl;\n'
        'out << "unknowns,62" << endl << "peak_memory,12.5" << endl;'
    )
    assert usage.parts == {"factor_seconds": 0.25, "unknowns": 62}
    assert usage.peak_memory == 12.5
    both = usage + usage
    assert both.parts == {"factor_seconds": 0.5, "unknowns": 62}
    assert both.peak_memory == 12.5
    assert both.seconds == 2 * usage.seconds


def test_our_clock_is_right_and_no_call_of_the_kernel(run, tmp_path, monkeypatch):
    """FreeFEM reads it twice for every statement in braces."""
    assert freefem.CLOCK.is_file(), "./setup.sh compiles it"
    text = (
        "int n = 0; for (int i = 0; i < 100000; ++i) { ++n; --n; }\n"
        'system("sleep 0.5"); ofstream out("found.txt"); out << clock();'
    )

    def used():
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_stime
        usage = run(text)
        said = float((tmp_path / "found.txt").read_text())
        return (
            usage.cpu_seconds,
            said,
            resource.getrusage(resource.RUSAGE_CHILDREN).ru_stime - before,
        )

    spent, said, system = used()
    assert said == pytest.approx(spent, rel=0.2)  # what is slept is not used
    monkeypatch.setattr(freefem, "CLOCK", tmp_path / "none")
    assert system < 0.5 * used()[2]


@pytest.mark.parametrize("folder", ["a b", "a:b"])
def test_a_clock_whose_path_divides_is_not_loaded(monkeypatch, tmp_path, folder):
    monkeypatch.setenv("LD_PRELOAD", "theirs.so")
    for name, loaded in ((folder, "theirs.so"), ("c;d", f"theirs.so {tmp_path}/c;d/clock.so")):
        clock = tmp_path / name / "clock.so"
        clock.parent.mkdir()
        clock.touch()
        monkeypatch.setattr(freefem, "CLOCK", clock)
        assert freefem.environment()["LD_PRELOAD"] == loaded


def test_the_check_finds_nothing_wrong():
    start = time.monotonic()
    freefem.check()
    assert time.monotonic() - start < 2


def test_the_check_loads_what_the_models_load():
    loads = {
        name: set(re.findall(r'^load "(\w+)"', path.read_text(), re.MULTILINE))
        for path in PATH.parent.rglob("*.?dp")
        for name in [path.name]
    }
    assert loads.pop("check.edp") == set().union(*loads.values())


@pytest.mark.parametrize(
    ("script", "said"),
    [
        ("echo rubbish", "does not work. It does not add 1 and 1: rubbish"),
        ("head -c 10000 /dev/urandom", "does not add 1 and 1"),
        ("true", "it says nothing"),
        ("exit 3", "status 3"),
        ("kill -SEGV $$", "SIGSEGV"),
        ("echo Load error: Element_QF; exit 2", "does not find its plugin Element_QF"),
        ("exec sleep 60", "hangs"),
    ],
)
def test_a_broken_freefem_is_found(tmp_path, monkeypatch, script, said):
    program = tmp_path / "FreeFem++"
    program.write_text(f"#!/bin/sh\n{script}\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:{os.environ['PATH']}")
    monkeypatch.setattr(freefem, "CHECK_TIME", 0.5)
    with pytest.raises(FreeFemError) as found:
        freefem.check()
    assert said in str(found.value)
    assert str(program) in str(found.value)
    assert "\n" not in str(found.value)
    assert len(str(found.value)) < 400


def test_a_freefem_without_plugins_is_found(tmp_path, monkeypatch):
    monkeypatch.setenv("FF_LOADPATH", str(tmp_path))
    with pytest.raises(FreeFemError, match=r"plugin gmsh.*setup\.sh"):
        freefem.check()


def test_a_freefem_that_cannot_be_started_is_found(tmp_path, monkeypatch):
    program = tmp_path / "FreeFem++"
    program.write_bytes(b"\x7fELF")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(FreeFemError, match=r"cannot be run \(Exec format error\)"):
        freefem.check()


def test_a_large_process_can_start_a_small_one(tmp_path):
    """The limit is that of FreeFEM, not of the process that starts it."""
    around = mmap.mmap(-1, 2 * LIMITS.memory * 2**20, flags=mmap.MAP_PRIVATE)
    program = tmp_path / "program.edp"
    program.write_text("real[int] x(1000);\n")
    freefem.run(program, {}, tmp_path, tmp_path / "log.txt", LIMITS)
    program.write_text("real[int] x(400000000); x = 1;\n")  # 3.2 GB
    with pytest.raises(FreeFemError):
        freefem.run(program, {}, tmp_path, tmp_path / "log.txt", LIMITS)
    around.close()


def test_the_limit_of_memory_is_the_last_that_a_process_gets(monkeypatch):
    """What a copy of a large process does behind it may find no memory."""
    given = []
    monkeypatch.setattr(resource, "setrlimit", lambda kind, _: given.append(kind))
    freefem._limit(LIMITS)
    assert sorted(given[:-1]) == sorted([resource.RLIMIT_FSIZE, resource.RLIMIT_CORE])
    assert given[-1] == resource.RLIMIT_AS
