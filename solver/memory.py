"""The memory of a rubber: branches that relax, beside the law of its long-term stress.

A branch of share g and time tau has two internal tensors U and L of its own (theory, section 10):

    psi = g [C10 (C:U - 3 - ln det U) + C01 (C^-1:L - 3 - ln det L)]
    dU/dt = (C^-1 - U)/tau,  dL/dt = (C - L)/tau

In small strains that is a Prony series; at rest for long it bears nothing, and a strain that comes
at once meets g times the stiffness more.
"""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from geometry.refusal import is_number
from solver.refusal import UnsolvableCase

Array = NDArray[np.float64]
MOST_BRANCHES = 60
SHARE, SECOND = {"unit": "1"}, {"unit": "s"}
SERIES = 1e-4  # step by time, below which the weights of a step are a series


@dataclass(frozen=True, kw_only=True)
class Memory:
    """What of a rubber's stress relaxes.

    Attributes
    ----------
    shares : of the stiffness of each branch, of the long-term one
    times : of their relaxation
    reference_time : how long the test took of which the constants of the law are; without it they
        are the long-term ones

    Raises
    ------
    UnsolvableCase
        If there is no branch, or a share or a time is none.
    """

    shares: tuple[float, ...] = field(metadata=SHARE)
    times: tuple[float, ...] = field(metadata=SECOND)
    reference_time: float | None = field(default=None, metadata=SECOND)

    def __post_init__(self) -> None:
        for name in ("shares", "times"):
            values = getattr(self, name)
            allowed = f"a list of 1 to {MOST_BRANCHES} finite numbers > 0"
            if not isinstance(values, tuple) or not 1 <= len(values) <= MOST_BRANCHES:
                raise UnsolvableCase(name, values, allowed)
            for value in values:
                if not (is_number(value) and value > 0):
                    raise UnsolvableCase(name, value, allowed)
        if len(self.times) != len(self.shares):
            allowed = f"as many as shares, {len(self.shares)}"
            raise UnsolvableCase("times", list(self.times), allowed)
        time = self.reference_time
        if time is not None and not (is_number(time) and time > 0):
            raise UnsolvableCase("reference_time", time, "a finite number > 0 (s)")

    @classmethod
    def flat(
        cls, per_decade: float, start: float, end: float, reference_time: float | None = None
    ) -> "Memory":
        """Equal relaxation in every decade of time from ``start`` to ``end``, a branch a decade."""
        for name, value in (("per_decade", per_decade), ("from", start), ("to", end)):
            if not (is_number(value) and value > 0):
                unit = "1" if name == "per_decade" else "s"
                raise UnsolvableCase(name, value, f"a finite number > 0 ({unit})")
        if not end > start:
            raise UnsolvableCase("to", end, f"more than from, {start:g} (s)")
        decades = math.log10(end / start)
        if decades > MOST_BRANCHES - 1:
            raise UnsolvableCase("to", end, f"at most {MOST_BRANCHES - 1} decades beyond from (s)")
        steps = max(1, round(decades))
        each = (start * 10 ** (k * decades / steps) for k in range(steps + 1))
        times = tuple(float(f"{time:.12g}") for time in each)
        share = float(f"{per_decade * decades / steps:.12g}")
        return cls(shares=(share,) * len(times), times=times, reference_time=reference_time)

    @property
    def long_term(self) -> float:
        """Long-term stiffness as a share of that of the law."""
        return 1 / (1 + sum(self._left()))

    def of_law(self) -> Array:
        """Stiffness of each branch as a share of that of the law."""
        return self.long_term * np.array(self.shares)

    def modulus(self, frequency: float) -> complex:
        """What the branches add to the stiffness in small vibrations, as a share of the law's.

        Of what the law already has, the part that had not relaxed in the reference time, no more
        is added.
        """
        turn = 2j * math.pi * frequency * np.array(self.times)
        answer = turn / (1 + turn) - np.array(self._left()) / np.array(self.shares)
        return complex(np.sum(self.of_law() * answer))

    def _left(self) -> list[float]:
        """Of each share, what is left after the reference time."""
        time = self.reference_time
        pairs = zip(self.shares, self.times, strict=True)
        return [0.0 if time is None else g * math.exp(-time / tau) for g, tau in pairs]


def weights(step: Array) -> tuple[Array, Array, Array]:
    """Of the old tensor and of both ends of a step, by its length over each time.

    They are exact where the ends' tensor goes straight between them.
    """
    decay = np.exp(-step)
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = np.where(step > SERIES, (1 - decay) / step, 1 - step / 2 + step**2 / 6)
    return decay, np.where(step > SERIES, mean - decay, step / 2 - step**2 / 3), 1 - mean
