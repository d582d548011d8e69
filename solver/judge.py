"""What has been solved, judged: the status of every state and of the case, each with its reason."""

from collections.abc import Collection, Sequence

import numpy as np
from numpy.typing import NDArray

from solver import balance, zero_force
from solver.case import Case
from solver.load_path import CONTRACTION_LIMITS, PathKind
from solver.models import MODELS
from solver.record import Solution
from solver.status import VALID, CaseStatus, StateStatus, case_status, state_status

LIMITS = ("fold", "asymptote", "crumpling", "overhang")  # kinds of limit that a reason begins with
LOST = "reached through a state that is turned inside out, or across a snap of the muscle"
TOO_FAR = (
    f"a contraction of {{:.3g}} % is outside {100 * CONTRACTION_LIMITS[0]:g} to "
    f"{100 * CONTRACTION_LIMITS[1]:g} %, where a muscle can be held: another branch"
)
States = dict[str, NDArray[np.float64]]


def judged(
    case: Case,
    states: States,
    *,
    ended: CaseStatus | None = None,
    reason: str = "",
    searched: tuple[float, float] | None = None,
    lost: Collection[int] = (),
    unknowns: int = 0,
) -> Solution:
    """The solution of a case that has these states.

    ``ended`` is how the solver ended if not by itself, ``reason`` why its way ended early;
    ``searched`` says between which ends a state of zero force was looked for, ``lost`` which
    states lie behind one that is invalid or a snap. What became of the state of zero force does not
    enter the status of the case.
    """
    count = len(case.path.stops)
    each = state_status(case.path.kind, states)
    lost = {k for k in lost if each[k] in VALID}
    far = {k for k in _too_far(case, states) if each[k] in VALID}
    for k in lost | far:
        each[k] = StateStatus.INVALID_STATE
    zero_ended = ""  # why the search for zero force ended, where all stops were reached
    if ended and case.path.zero_force and np.isfinite(states["force"][:count]).all():
        ended, zero_ended = None, reason
    status = ended or case_status(each[:count], reason.startswith(LIMITS))
    if status is CaseStatus.CONVERGED and (off := balance.unbalanced(case, states)):
        status, reason = CaseStatus.UNBALANCED, off
    if status is CaseStatus.CONVERGED:
        reason = ""
    if status is CaseStatus.INVALID_STATE:
        bad = each[:count].count(StateStatus.INVALID_STATE)
        what = "turned inside out somewhere" + (", or lie behind such a state" if lost else "")
        what += ", or beyond the contractions that can be asked for" if far else ""
        reason = f"{bad} of {count} states are {what}"
    notes = _notes(case.path.kind, states, each, reason)
    for k in lost | far:
        notes[k] = LOST if k in lost else TOO_FAR.format(100 * states["contraction"][k])
    for k, remark in enumerate(MODELS[case.model].remarks(case, states)):
        notes[k] = "; ".join(filter(None, (notes[k], remark)))
    if case.path.zero_force:
        each[-1], note = zero_force.judge(case, states, each[-1], searched)
        notes[-1] = zero_ended or note or notes[-1]
        if each[-1] in VALID and _among_invalid(case, states, each):
            each[-1], notes[-1] = StateStatus.INVALID_STATE, LOST
    return Solution(
        status=status,
        reason=reason,
        states=states,
        state_status=each,
        notes=notes,
        unknowns=unknowns,
    )


def _too_far(case: Case, states: States) -> set[int]:
    """States under a load whose contraction is none that other paths may ask for.

    A tube that is blown up jumps to another branch there, of many times its length.
    """
    if case.path.kind is not PathKind.ISOTONIC:
        return set()
    low, high = CONTRACTION_LIMITS
    contraction = states["contraction"]
    return set(map(int, np.flatnonzero((contraction < low) | (contraction > high))))


def _among_invalid(case: Case, states: States, status: Sequence[StateStatus]) -> bool:
    """Whether all stops next to the state of zero force are invalid."""
    stops = case.path.stops
    above = int(np.searchsorted(stops, states[case.path.kind.swept.variable][-1]))
    near = [status[k] for k in (above - 1, above) if 0 <= k < len(stops)]
    return all(s is StateStatus.INVALID_STATE for s in near)


def _notes(kind: PathKind, states: States, status: Sequence[StateStatus], reason: str) -> list[str]:
    """Why each state is not simply converged."""

    def note(k: int) -> str:
        if status[k] is StateStatus.NOT_REACHED:
            return reason
        if status[k] is StateStatus.INVALID_STATE:
            smallest = {
                "det F at a quadrature point": states["min_det_f"][k],
                "det F at a corner": states["min_det_f_nodes"][k],
                "margin": states["margin"][k],
            }
            worst = min(smallest, key=lambda name: smallest[name])
            return f"turned inside out: the smallest {worst} is {smallest[worst]:.3g}"
        if status[k] is StateStatus.UNSTABLE:
            modes = np.nan_to_num(states["unstable_modes"][k])
            if modes > 0:
                return f"{modes:g} unstable modes at fixed contraction and pressure"
            return "under a dead load, as its force falls with length"
        return ""

    return [note(k) for k in range(len(status))]
