"""Numerical settings: what changes the error and the cost of a solve, but not the problem."""

import math
from dataclasses import dataclass, field, replace
from typing import Any

from geometry.grading import OF_WALL, RAMP
from geometry.mesh_settings import CellMesh, MeridianMesh, SectionMesh
from geometry.muscle import ONE, Muscle
from geometry.refusal import is_count, is_number
from solver.material import MPA, NEWTON, Thread
from solver.refusal import UnsolvableCase

DENSITY = {"unit": "N/mm^3"}  # of springs
CLAMP_WALL = 2.0  # mm, of the muscle of the paper, for which springs and
SLACK_DIAMETER = 20.0  # slackening were chosen


@dataclass(frozen=True, kw_only=True)
class Newton:
    """Solution control of solver/path/control.idp.

    Residuals are judged relative to the largest nodal force of any single term.
    """

    tolerance: float = field(default=1e-9, metadata=ONE)
    iterations: int = field(default=15, metadata=ONE)  # at most, in one step
    smallest_step: float = field(default=1 / 512, metadata=ONE)  # share of the way to a stop

    def __post_init__(self) -> None:
        if not (is_number(self.tolerance) and 1e-12 <= self.tolerance <= 1e-3):
            raise UnsolvableCase("tolerance", self.tolerance, "from 1e-12 to 1e-3")
        if not is_count(self.iterations):
            raise UnsolvableCase("iterations", self.iterations, "an integer >= 1")
        if not (is_number(self.smallest_step) and 0 < self.smallest_step <= 1):
            raise UnsolvableCase("smallest_step", self.smallest_step, "more than 0, at most 1")


@dataclass(frozen=True, kw_only=True)
class Clamp:
    """How a clamped end holds the tube: springs of density k min(s / ramp, 1)^2, s from the cap.

    The ramp goes with the wall: a thick soft wall on a short ramp turns inside out. So do springs
    that are left out: a muscle scaled by a factor has its forces scaled by the square of it.
    """

    ramp: float = field(default=RAMP, metadata=OF_WALL)
    thread_stiffness: float | None = field(default=None, metadata=DENSITY)  # on layers
    inner_stiffness: float | None = field(default=None, metadata=DENSITY)  # inside

    def __post_init__(self) -> None:
        for name in ("ramp", "thread_stiffness", "inner_stiffness"):
            value = getattr(self, name)
            if not ((is_number(value) and value > 0) or (value is None and name != "ramp")):
                raise UnsolvableCase(name, value, "a finite number > 0")

    def of(self, muscle: Muscle) -> "Clamp":
        """With what was left out: 200 N/mm3 on the layers, 20 inside, at 2 mm of wall."""
        thinner = CLAMP_WALL / muscle.wall_thickness
        return replace(
            self,
            thread_stiffness=_given(self.thread_stiffness, 200.0 * thinner),
            inner_stiffness=_given(self.inner_stiffness, 20.0 * thinner),
        )


@dataclass(frozen=True, kw_only=True)
class Slack:
    """Over which strain a tension-only thread slackens: a smooth law instead of a kink.

    Threads stiffer than ``stiffness`` work at smaller strains and get a width narrower in
    proportion; otherwise the smoothing itself would carry load. docs/decisions has the numbers.
    Left out it goes with the muscle's section, as forces do.
    """

    width: float = field(default=1e-3, metadata=ONE)
    stiffness: float | None = field(default=None, metadata=NEWTON)  # EA of that width

    def __post_init__(self) -> None:
        if not (is_number(self.width) and 0 < self.width <= 0.1):
            raise UnsolvableCase("width", self.width, "more than 0, at most 0.1")
        if not (self.stiffness is None or (is_number(self.stiffness) and self.stiffness > 0)):
            raise UnsolvableCase("stiffness", self.stiffness, "a finite number > 0 (N)")

    def of(self, muscle: Muscle) -> "Slack":
        """With a stiffness that was left out: 315 N at an inner diameter of 20 mm."""
        wider = (muscle.inner_diameter / SLACK_DIAMETER) ** 2
        return replace(self, stiffness=_given(self.stiffness, 315.0 * wider))

    def width_of(self, thread: Thread) -> float:
        """Strain over which this thread slackens [1]."""
        assert self.stiffness is not None  # of a case it is given (``of``)
        return self.width * min(1.0, self.stiffness / thread.stiffness)


@dataclass(frozen=True, kw_only=True)
class Spread:
    """Over which tube the model ``cell`` spreads a thread, as (1 - (rho / a)^2)^2.

    The stiffness EA and the modulus E of the thread's material give its diameter d, and the tube
    has the radius a = ``radius`` d: sqrt(1/2) gives it the second moment of a round thread.
    """

    radius: float = field(default=math.sqrt(0.5), metadata=ONE | {"relative_to": "thread diameter"})
    modulus: float = field(default=2100.0, metadata=MPA)  # E; the paper's

    def __post_init__(self) -> None:
        for name in ("radius", "modulus"):
            value = getattr(self, name)
            if not (is_number(value) and value > 0):
                raise UnsolvableCase(name, value, "a finite number > 0")

    def radius_of(self, thread: Thread) -> float:
        """Radius a of the tube of this thread [mm]."""
        return self.radius * math.sqrt(4 * thread.stiffness / (math.pi * self.modulus))


@dataclass(frozen=True, kw_only=True)
class Numerics:
    """Settings of all models; a case keeps those that its model reads."""

    newton: Newton = field(default_factory=Newton)
    meridian: MeridianMesh = field(default_factory=MeridianMesh)
    section: SectionMesh = field(default_factory=SectionMesh)
    clamp: Clamp = field(default_factory=Clamp)
    slack: Slack = field(default_factory=Slack)
    cell: CellMesh = field(default_factory=CellMesh)
    spread: Spread = field(default_factory=Spread)

    def of(self, muscle: Muscle) -> "Numerics":
        """With the defaults that go with the size of a muscle."""
        return replace(self, clamp=self.clamp.of(muscle), slack=self.slack.of(muscle))


def _given(value: float | None, otherwise: float) -> float:
    return otherwise if value is None else value


KINDS: dict[str, Any] = {
    "newton": Newton,
    "meridian": MeridianMesh,
    "section": SectionMesh,
    "clamp": Clamp,
    "slack": Slack,
    "cell": CellMesh,
    "spread": Spread,
}
