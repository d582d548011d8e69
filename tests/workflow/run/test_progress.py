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


@pytest.fixture
def batch(tmp_path):
    """A batch of cases: ``begin`` and ``end`` of its job, ``tell`` what its log gets of cases."""

    class Batch:
        log = tmp_path / "batch.log"

        def begin(self, job):
            log, name = [str(self.log)], "Solving 2 of 4 cases"
            return message(LogEvent.JOB_INFO, jobid=job, rule_name="solve", rule_msg=name, log=log)

        def end(self, job):
            return message(LogEvent.JOB_FINISHED, job_id=job)

        def tell(self, word, key, more=""):
            with self.log.open("a") as stream:
                stream.write(f"12:00:00 {word} {key} one {key}{more}\n")

    return Batch()


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


def test_counts_and_what_runs(follow, batch, tmp_path):
    run = follow("a", "c")  # b and d were solved before
    assert run.line() == "2 of 4 cases solved, 0 failed"
    batch.tell("begins", "d")  # another run's
    run.emit(batch.begin(7))
    batch.tell("begins", "a")
    run.emit(message(LogEvent.JOB_INFO, jobid=8, rule_name="muscle", rule_msg="Building"))
    run.look()
    assert run.line() == "2 of 4 cases solved, 0 failed; now: Solving one a, Building"
    solved(tmp_path, "a")
    batch.tell("converged", "a", "; 2.00 s")
    run.look()
    run.emit(message(LogEvent.JOB_ERROR, jobid=8))
    assert run.line().startswith("3 of 4 cases solved, 0 failed; about")
    assert "now" not in run.line()


def test_a_failed_case_is_named_at_once(follow, batch, tmp_path):
    solved(tmp_path, "d", "timeout")  # before
    solved(tmp_path, "b", "limit_point")  # an answer and no failure
    run = follow("a", "c")
    run.emit(batch.begin(1))
    for key, word in (("a", "stalled"), ("c", "not_solved")):
        batch.tell("begins", key)
        batch.tell(word, key, "; 2.00 s")
    run.emit(batch.end(1))
    assert "failed: one a: stalled" in run.terminal.getvalue()
    assert "3 of 4 cases solved, 2 failed" in run.line()  # c will be tried again


@pytest.mark.parametrize(
    ("state", "what"),
    [
        ("TIMEOUT", "ended at its time limit; --set-resources solve:runtime=MINUTES gives more"),
        ("OUT_OF_MEMORY", "needed more memory than it had"),
        ("CANCELLED", "was cancelled"),
    ],
)
def test_how_a_job_of_a_cluster_ended_is_a_sentence(follow, batch, state, what):
    run = follow("a")
    run.emit(batch.begin(1))
    said = f"SLURM-job '12' failed, SLURM status is: '{state}'. Reason: Unknown."
    run.emit(message(LogEvent.JOB_ERROR, jobid=1, rule_msg=said))
    (line,) = run.terminal.getvalue().splitlines()
    assert f"job 12 of the cluster {what}" in line
    assert f"({state}). What it has solved stays; the next run solves the rest." in line


def test_what_a_job_said_of_itself_is_not_said_again(follow, batch):
    run = follow("a")
    run.emit(batch.begin(1))
    run.emit(message(LogEvent.JOB_ERROR, jobid=1, rule_msg="SLURM status is: 'FAILED'."))
    run.emit(message(LogEvent.JOB_ERROR, jobid=1, rule_msg=None))
    assert run.terminal.getvalue() == ""


def test_half_a_line_is_read_when_it_is_whole(follow, batch):
    run = follow("a", "c")
    run.emit(batch.begin(1))
    with batch.log.open("a") as stream:
        stream.write("12:00:00 converged a o")
        stream.flush()
        run.look()
        assert "2 of 4" in run.line()
        stream.write("ne a; 1.00 s\n")
    run.look()
    assert "3 of 4" in run.line()


def test_time_left_is_by_model(follow, tmp_path):
    assert follow("a").seconds_left() is None
    solved(tmp_path, "b", seconds=2)
    solved(tmp_path, "d", seconds=10)
    run = follow("a", "c")
    assert run.seconds_left() == pytest.approx(12)
    assert "about 10 s left" in run.line()
    assert follow("a", "c", cores=2).seconds_left() == pytest.approx(6)
    assert follow("a", cores=8).seconds_left() == pytest.approx(2)  # one case, one core


def test_terminal_and_log_say_the_same(follow, batch, tmp_path, monkeypatch):
    monkeypatch.setattr(progress, "INTERVAL", 0.01)
    run = follow("a")
    run.emit(batch.begin(1))
    batch.tell("begins", "a")
    while "Solving one a" not in run.terminal.getvalue():
        pass
    run.close()
    text = (tmp_path / "logs/progress.log").read_text()
    assert text == run.terminal.getvalue()
    assert text.splitlines()[-1].endswith("3 of 4 cases solved, 0 failed")


def test_what_cannot_be_written_stops_nothing(follow, batch, tmp_path):
    run = follow("a")
    run.log.close()
    run.log = open("/dev/full", "w")  # noqa: SIM115
    run.emit(batch.begin(1))
    run._say("something")
    (tmp_path / "a.json").write_text("{")
    batch.tell("converged", "a", "; 2.00 s")
    run.emit(batch.end(1))
    assert run.line() == "4 of 4 cases solved, 0 failed"
    run.log = io.StringIO()


def test_errors_are_no_chatter(batch):
    assert is_no_chatter(message(LogEvent.JOB_ERROR))
    assert is_no_chatter(message(text="Shutting down, this might take some time."))
    assert not is_no_chatter(batch.begin(1))
    assert not is_no_chatter(message(text="Select jobs to execute..."))


def test_a_run_that_solves_nothing_says_nothing_of_cases(tmp_path):
    log = tmp_path / "progress.log"
    run = Progress({}, (), cores=1, log=log, terminal=None)
    run.emit(message(LogEvent.JOB_INFO, jobid=1, rule_name="map", rule_msg="Tabulating a map"))
    assert run.line() == "now: Tabulating a map"
    run.close()
    assert log.read_text() == ""
