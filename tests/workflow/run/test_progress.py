"""What a run says while it goes on."""

import io
import json
import logging

import pytest
from snakemake_interface_logger_plugins.common import LogEvent

from workflow.run import progress
from workflow.run.progress import Progress, is_no_chatter

CASES = {"a": "membrane", "b": "membrane", "c": "solid", "d": "solid"}


def message(event=None, text="", **fields):
    record = logging.LogRecord("snakemake", logging.INFO, "", 0, text, None, None)
    record.__dict__.update(fields, event=event)
    return record


def begin(job, case):
    return message(
        LogEvent.JOB_INFO,
        jobid=job,
        rule_name="solve",
        rule_msg=f"Solving {case}",
        wildcards={"case": case},
    )


def end(job):
    return message(LogEvent.JOB_FINISHED, job_id=job)


@pytest.fixture
def follow(tmp_path):
    """Follows a run of CASES."""
    made = []

    def make(*waiting, cores=1):
        made.append(
            Progress(
                CASES,
                waiting,
                cores=cores,
                log=tmp_path / "logs/progress.log",
                terminal=io.StringIO(),
                cost=tmp_path,
            )
        )
        return made[-1]

    yield make
    for one in made:
        one.close()


def solved(folder, key, status="converged", seconds=2.0):
    text = json.dumps({"status": status, "total_seconds": seconds})
    (folder / f"{key}.json").write_text(text)


def test_counts_and_what_runs(follow, tmp_path):
    run = follow("a", "c")  # b and d were solved before
    assert run.line() == "2 of 4 cases solved, 0 failed"
    run.emit(begin(7, "a"))
    run.emit(
        message(LogEvent.JOB_INFO, jobid=8, rule_name="mesh", rule_msg="Meshing", wildcards={})
    )
    assert run.line() == "2 of 4 cases solved, 0 failed; now: Solving a, Meshing"
    solved(tmp_path, "a")
    run.emit(end(7))
    run.emit(message(LogEvent.JOB_ERROR, jobid=8))
    assert run.line().startswith("3 of 4 cases solved, 0 failed; about")
    assert "now" not in run.line()


def test_a_failed_case_is_named_at_once(follow, tmp_path):
    solved(tmp_path, "d", "timeout")  # before
    solved(tmp_path, "b", "limit_point")  # an answer and no failure
    run = follow("a", "c")
    run.emit(begin(1, "a"))
    solved(tmp_path, "a", "stalled")
    run.emit(end(1))
    assert "failed: a: stalled" in run.terminal.getvalue()
    assert "3 of 4 cases solved, 2 failed" in run.line()


def test_time_left_is_by_model(follow, tmp_path):
    assert follow("a").seconds_left() is None
    solved(tmp_path, "b", seconds=2)
    solved(tmp_path, "d", seconds=10)
    run = follow("a", "c")
    assert run.seconds_left() == pytest.approx(12)
    assert "about 10 s left" in run.line()
    assert follow("a", "c", cores=2).seconds_left() == pytest.approx(6)
    assert follow("a", cores=8).seconds_left() == pytest.approx(2)  # one case, one core


def test_terminal_and_log_say_the_same(follow, tmp_path, monkeypatch):
    monkeypatch.setattr(progress, "INTERVAL", 0.01)
    run = follow("a")
    run.emit(begin(1, "a"))
    while "Solving a" not in run.terminal.getvalue():
        pass
    run.close()
    text = (tmp_path / "logs/progress.log").read_text()
    assert text == run.terminal.getvalue()
    assert text.splitlines()[-1].endswith("3 of 4 cases solved, 0 failed")


def test_what_cannot_be_written_stops_nothing(follow, tmp_path):
    run = follow("a")
    run.log.close()
    run.log = open("/dev/full", "w")  # noqa: SIM115
    run.emit(begin(1, "a"))
    run._say("something")
    (tmp_path / "a.json").write_text("{")
    run.emit(end(1))
    assert run.line() == "4 of 4 cases solved, 0 failed"
    run.log = io.StringIO()


def test_errors_are_no_chatter():
    assert is_no_chatter(message(LogEvent.JOB_ERROR))
    assert is_no_chatter(message(text="Shutting down, this might take some time."))
    assert not is_no_chatter(begin(1, "a"))
    assert not is_no_chatter(message(text="Select jobs to execute..."))
