"""How a run goes: cases done, failed and running, and the time left; in the terminal and a log.

While a run lasts, the terminal shows these lines instead of Snakemake's own on every job, which
stay in Snakemake's log (.snakemake/log). Warnings and errors are shown as ever.
"""

import json
import logging
import re
import threading
import time
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from statistics import mean
from typing import Any, TextIO

from snakemake_interface_logger_plugins.common import LogEvent

from workflow.run.batches import BEGINS, NOT_SOLVED
from workflow.run.failures import ANSWERS
from workflow.study.folders import COST

INTERVAL = 5.0  # s between two lines, if something happened
SILENCE = 60.0  # s after which there is a line even if nothing did
CHATTER = {LogEvent.JOB_INFO, LogEvent.JOB_STARTED, LogEvent.JOB_FINISHED, LogEvent.PROGRESS}
ON_CLUSTER = re.compile(r"SLURM-job '(\w+)' failed.* SLURM status is: '(\w+)'", re.DOTALL)
WHY_ENDED = {  # a job of a cluster, by its state there
    "CANCELLED": "was cancelled",
    "NODE_FAIL": "was lost with its node",
    "OUT_OF_MEMORY": "needed more memory than it had; --set-resources solve:mem_mb=MB gives more",
    "TIMEOUT": "ended at its time limit; --set-resources solve:runtime=MINUTES gives more",
}
PLAIN_CHATTER = ("Select jobs", "Touching output")  # messages that are no events


def is_no_chatter(record: logging.LogRecord) -> bool:
    """Whether a message of Snakemake is worth a line in the terminal; a filter of its handler."""
    event = getattr(record, "event", None)
    return event not in CHATTER and not str(record.msg).startswith(PLAIN_CHATTER)


