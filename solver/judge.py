"""What has been solved, judged: the status of every state and of the case, each with its reason."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from solver import zero_force
from solver.case import Case
from solver.load_path import PathKind
from solver.record import Solution
from solver.status import CaseStatus, StateStatus, case_status, state_status

LIMITS = ("fold", "asymptote", "crumpling", "overhang")  # kinds of limit that a reason begins with
States = dict[str, NDArray[np.float64]]


def judged(
    case: Case,
    states: States,
    *,
    ended: CaseStatus | None = None,
    reason: str = "",
    searched: tuple[float, float] | None = None,
    unknowns: int = 0,
) -> Solution:
    """The solution of a case that has these states.

    ``ended`` is how the solver ended if not by itself, ``reason`` why its way ended early;
    ``searched`` says between which ends a state of zero force was looked for. What became of that
    state does not enter the status of the case.
    """
    count = len(case.path.stops)
    each = state_status(case.path.kind, states)
    aside = ""  # what ended the search for zero force when the stops were done
    if ended and case.path.zero_force and np.isfinite(states["force"][:count]).all():
        ended, aside = None, reason
    status = ended or case_status(each[:count], reason.startswith(LIMITS))
    if status is CaseStatus.CONVERGED:
        reason = ""
    if status is CaseStatus.INVALID_STATE:
        bad = each[:count].count(StateStatus.INVALID_STATE)
        reason = f"{bad} of {count} states are turned inside out somewhere"
    notes = _notes(case.path.kind, states, each, reason)
    if case.path.zero_force:
        each[-1], note = zero_force.judge(case, states, each[-1], searched)
        notes[-1] = aside or note or notes[-1]
    return Solution(
        status=status,
        reason=reason,
        states=states,
        state_status=each,
        notes=notes,
        unknowns=unknowns,
    )


def _notes(kind: PathKind, states: States, status: Sequence[StateStatus], reason: str) -> list[str]:
    """Why each state is not simply converged."""

    def note(k: int) -> str:
        if status[k] is StateStatus.NOT_REACHED:
            return reason
        if status[k] is StateStatus.INVALID_STATE:
            smallest = {
                "det F at a quadrature point": states["min_det_f"][k],
                "det F at a corner": states["min_det_f_nodes"][k],
                "what must stay positive": states["margin"][k],
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
