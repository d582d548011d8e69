"""When the stops of a load path are passed, and what a muscle moves on its way.

A path without a history is of equilibria that do not know of time. With one, its stops are passed
at given times: by a rubber with a memory (solver/memory.py), by a muscle that moves a mass, by one
that is filled through a valve.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from itertools import pairwise

from geometry.refusal import is_number
from solver.memory import SECOND
from solver.refusal import UnsolvableCase

AMBIENT = 0.101325  # MPa
STANDARD = 0.1  # MPa, of the volumes in a conductance
MOST_STEPS = 20_000
TONNE_PER_KG = 1e-3
LINEAR = 0.999  # ratio of pressures above which the flow goes with their difference
FIRST, FIRST_GROWTH = 1e-6, 1.2  # of the steps behind a load that came at once, and their growth
FIRST_OF_MASS = 1e-3  # in shorter ones its way is less than rounding of its place
JUMP_STEPS = 64  # in which what comes at once is brought on, for its work
PRELOAD_STEPS = 40  # in a time of preload, each longer than the one before


class Start(StrEnum):
    """What a rubber remembers at the first stop."""

    RELAXED = "relaxed"  # it has been there for long
    UNLOADED = "unloaded"  # it has been without load for long, and is brought there at once


class Wave(StrEnum):
    """How the swept control goes from one end to the other and back."""

    TRIANGLE = "triangle"
    SINE = "sine"

    def at(self, phase: float) -> float:
        """Share of the way at a phase, 0 and 1 being the begin of a cycle."""
        if self is Wave.SINE:
            return (1 - math.cos(2 * math.pi * phase)) / 2
        return 1 - abs(1 - 2 * (phase % 1.0))


@dataclass(frozen=True, kw_only=True)
class Valve:
    """A valve between a supply and the muscle, by ISO 6358.

    Attributes
    ----------
    conductance : sonic conductance C
    critical_ratio : of the pressures behind and before it, b, below which the flow is sonic
    exponent : n of p V^n: 1 where the gas keeps its temperature, 1.4 where it keeps its heat
    dead_volume : of fittings and tubes, filled with the muscle
    """

    conductance: float = field(metadata={"unit": "mm^3/(s*MPa)"})
    critical_ratio: float = field(default=0.3, metadata={"unit": "1"})
    exponent: float = field(default=1.0, metadata={"unit": "1"})
    dead_volume: float = field(default=0.0, metadata={"unit": "mm^3"})

    def __post_init__(self) -> None:
        for name, low, high, unit in (
            ("conductance", 0.0, math.inf, " (mm^3/(s MPa); 1 dm^3/(s bar) is 1e7)"),
            ("exponent", 0.99, 2.0, ""),
        ):
            value = getattr(self, name)
            if not (is_number(value) and low < value < high):
                span = f"a finite number > {low:g}" if high == math.inf else "from 1 to 2"
                raise UnsolvableCase(name, value, span + unit)
        if not (is_number(self.critical_ratio) and 0 <= self.critical_ratio < 1):
            raise UnsolvableCase("critical_ratio", self.critical_ratio, "from 0 to below 1")
        if not (is_number(self.dead_volume) and self.dead_volume >= 0):
            raise UnsolvableCase("dead_volume", self.dead_volume, "a finite number >= 0 (mm^3)")

    def flow(self, supply: float, muscle: float) -> float:
        """Pressure times volume that enters the muscle per second [MPa mm^3/s]; p absolute."""
        sign, up, down = (1, supply, muscle) if supply >= muscle else (-1, muscle, supply)
        return sign * STANDARD * self.conductance * up * self._opening(down / up)

    def _opening(self, ratio: float) -> float:
        """Share of the sonic flow."""

        def ellipse(q: float) -> float:
            return math.sqrt(1 - ((q - self.critical_ratio) / (1 - self.critical_ratio)) ** 2)

        if ratio <= self.critical_ratio:
            return 1.0
        if ratio < LINEAR:
            return ellipse(ratio)
        return ellipse(LINEAR) * (1 - ratio) / (1 - LINEAR)


@dataclass(frozen=True, kw_only=True)
class History:
    """Times of the stops of a path, and what goes with them.

    Two stops of one time are a jump: the second is reached at once, by a rubber that has no time to
    relax, and with a mass at the length of the first.

    Attributes
    ----------
    times : of the stops, from 0
    start : what the rubber remembers at the first stop
    preload : how long it is held there before, if it begins without load
    period : of a cycle, if there are any
    held : values of the control that is held at those times; without them it is constant
    mass : that hangs on the muscle
    valve : then the pressures of the path are those of its supply, but the first

    Raises
    ------
    UnsolvableCase
        If times do not rise from 0, or a value is none that it can have.
    """

    times: tuple[float, ...] = field(metadata=SECOND)
    start: Start = Start.RELAXED
    preload: float = field(default=0.0, metadata=SECOND)
    period: float | None = field(default=None, metadata=SECOND)
    held: tuple[float, ...] | None = field(default=None, metadata={"unit": "as held"})
    mass: float = field(default=0.0, metadata={"unit": "kg"})
    valve: Valve | None = None

    def __post_init__(self) -> None:
        if self.start not in list(Start):
            raise UnsolvableCase("start", self.start, ", ".join(Start))
        object.__setattr__(self, "start", Start(self.start))
        times = self.times
        if not isinstance(times, tuple) or not 2 <= len(times) <= MOST_STEPS + 1:
            raise UnsolvableCase("times", times, f"a list of 2 to {MOST_STEPS + 1} times")
        for time in times:
            if not is_number(time):
                raise UnsolvableCase("times", time, "finite numbers (s)")
        falls = any(b < a for a, b in pairwise(times))
        thrice = any(c == a for a, c in zip(times, times[2:], strict=False))
        if times[0] != 0 or falls or thrice or times[-1] == 0:
            allowed = "times that rise from 0, two of one time where it jumps (s)"
            raise UnsolvableCase("times", times[0], allowed)
        if self.valve is not None and any(b == a for a, b in pairwise(times)):
            allowed = "times that rise: behind a valve no pressure jumps, switch its supply (s)"
            raise UnsolvableCase("times", times[0], allowed)
        for name in ("preload", "mass"):
            value = getattr(self, name)
            if not (is_number(value) and value >= 0):
                unit = "s" if name == "preload" else "kg"
                raise UnsolvableCase(name, value, f"a finite number >= 0 ({unit})")
        if self.preload and self.start is Start.RELAXED:
            allowed = "0 where it starts relaxed; more where it starts unloaded (s)"
            raise UnsolvableCase("preload", self.preload, allowed)
        if self.period is not None and not (is_number(self.period) and self.period > 0):
            raise UnsolvableCase("period", self.period, "a finite number > 0 (s)")

    @property
    def starts_at_once(self) -> bool:
        """Whether the first state comes at once and is left at once: all branches relax then."""
        return self.start is Start.UNLOADED and not self.preload

    @property
    def moves(self) -> bool:
        """Whether there is more to it than the rubber: a mass, a valve."""
        return self.mass > 0 or self.valve is not None

    @property
    def first(self) -> float:
        """Share of a step with which one begins behind what came at once."""
        return FIRST_OF_MASS if self.mass else FIRST

    def relaxes_to(self, stop: int) -> bool:
        """Whether what came at once relaxes on the way to a stop, in steps that begin short."""
        if stop == 1:
            return self.starts_at_once
        return self.times[stop - 1] == self.times[stop - 2]

    def cycles(self) -> list[tuple[int, int]]:
        """First and last stop of every whole cycle; of all, where there are none."""
        last = len(self.times) - 1
        if self.period is None:
            return [(0, last)]
        ends = [0]
        for k, time in enumerate(self.times):
            if time >= len(ends) * self.period * (1 - 1e-9):
                ends.append(k)
        return list(pairwise(ends))

    def preload_steps(self) -> list[float]:
        """Lengths of the steps in which the first stop is held before [s]."""
        if not self.preload:
            return []
        ends = [self.preload * 10 ** (-6 + 6 * k / PRELOAD_STEPS) for k in range(PRELOAD_STEPS + 1)]
        return [b - a for a, b in pairwise([0.0, *ends])]


def sampled(
    wave: Wave, low: float, high: float, period: float, cycles: int, samples: int
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Times and values of some cycles from one value to another and back."""
    steps = range(cycles * samples + 1)
    times = tuple(_short(k * period / samples) for k in steps)
    values = tuple(_short(low + (high - low) * wave.at(k / samples)) for k in steps)
    return times, values


