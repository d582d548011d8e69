"""How a run goes: cases done, failed and running, and the time left; in the terminal and a log.

While a run lasts, the terminal shows these lines instead of Snakemake's own on every job, which
stay in Snakemake's log (.snakemake/log). Warnings and errors are shown as ever.
"""

import json
import logging
import threading
import time
from collections.abc import Iterable, Mapping
from pathlib import Path
from statistics import mean
from typing import Any, TextIO

from snakemake_interface_logger_plugins.common import LogEvent

from workflow.run.failures import ANSWERS

COST = Path("results/cost")
INTERVAL = 5.0  # s between two lines, if something happened
SILENCE = 60.0  # s after which there is a line even if nothing did
CHATTER = {LogEvent.JOB_INFO, LogEvent.JOB_STARTED, LogEvent.JOB_FINISHED, LogEvent.PROGRESS}
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
        self.running: dict[int, tuple[str, str, float]] = {}  # job: message, case, since when
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
        if event == LogEvent.JOB_INFO:
            case = said.wildcards.get("case", "") if said.rule_name == "solve" else ""
            message = said.rule_msg or said.rule_name
            self.running[said.jobid] = message, case, time.monotonic()
        elif event == LogEvent.JOB_FINISHED:
            self._finish(said.job_id)
        elif event == LogEvent.JOB_ERROR:
            self.running.pop(said.jobid, None)
        else:
            return
        self.changed = True

    def _finish(self, job: int) -> None:
        message, case, since = self.running.pop(job, ("", "", 0.0))
        if case not in self.waiting:
            return
        self.waiting.discard(case)
        self.seconds.setdefault(self.cases[case], []).append(time.monotonic() - since)
        status, _ = self._outcome(case)
        if _is_failure(status):
            self.failed += 1
            self._say(f"failed: {message.removeprefix('Solving ')}: {status}")

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
        """Where the run stands."""
        done = len(self.cases) - len(self.waiting)
        parts = [f"{done} of {len(self.cases)} cases solved, {self.failed} failed"]
        left = self.seconds_left()
        if self.waiting and left is not None:
            parts.append(f"about {_duration(left)} left to solve")
        if self.running:
            parts.append("now: " + ", ".join(message for message, _, _ in self.running.values()))
        return "; ".join(parts)

    def close(self) -> None:
        """Say how it ended."""
        if not self.ended.is_set():
            self.ended.set()
            self.running.clear()
            self._say(self.line())
            self.log.close()
        super().close()

    def _tick(self) -> None:
        while not self.ended.wait(INTERVAL):
            assert self.lock is not None  # every handler has one
            with self.lock:
                silent = time.monotonic() - self.spoke > SILENCE
                if not self.ended.is_set() and (self.changed or silent):
                    self._say(self.line())

    def _say(self, text: str) -> None:
        line = f"{time.strftime('%H:%M:%S')}  {text}\n"
        self.changed, self.spoke = False, time.monotonic()
        for stream in filter(None, (self.log, self.terminal)):
            try:
                stream.write(line)
                stream.flush()
            except OSError:
                pass  # a full disk or a closed terminal is no reason to stop solving


def _is_failure(status: str) -> bool:
    return status != "" and status not in ANSWERS


def _duration(seconds: float) -> str:
    if seconds < 90:
        return f"{max(5 * round(seconds / 5), 5)} s"
    if seconds < 90 * 60:
        return f"{round(seconds / 60)} min"
    return f"{seconds / 3600:.1f} h"
