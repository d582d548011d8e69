"""A muscle by ``cylinder``, each state found at once: where to look, before anything is solved."""

import math
from collections.abc import Callable

from solver.effects import Effects
from solver.load_path import CONTRACTION_LIMITS, LoadPath, PathKind
from solver.models.cylinder.direct import between, direct
from solver.models.cylinder.mechanics import Cylinder
from solver.models.cylinder.observe import observed
from workflow.study.contents import StudiedMuscle
from workflow.study.limits import HIGHEST

NAME = "cylinder"
STEP, FIRST, FACTOR = 0.02, 0.05, 1.5  # of contraction; of pressure [MPa], and its growth


class Quick:
    """States of one muscle; 1 to 3 ms each."""

    def __init__(self, studied: StudiedMuscle, effects: Effects | None = None) -> None:
        path = LoadPath(kind=PathKind.ISOBARIC, held=0.0, stops=(0.0,))
        self._cylinder = Cylinder(studied.case(path, NAME, effects=effects or Effects()))

    def state(self, pressure: float, contraction: float) -> dict[str, float] | None:
        """Variables of the state, as in solver/record.py; None where there is none."""
        at = direct(self._cylinder, pressure, contraction)
        return None if at is None else observed(self._cylinder, at)

    def force(self, pressure: float, contraction: float) -> float:
        """Its force [N]; NaN where there is no state."""
        at = direct(self._cylinder, pressure, contraction)
        return math.nan if at is None else self._cylinder.state(at).force

    def contraction(self, pressure: float, force: float) -> float:
        """Contraction at which it has a force, nearest to none; NaN if there is no such."""
        low, high = CONTRACTION_LIMITS

        def off(contraction: float) -> float:
            return self.force(pressure, contraction) - force

        end, step = (high, STEP) if off(0.0) > 0 else (low, -STEP)
        return _root(off, 0.0, lambda x: x + step, end)

    def pressure(self, contraction: float, force: float) -> float:
        """Lowest pressure at which it has a force at a contraction [MPa]; NaN up to ``HIGHEST``."""

        def off(pressure: float) -> float:
            return self.force(pressure, contraction) - force

        return _root(off, 0.0, lambda x: max(FIRST, FACTOR * x), HIGHEST)


def _root(
    off: Callable[[float], float], start: float, further: Callable[[float], float], end: float
) -> float:
    """Where a function first changes its sign on the way from a start to an end."""
    here, value = start, off(start)
    while here != end and value:
        there = further(here)
        there = min(there, end) if end > start else max(there, end)
        beyond = off(there)
        if math.isnan(beyond):
            return math.nan
        if value * beyond <= 0:
            return between(off, *sorted((here, there)))
        here, value = there, beyond
    return math.nan if value else here
