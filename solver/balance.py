"""Whether the work done on a muscle in time is what it has stored and dissipated.

All three are found apart from each other: the work from loads and their ways, the stored energy
from the strains, the dissipated from the internal tensors of the rubber. What is between them is
the error of the steps of time, and falls by four when those are halved.
"""

import numpy as np
from numpy.typing import NDArray

from geometry.readable import plain
from solver.case import Case

MOST = 0.02  # of what a cycle dissipates
LEAST = 0.01  # of the work that goes to and fro in it: what counts as dissipated at least


def errors(case: Case, states: dict[str, NDArray[np.float64]]) -> list[tuple[float, float]]:
    """Of every cycle: work less what was stored and dissipated, and what is dissipated [N mm]."""
    history = case.path.history
    if history is None:
        return []
    found = []
    for first, last in history.cycles():
        here = slice(first, last + 1)
        work, stored, lost = (states[name][here] for name in ("work", "energy", "dissipated"))
        off = (work[-1] - work[0]) - (stored[-1] - stored[0]) - (lost[-1] - lost[0])
        moved = LEAST * np.abs(np.diff(work)).sum()
        found.append((float(off), float(max(lost[-1] - lost[0], moved))))
    return found


def unbalanced(case: Case, states: dict[str, NDArray[np.float64]]) -> str:
    """Which cycle is not balanced, and by how much; empty if all are, or nothing can be lost."""
    for number, (off, lost) in enumerate(errors(case, states), 1):
        if (case.remembers or case.rubs) and not abs(off) <= MOST * lost:
            return (
                f"steps too long in time: in cycle {number} work differs by {plain(abs(off), 2)} N "
                f"mm from what is stored and dissipated, of {plain(lost, 3)} N mm; more samples"
            )
    return ""
