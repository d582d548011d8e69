"""What a state and a case can be, and the rules that decide it, in one place."""

from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from solver.load_path import Control, PathKind


class StateStatus(StrEnum):
    """Of one recorded state."""

    CONVERGED = "converged"
    UNSTABLE = "unstable"  # in equilibrium, but the muscle would leave it
    INVALID_STATE = "invalid_state"  # in equilibrium, but turned inside out somewhere
    NOT_REACHED = "not_reached"
    NO_ROOT = "no_root"  # there is no state of zero force where it was looked for
    NOT_ASKED = "not_asked"  # of no record: in a table of all, where nobody asked for a state


VALID = (StateStatus.CONVERGED, StateStatus.UNSTABLE)  # whose numbers are those of the muscle


class Flag(StrEnum):
    """What a user should know of a state beside its status; several may hold."""

    OVERSTRAINED = "overstrained"  # beyond a limit of the material
    EXTRAPOLATED = "extrapolated"  # beyond the tests to which the law of the rubber was fitted
    SMOOTHED = "smoothed"  # the smoothing of the slack law carries a share of the force


class CaseStatus(StrEnum):
    """Of a whole path."""

    CONVERGED = "converged"  # every stop reached with a valid state
    LIMIT_POINT = "limit_point"  # no equilibrium further on; the reason names its kind
    STALLED = "stalled"  # Newton needs steps below the smallest; why is not known
    INVALID_STATE = "invalid_state"  # every stop reached, but not every state is valid
    UNBALANCED = "unbalanced"  # every stop reached, but steps of time too long for their energy
    MESH_FAILED = "mesh_failed"
    TIMEOUT = "timeout"
    SOLVER_ERROR = "solver_error"
    NOT_SOLVED = "not_solved"  # there is no record yet
    NOT_ASKED = "not_asked"  # in a table of all, where nobody asked for a curve


def state_status(kind: PathKind, states: dict[str, NDArray[np.float64]]) -> list[StateStatus]:
    """Status of every state of a path.

    Unstable modes are counted at fixed contraction and pressure. Under a dead load (isotonic) a
    muscle whose force falls when it is drawn out is unstable as well.
    """
    reached = np.isfinite(states["force"])
    smallest = [states[name] for name in ("min_det_f", "min_det_f_nodes", "margin")]
    valid = np.min(smallest, axis=0) > 0
    modes = np.nan_to_num(states["unstable_modes"])  # NaN where the model counts none
    if kind.held is Control.FORCE:
        modes = modes + (states["stiffness"] < 0)
    return [
        StateStatus.NOT_REACHED
        if not r
        else StateStatus.INVALID_STATE
        if not v
        else StateStatus.UNSTABLE
        if m > 0
        else StateStatus.CONVERGED
        for r, v, m in zip(reached, valid, modes, strict=True)
    ]


def case_status(states: list[StateStatus], limited: bool = False) -> CaseStatus:
    """Status of a path whose solver came to its end by itself.

    ``limited`` says that the branch of states was followed to an extremum of the swept control.
    """
    if StateStatus.NOT_REACHED in states:
        return CaseStatus.LIMIT_POINT if limited else CaseStatus.STALLED
    if StateStatus.INVALID_STATE in states:
        return CaseStatus.INVALID_STATE
    return CaseStatus.CONVERGED