class Progress(logging.Handler):
    """Follows a run by what Snakemake logs of its jobs.

    Parameters
    ----------
    cases : model of every case of the run by key, solved before or not
    waiting : keys of those that are to be solved
    cores : jobs at a time
    log : file that gets every line
    terminal : stream that gets every line too, if any
    cost : folder of the cost files, which have the status of a solved case
    """

    def __init__(
        self,
        cases: Mapping[str, str],
        waiting: Iterable[str],
        *,
        cores: int,
        log: Path,
        terminal: TextIO | None,
        cost: Path = COST,
    ) -> None:
        super().__init__()
        self.cases, self.waiting, self.cores = cases, set(waiting), cores
        self.cost, self.terminal = cost, terminal
        self.running: dict[int, str] = {}  # messages of jobs
        self.batches: dict[int, _Batch] = {}
        self.before: dict[str, list[float]] = {}  # seconds by model, of earlier runs
        self.seconds: dict[str, list[float]] = {}  # of this one
        self.failed = 0
        for key, model in cases.items():
            status, seconds = self._outcome(key)
            self.before.setdefault(model, []).append(seconds) if status else None
            self.failed += key not in self.waiting and _is_failure(status)
        log.parent.mkdir(parents=True, exist_ok=True)
        self.log = log.open("w", encoding="utf-8")
        self.changed, self.spoke = True, time.monotonic()
        self.ended = threading.Event()
        self.ticker = threading.Thread(target=self._tick, daemon=True)
        self.ticker.start()

    def emit(self, record: logging.LogRecord) -> None:
        """Take notice of a job that began, ended or broke off."""
        said: Any = record  # with what Snakemake adds to it
        event = getattr(record, "event", None)
        if event == LogEvent.JOB_INFO and said.rule_name == "solve":
            log = Path(said.log[0])
            log.unlink(missing_ok=True)  # of another run
            self.batches[said.jobid] = _Batch(log)
        elif event == LogEvent.JOB_INFO:
            self.running[said.jobid] = said.rule_msg or said.rule_name
        elif event in (LogEvent.JOB_FINISHED, LogEvent.JOB_ERROR):
            job = said.job_id if event == LogEvent.JOB_FINISHED else said.jobid
            self.running.pop(job, None)
            if job in self.batches:
                self._read(self.batches.pop(job))
            if why := _why_ended(getattr(record, "rule_msg", None) or ""):
                self._say(why)
        else:
            return
        self.changed = True

    def look(self) -> None:
        """Take notice of what batches say of their cases."""
        for batch in list(self.batches.values()):
            self._read(batch)

    def _read(self, batch: "_Batch") -> None:
        """Take notice of what cases of a batch have begun and ended."""
        for word, key, label in batch.news():
            self.changed = True
            if word == BEGINS:
                batch.solving[key] = label
                continue
            batch.solving.pop(key, None)
            if key not in self.waiting or word == NOT_SOLVED:
                continue
            self.waiting.discard(key)
            self.seconds.setdefault(self.cases[key], []).append(self._outcome(key)[1])
            if _is_failure(word):
                self.failed += 1
                self._say(f"failed: {label}: {word}")

    def _outcome(self, key: str) -> tuple[str, float]:
        """Status and seconds of a case; empty if it has not been solved."""
        try:
            found = json.loads((self.cost / f"{key}.json").read_text())
            return str(found["status"]), float(found["total_seconds"])
        except (OSError, ValueError, KeyError, TypeError):
            return "", 0.0

    def seconds_left(self) -> float | None:
        """Estimate for the cases that wait or run; None if no case has been solved yet."""
        known = {
            model: mean(seconds)
            for model, seconds in (self.before | self.seconds).items()
            if seconds
        }
        if not known:
            return None
        any_model = mean(known.values())
        left = sum(known.get(self.cases[key], any_model) for key in self.waiting)
        return left / min(self.cores, max(len(self.waiting), 1))

    def line(self) -> str:
        """Where the run stands; empty where nothing is to be solved and nothing goes on."""
        done = len(self.cases) - len(self.waiting)
        known = f"{done} of {len(self.cases)} cases solved, {self.failed} failed"
        parts = [known] if self.cases else []
        left = self.seconds_left()
        if self.waiting and left is not None:
            parts.append(f"about {_duration(left)} left to solve")
        solving = [
            f"Solving {label}" for b in self.batches.values() for label in b.solving.values()
        ]
        if now := [*solving, *self.running.values()]:
            parts.append("now: " + ", ".join(now))
        return "; ".join(parts)

    def stop(self, why: str) -> None:
        """Say why the run is given up, and nothing more in the terminal."""
        self._say(why)
        self.terminal = None

    def close(self, said: str = "") -> None:
        """Say how it ended, and in the terminal what else there is to say."""
        if not self.ended.is_set():
            self.ended.set()
            self.running.clear()
            self.batches.clear()
            self._say(self.line())
            self.log.close()
            if said and self.terminal:
                print(said, file=self.terminal)
        super().close()

    def _tick(self) -> None:
        while not self.ended.wait(INTERVAL):
            assert self.lock is not None  # every handler has one
            with self.lock:
                self.look()
                silent = time.monotonic() - self.spoke > SILENCE
                if not self.ended.is_set() and (self.changed or silent):
                    self._say(self.line())

    def _say(self, text: str) -> None:
        line = f"{time.strftime('%H:%M:%S')}  {text}\n"
        self.changed, self.spoke = False, time.monotonic()
        for stream in filter(None, (self.log, self.terminal) if text else ()):
            try:
                stream.write(line)
                stream.flush()
            except OSError:
                pass  # a full disk or a closed terminal is no reason to stop solving


class _Batch:
    """What the log of a batch says, read as it grows."""

    def __init__(self, log: Path) -> None:
        self.log, self.read = log, 0  # bytes
        self.solving: dict[str, str] = {}  # labels by key

    def news(self) -> Iterator[tuple[str, str, str]]:
        """Word, key and label of every line that was written since the last look."""
        try:
            with self.log.open("rb") as stream:
                stream.seek(self.read)
                text = stream.read()
        except OSError:
            return
        whole = text[: text.rfind(b"\n") + 1]
        self.read += len(whole)
        for line in whole.decode(errors="replace").splitlines():
            parts = line.split(" ", 3)
            if len(parts) == 4:
                yield parts[1], parts[2], parts[3].rpartition("; ")[0] or parts[3]


def _why_ended(said: str) -> str:
    """How a job of a cluster has ended before its time, by what the executor says; else empty."""
    found = ON_CLUSTER.search(said)
    if not found or found[2] not in WHY_ENDED:
        return ""
    why = f"job {found[1]} of the cluster {WHY_ENDED[found[2]]} ({found[2]})"
    return f"{why}. What it has solved stays; the next run solves the rest."


def _is_failure(status: str) -> bool:
    return status != "" and status not in ANSWERS


def _duration(seconds: float) -> str:
    if seconds < 90:
        return f"{max(5 * round(seconds / 5), 5)} s"
    if seconds < 90 * 60:
        return f"{round(seconds / 60)} min"
    return f"{seconds / 3600:.1f} h"
