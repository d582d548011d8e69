"""What a tolerance is about: which quantities of a curve, relative to what, and which states count.

Judged is what follows from the controls (the force; under a load the contraction), and of what a
scene asks for the diameters, the volume and the state of zero force. An error is the largest
difference at any stop, as a share of the largest absolute value along the curve; that of the state
of zero force is a share of its own value (where the better model has none, nothing is off). A state
that the better model has and the other has not, or has only turned inside out or held by the
smoothing of the slack law, is a failure: its error is infinite.
"""

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from solver.case import Case
from solver.load_path import ZERO_FORCE
from solver.models import MODELS
from solver.record import Solution
from solver.status import VALID, Flag, StateStatus
from workflow.study.judged_quantities import VARIABLES

Array = NDArray[np.float64]
FOLLOWS, ZERO = "follows", "zero_force"
QUANTITIES = VARIABLES
AT_ZERO = 1e-6  # of the largest control of a path: as good as none


def of_scene(quantities: Iterable[str]) -> tuple[str, ...]:
    """What is judged of a scene that asks for some quantities."""
    asked = set(quantities)
    zero = (ZERO,) if asked & ZERO_FORCE.keys() else ()
    return (FOLLOWS, *(name for name in QUANTITIES if name in asked), *zero)


def variable_of(case: Case, quantity: str) -> str:
    """Of the record; of the state of zero force the control that is swept."""
    if quantity == ZERO:
        return case.path.kind.swept.variable
    return case.path.kind.follows if quantity == FOLLOWS else QUANTITIES[quantity]


def is_valid(solution: Solution) -> NDArray[np.bool_]:
    """Which states may be believed."""
    return np.array([status in VALID for status in solution.state_status])


def is_lost(solution: Solution) -> NDArray[np.bool_]:
    """Which states a rung has not; a curve that is nowhere at zero force lacks none there."""
    none = [status is StateStatus.NO_ROOT for status in solution.state_status]
    return np.asarray(~is_valid(solution) & ~np.array(none))


def is_answer(case: Case, solution: Solution) -> NDArray[np.bool_]:
    """Of these the ones that count: by a model that has a fuller one none that smoothing holds."""
    if not MODELS[case.model].fuller:
        return is_valid(solution)
    return is_valid(solution) & [Flag.SMOOTHED not in flags for flags in solution.flags]


def difference(
    case: Case, solution: Solution, better: Solution, quantity: str, at: Sequence[int] | None = None
) -> float:
    """The error of a curve by a better one, as a share; infinite where states are lost.

    ``at`` are the states of the curve that the better one has, in its order; by default all.
    """
    numbers = np.arange(case.path.states) if at is None else np.asarray(at)
    name, stops = variable_of(case, quantity), len(case.path.stops)
    values, exact = solution.states[name], better.states[name]
    fine = is_valid(better)
    good = is_answer(case, solution)[numbers]
    here = numbers >= stops if quantity == ZERO else numbers < stops
    if (fine & ~good & here).any():
        return float("inf")
    both = fine & good & here
    if not both.any():
        return 0.0 if quantity == ZERO else float("nan")
    off = np.abs(values[numbers] - exact)[both]
    if quantity == ZERO:  # that is at 0 where a muscle pulls as soon as it has any pressure
        own = max(float(np.abs(exact[both][0])), AT_ZERO * max(map(abs, case.path.stops)))
        return float(off[0] / own)
    return float(off.max() / scale(case, solution, quantity))


def scale(case: Case, solution: Solution, quantity: str) -> float:
    """The largest absolute value of a quantity along a curve."""
    values = solution.states[variable_of(case, quantity)][: len(case.path.stops)]
    known = np.abs(values[is_valid(solution)[: len(values)]])
    return float(np.nanmax(known)) if np.isfinite(known).any() else float("nan")
