"""Judges states by what thread and rubber bear (workflow/study/limits.py), when they are gathered.

A state beyond a limit is ``overstrained``, one beyond the tests to which the law of its rubber was
fitted ``extrapolated``, and its note says by what. Where no strength of the
thread is given, states with threads stretched by more than 5 % have a note and no flag.
"""

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np

from solver.case import Case
from solver.effects import Stretch
from solver.record import Solution
from solver.status import Flag
from solver.threads import thread_law
from workflow.study.limits import Limits

LONG = 1.05  # thread stretch that is worth a word: few fibres bear more
UNKNOWN = "no thread_strength is given"


def judged(case: Case, solution: Solution, limits: Limits) -> Solution:
    """The solution with flags and notes of the states that go beyond a limit."""
    flags, notes = list(solution.flags), list(solution.notes)
    for number, (flag, said) in enumerate(_verdicts(case, solution, limits)):
        flags[number] = flags[number] | flag
        notes[number] = "; ".join(filter(None, [notes[number], *said]))
    return replace(solution, flags=flags, notes=notes)


def _verdicts(
    case: Case, solution: Solution, limits: Limits
) -> Iterable[tuple[frozenset[Flag], list[str]]]:
    """Flag and sentences of every state; NaN is beyond no limit."""
    stretches = solution.states["thread_stretch_max"]
    rubber = solution.states["rubber_stretch_max"]
    tension = np.full_like(stretches, np.nan)
    if case.thread is not None and case.effects.stretch is Stretch.ELASTIC:
        width = case.numerics.slack.width_of(case.thread)
        law = thread_law.tension(case.effects.threads, width, stretches)
        tension = case.thread.stiffness * law
    strength, limit = limits.thread_strength, limits.stretch_limit
    for number, stretch in enumerate(stretches):
        beyond, said = [], []
        if strength is not None and tension[number] > strength:
            beyond.append(f"thread tension {tension[number]:.3g} N, of {strength:g} N")
        if limit is not None and rubber[number] > limit:
            beyond.append(f"rubber stretch {rubber[number]:.3g}, of {limit:g}")
        fitted = limits.fitted_range
        outside = fitted is not None and rubber[number] > fitted[1]
        if fitted is not None and outside:
            said.append(
                f"rubber stretch {rubber[number]:.3g}; its law was fitted up to {fitted[1]:g}"
            )
        if strength is None and stretch > LONG:
            said.append(_stretched(stretch))
        if limits.room and np.isfinite(solution.states["force"][number]):
            said.append(limits.room)
        flags = {Flag.OVERSTRAINED: beyond, Flag.EXTRAPOLATED: outside}
        yield frozenset(flag for flag, holds in flags.items() if holds), beyond + said


def summary(curves: Iterable[Any]) -> dict[str, str]:
    """What to say of the strain of the cases of curves, by key; nothing of most."""
    found: dict[str, list[str]] = {}
    for curve in curves:
        solution = curve.solution
        stretch = np.nan_to_num(solution.states["thread_stretch_max"])
        beyond = [k for k, flags in enumerate(solution.flags) if Flag.OVERSTRAINED in flags]
        long = [k for k, note in enumerate(solution.notes) if UNKNOWN in note]
        for states, what in ((beyond, "are overstrained"), (long, "have long threads")):
            if states:
                worst = max(states, key=stretch.__getitem__)
                note = solution.notes[worst] if states is beyond else _stretched(stretch[worst])
                found.setdefault(curve.key, []).append(
                    f"{len(states)} of {len(solution.notes)} states of {curve.place.muscle} "
                    f"{what}, at most: {note}"
                )
    return {key: ". ".join(dict.fromkeys(said)) for key, said in found.items()}


def _stretched(stretch: float) -> str:
    return f"threads stretched to {stretch:.3g}; {UNKNOWN}"