def through(table: Sequence[tuple[float, float]], times: Sequence[float]) -> tuple[float, ...]:
    """Values at some times, straight between the rows (time, value) of a table.

    Of two rows of one time the second holds from there on, the first up to it: a jump. Two times
    that are one have the values before and behind it.
    """

    def at(k: int) -> float:
        time, jumped = times[k], k > 0 and times[k - 1] == times[k]
        if jumped and any(row[0] == time for row in table):
            return [value for t, value in table if t == time][-1]
        before = [row for row in table if row[0] < time]
        after = [row for row in table if row[0] >= time]
        if not before:
            return table[0][1]
        if not after:
            return table[-1][1]
        (t0, v0), (t1, v1) = before[-1], after[0]
        return v0 + (v1 - v0) * (time - t0) / (t1 - t0)

    return tuple(_short(at(k)) for k in range(len(times)))


def with_jumps(times: Sequence[float], table: Sequence[tuple[float, float]]) -> tuple[float, ...]:
    """The times, and twice those at which a table jumps."""
    jumps = [a for (a, _), (b, _) in pairwise(table) if a == b and a <= times[-1]]
    return tuple(sorted([time for time in times if time not in jumps] + 2 * jumps))


def _short(value: float) -> float:
    """Without the last digits, which are rounding."""
    return float(f"{value:.12g}")


class Rate:
    """Derivative of a quantity by time at the end of a step, of second order.

    For steps of any length it is ``slope`` times the new value plus ``rest`` (BDF2); the first step
    is one of implicit Euler.
    """

    def __init__(self, value: float) -> None:
        self.last, self.before, self.step = value, value, math.inf
        self.slope, self.rest = 0.0, 0.0

    def begin(self, step: float) -> None:
        """A step of some length [s]."""
        growth = step / self.step  # 0 in the first one
        self.slope = (1 + 2 * growth) / (1 + growth) / step
        old = -(1 + growth) * self.last + growth**2 / (1 + growth) * self.before
        self.rest = old / step

    def of(self, value: float) -> float:
        """The derivative, if the step ends at a value."""
        return self.slope * value + self.rest

    def end(self, value: float, step: float) -> None:
        """The step has ended there."""
        self.before, self.last, self.step = self.last, value, step
