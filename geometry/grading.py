"""Where the nodes lie along the axis: the zones that all meshes of the half muscle share.

::

    Z = 0            body              graded           L/2   clamp   L/2 + cap_length
      |-------|-------|-------|-----|----|---|--|-|||-|-|-|
         steps near body_step   neighbours differ    thirds of the ramp,
                                by growth            then steps near cap_step

Nearly all of the error of a coarse mesh arises where a clamp takes hold, on its ramp. Steps are
relative to the muscle, so that a muscle scaled by a factor has the mesh scaled by it.
"""

import math
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from geometry.muscle import ONE, Muscle
from geometry.refusal import Refusal, is_count, is_number

OF_WALL = ONE | {"relative_to": "wall thickness"}
OF_DIAMETER = ONE | {"relative_to": "inner diameter"}
MIN_INTERVALS = 2  # over the half length, however short the muscle
RAMP = 1.0  # length over which a clamp takes hold, by default [wall thickness]
RAMP_INTERVALS = 3  # at least
MAX_INTERVALS = 10_000  # in a zone: more is a slip of the pen, not a mesh


class UnbuildableMesh(Refusal):
    """No such mesh can be built."""


@dataclass(frozen=True, kw_only=True)
class Grading:
    """Step sizes along the axis. With a growth of 1 the body's step goes on to the cap.

    ``refinement`` m cuts every interval of m = 1 into m, with the m-th root of the growth in the
    graded zone. So the nodes of m are among those of 2m, and m = 1, 2, 3, 4 are one family
    of meshes for Richardson extrapolation.

    Raises
    ------
    UnbuildableMesh
        Naming the field, its value and what is allowed.
    """

    cap_step: float = field(metadata=OF_WALL)
    growth: float = field(metadata=ONE)  # ratio of neighbouring steps
    body_step: float = field(metadata=OF_DIAMETER)
    refinement: int = field(default=1, metadata=ONE)

    def __post_init__(self) -> None:
        for name in ("cap_step", "body_step"):
            value = getattr(self, name)
            if not (is_number(value) and value > 0):
                raise UnbuildableMesh(name, value, "a finite number > 0")
        if not (is_number(self.growth) and self.growth >= 1):
            raise UnbuildableMesh("growth", self.growth, "a finite number >= 1")
        if not is_count(self.refinement):
            raise UnbuildableMesh("refinement", self.refinement, "an integer >= 1")

    def half_length_stations(self, muscle: Muscle) -> NDArray[np.float64]:
        """Z of the nodes from mid-length to the cap, 0 and L/2 among them exactly [mm]."""
        half = muscle.length / 2
        body, graded = self._intervals(muscle)
        graded_length = self._graded_length(muscle, graded) if body else half
        m = self.refinement
        from_cap = graded_length * _geometric(self.growth, graded, m)
        stations = half - from_cap[::-1] if graded else np.array([half])
        if body:
            start = half - graded_length if graded else half
            stations = np.concatenate([np.linspace(0, start, body * m + 1)[:-1], stations])
        stations[0], stations[-1] = 0.0, half
        return stations

    def clamp_stations(self, muscle: Muscle, ramp: float = RAMP) -> NDArray[np.float64]:
        """Z of the nodes beyond L/2, to L/2 + cap_length [mm].

        The ramp, in wall thicknesses, is cut into three or more. At its end the springs are stiff,
        at twice its length the pressure has faded: there, and at three times, are nodes too.

        Raises
        ------
        UnbuildableMesh
            If the muscle has no cap length, or the ramp is no length.
        """
        if not (is_number(ramp) and ramp > 0):
            raise UnbuildableMesh("ramp", ramp, "a finite number > 0 (wall thickness)")
        if muscle.cap_length == 0:
            raise UnbuildableMesh("cap_length", 0, "more than 0 where the end is a clamp (mm)")
        length, end, step = ramp * muscle.wall_thickness, muscle.cap_length, self._cap_step(muscle)
        inside = [k * length for k in (1, 2, 3) if k * length < (1 - 1e-9) * end]
        knots = [0.0, *inside, end]
        if len(knots) > 3 and knots[-1] - knots[-2] < length / RAMP_INTERVALS:
            del knots[-2]  # no sliver at the end; but the ramp ends at a node
        counts = [max(1, round((b - a) / step)) for a, b in pairwise(knots)]
        counts[0] = max(RAMP_INTERVALS, counts[0])
        self._refuse_many("cap_step", sum(counts))
        steps = [
            np.linspace(a, b, count * self.refinement + 1)[1:]
            for (a, b), count in zip(pairwise(knots), counts, strict=True)
        ]
        return muscle.length / 2 + np.concatenate(steps)

    def _intervals(self, muscle: Muscle) -> tuple[int, int]:
        """Intervals of the body and of the graded zone, at refinement 1."""
        half = muscle.length / 2
        cap, body = self._cap_step(muscle), self.body_step * muscle.inner_diameter
        full = math.ceil(math.log(body / cap) / math.log(self.growth)) if self.growth > 1 else 0
        self._refuse_many("growth", full)
        self._refuse_many("body_step", half / body)
        body_count = round((half - self._graded_length(muscle, full)) / body)
        if full == 0:
            return max(MIN_INTERVALS, body_count), 0
        if body_count >= 1:
            return body_count, full
        # Too short for the full zone: it alone fills the half length, and ends earlier.
        fitting = math.ceil(math.log1p(half / cap * (self.growth - 1)) / math.log(self.growth))
        return 0, max(MIN_INTERVALS, min(fitting, full))

    def _refuse_many(self, name: str, count: float) -> None:
        """Refuse the setting of this name if it asks for too many intervals."""
        if count * self.refinement > MAX_INTERVALS:
            allowed = (
                f"what leads to at most {MAX_INTERVALS} steps ({count * self.refinement:.0f} here)"
            )
            raise UnbuildableMesh(name, getattr(self, name), allowed)

    def _cap_step(self, muscle: Muscle) -> float:
        """Step at the cap, never above that of the body [mm]."""
        return min(self.cap_step * muscle.wall_thickness, self.body_step * muscle.inner_diameter)

    def _graded_length(self, muscle: Muscle, count: int) -> float:
        """Length of a graded zone of ``count`` intervals which begins with the cap's step [mm]."""
        return self._cap_step(muscle) * sum(self.growth**k for k in range(count))


def _geometric(growth: float, count: int, refinement: int) -> NDArray[np.float64]:
    """Points of [0, 1] whose ``count`` intervals grow by ``growth``, each cut into refinement."""
    exponents = np.arange(count * refinement + 1) / refinement
    if growth == 1 or count == 0:
        return exponents / max(count, 1)
    return np.asarray((growth**exponents - 1) / (growth**count - 1))
