"""The cylinder along a history: a rubber with a memory, a mass on the muscle, a valve before it.

Every step of time is one of a hyperelastic cylinder (wall_memory.py beside this module), whose two
controls may be the equation of motion and that of the gas. A step that is not found is halved, from
the same memory.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import OptimizeResult, root

from solver.case import Case
from solver.effects import Rubber
from solver.history import AMBIENT, FIRST_GROWTH, JUMP_STEPS, TONNE_PER_KG, Rate, Start
from solver.judge import judged
from solver.load_path import Control, Waypoint
from solver.models.cylinder import curve
from solver.models.cylinder.mechanics import Cylinder, State
from solver.models.cylinder.observe import observed, volume
from solver.models.cylinder.sleeve_friction import SleeveFriction
from solver.models.cylinder.wall_memory import principal
from solver.record import Solution, unreached, variables

Array = NDArray[np.float64]
SHORTEST = 1 / 1024  # share of a step between stops
PLACE = 1e-3  # share of a length, whose inertia is of the size of its equation
JACOBIAN_STEP, CHORDS, EXACT = 1e-7, 8, 1e-12


def solve(case: Case) -> Solution:
    """The curve of a case in time."""
    run = _Run(case)
    states = unreached(case.path.states, variables(case))
    reason = run.begin()
    if not reason:
        run.record(states, 0)
    for stop in range(1, 0 if reason else len(case.path.stops)):
        if not run.go_to(stop):
            state = run.state
            reason = (
                f"no state found after {run.time:g} s, at contraction {1 - state.lz:g}, "
                f"pressure {state.pressure:g} MPa, force {state.force:g} N"
            )
            break
        run.record(states, stop)
    return judged(case, states, reason=reason, unknowns=run.cylinder.unknowns)


def _root(off: Callable[[Array], Array], guess: Array) -> OptimizeResult:
    """A root near a guess that mostly is so good that one Jacobian serves to the end."""
    x, value = guess, off(guess)
    columns = [(off(x + shift) - value) / JACOBIAN_STEP for shift in JACOBIAN_STEP * np.eye(len(x))]
    try:
        inverse = np.linalg.inv(np.array(columns).T)
    except np.linalg.LinAlgError:
        return root(off, guess, tol=1e-13)
    for _ in range(CHORDS):
        x = x - inverse @ value
        before, value = np.max(np.abs(value)), off(x)
        largest = np.max(np.abs(value))
        if largest < EXACT:
            return OptimizeResult(x=x, fun=value)
        if not largest < before / 4:
            break
    return root(off, guess, tol=1e-13)


class _Run:
    """A muscle on its way through a history."""

    def __init__(self, case: Case) -> None:
        history = case.path.history
        assert history is not None
        self.case, self.history = case, history
        self.cylinder = Cylinder(case)
        self.memory = self.cylinder.memory
        self.kinds = case.path.kind.held, case.path.kind.swept
        self.at = self.cylinder.start  # the unknowns
        self.before: Array | None = None  # those a step ago
        self.step = math.inf  # length of the last one [s]
        self.time = self.work = self.lost = 0.0

    def begin(self) -> str:
        """Go to the first stop; gives why there is none."""
        path = self.case.path.start
        wall = self.case.effects.rubber is not Rubber.NONE
        if self.memory is not None and self.history.start is Start.RELAXED:
            memory, self.cylinder.memory = self.memory, None  # long-term on the whole way
            reason = self._walk(path.ways(rubber=wall))
            self.cylinder.memory = memory
            memory.rest(self._stretch(self.cylinder.state(self.at)))
        else:
            reason = self._walk(path.ways(rubber=wall))
            if self.memory is not None and not reason:
                self.memory.advance(self._stretch(self.cylinder.state(self.at)))
        if reason:
            return reason
        self.state = state = self.cylinder.state(self.at)
        if self.case.rubs:
            assert self.case.friction is not None
            friction = SleeveFriction(self.case.friction, self.case.muscle.layers)
            friction.rest(*self.cylinder.pressing(state))
            friction.advance(*self.cylinder.pressing(state))
            self.cylinder.friction = friction
        self.length, self.speed = Rate(self._length(state)), Rate(0.0)
        self.gas = Rate(self._content(state))
        self.dissipation = self._dissipation()
        for step in self.history.preload_steps():
            goal = [self._target(kind, 0) for kind in self.kinds]
            if not self._step(step, goal, holding=True):
                return "no state found while the first stop is held"
        self.time = self.work = self.lost = 0.0
        return ""

    def _walk(self, ways: list[list[Waypoint]]) -> str:
        reason = ""
        for way in ways:
            at = self.cylinder.start
            for point in way:
                kinds = point.first, point.second
                targets = np.array([point.first_target, point.second_target])
                goal = targets / [curve.scale(self.cylinder, kind) for kind in kinds]
                at, reached = curve.walk(self.cylinder, kinds, goal, at)
                if not reached:
                    reason = curve.limit(self.cylinder, kinds, goal, at)
                    break
            else:
                self.at = at
                return ""
        return reason

    def go_to(self, stop: int) -> bool:
        """Go from the stop before to this one, in as many steps as needed."""
        times, done, share, growth = self.history.times, 0.0, 1.0, 2.0
        if self.history.relaxes_to(stop):
            share, growth = self.history.first, FIRST_GROWTH
        start, end = times[stop - 1], times[stop]
        old = [self._target(kind, stop - 1) for kind in self.kinds]
        new = [self._target(kind, stop) for kind in self.kinds]
        if end == start:
            return self._jump(old, new)
        if self.history.valve is not None:
            old[1] = new[1]  # the supply is switched
        while done < 1:
            there = min(done + share, 1.0)
            goal = [a + there * (b - a) for a, b in zip(old, new, strict=True)]
            if self._step((there - done) * (end - start), goal):
                done, share = there, growth * share
            else:
                share /= 2
                if share < SHORTEST:
                    return False
        self.time = end
        return True

    def _jump(self, old: list[float], new: list[float]) -> bool:
        """From controls to others at once; a mass stays where it is."""
        kinds = self.kinds
        if self.history.mass and kinds[0] is Control.FORCE:
            self.kinds = Control.CONTRACTION, kinds[1]
            old, new = [[1 - self.state.lz, ends[1]] for ends in (old, new)]
        done, share, found = 0.0, 1 / JUMP_STEPS, True
        while done < 1 and found:
            there = min(done + share, 1.0)
            goal = [a + there * (b - a) for a, b in zip(old, new, strict=True)]
            if self._step(0.0, goal, holding=True):
                done = there if there < 1 - 1e-9 else 1.0
            else:
                share /= 2
                found = share > SHORTEST / JUMP_STEPS
        self.kinds = kinds
        speed = self.speed.last
        self.length, self.speed = Rate(self._length(self.state)), Rate(speed)
        self.before = None
        return found

    def _step(self, length: float, goal: list[float], *, holding: bool = False) -> bool:
        """One step of time to the two controls; nothing changes where there is none."""
        if self.memory is not None:
            self.memory.freeze(length)
        for rate in (self.length, self.speed, self.gas) if length else ():
            rate.begin(length)

        def off(x: Array) -> Array:
            state = self.cylinder.state(x)
            values = [
                self._residual(kind, value, state, length, holding)
                for kind, value in zip(self.kinds, goal, strict=True)
            ]
            torque = state.torque / (self.cylinder.modulus * self.cylinder.inner**3)
            return np.array(values + [torque] * self.cylinder.free)

        guesses = [self.at]
        if self.before is not None and self.step:
            guesses.insert(0, self.at + (self.at - self.before) * length / self.step)
        for guess in guesses:
            with np.errstate(all="ignore"):
                found = _root(off, guess)
            if curve.is_near(self.cylinder, found, self.at):
                self._end(found.x, length)
                return True
        return False

    def _residual(
        self, kind: Control, value: float, state: State, length: float, holding: bool
    ) -> float:
        """A control less its target, or what is left of the equation in its place; a share."""
        scale = curve.scale(self.cylinder, kind)
        if kind is Control.FORCE and self.history.mass and not holding:
            speed = self.length.of(self._length(state))
            inertia = self.history.mass * TONNE_PER_KG * self.speed.of(speed)
            stiffness = self.history.mass * TONNE_PER_KG * self.speed.slope * self.length.slope
            scale += PLACE * stiffness * self.case.muscle.length
            return float(state.force + inertia - value) / scale
        valve = self.history.valve
        if kind is Control.PRESSURE and valve is not None and not holding:
            pressure = state.pressure + AMBIENT
            if pressure <= 0:
                return math.nan
            filled = self.gas.of(self._content(state)) * pressure ** (1 - 1 / valve.exponent)
            left = (filled - valve.flow(value + AMBIENT, pressure)) * length
            return float(left) / (scale * curve.scale(self.cylinder, Control.VOLUME))
        return curve.control(self.cylinder, kind, state) - value / scale

    def _end(self, x: Array, length: float) -> None:
        """Take a step that was found."""
        old, lost = self.state, self.dissipation
        self.before, self.at, self.step = self.at, x, length
        self.state = new = self.cylinder.state(x)
        if length:
            self.speed.end(self.length.of(self._length(new)), length)
            self.length.end(self._length(new), length)
            self.gas.end(self._content(new), length)
        if self.memory is not None:
            self.memory.advance(self._stretch(new))
        friction = self.cylinder.friction
        if friction is not None:
            friction.advance(*self.cylinder.pressing(new))
            self.lost += friction.lost * self.case.muscle.length
        self.dissipation = self._dissipation()
        self.lost += (lost + self.dissipation) / 2 * length
        self.work += (old.force + new.force) / 2 * (self._length(new) - self._length(old))
        self.work += (old.pressure + new.pressure) / 2 * (self._volume(new) - self._volume(old))

    def record(self, states: dict[str, Array], stop: int) -> None:
        """Put the state into the record."""
        for name, value in observed(self.cylinder, self.at).items():
            states[name][stop] = value
        states["time"][stop] = self.time
        states["work"][stop] = self.work
        states["dissipated"][stop] = self.lost
        if self.memory is not None:
            states["energy"][stop] += self.memory.stored * self.case.muscle.length
        if self.cylinder.friction is not None:
            states["energy"][stop] += self.cylinder.friction.stored * self.case.muscle.length

    def _dissipation(self) -> float:
        """Energy that the muscle loses per second [N mm/s]."""
        return 0.0 if self.memory is None else self.memory.dissipation * self.case.muscle.length

    def _target(self, kind: Control, stop: int) -> float:
        if kind is self.kinds[1]:
            return self.case.path.stops[stop]
        held = self.history.held
        return self.case.path.held if held is None else held[stop]

    def _stretch(self, state: State) -> Array:
        """C at the points of the wall."""
        return principal(self.cylinder.hoop(state.r, state.lz) ** 2, state.lz**2)

    def _length(self, state: State) -> float:
        return state.lz * self.case.muscle.length

    def _volume(self, state: State) -> float:
        return volume(self.cylinder, state)

    def _content(self, state: State) -> float:
        """What only the valve changes: p V for a gas that keeps its temperature."""
        valve = self.history.valve
        if valve is None:
            return 0.0
        pressure = max(state.pressure + AMBIENT, 0.0)
        return float(pressure ** (1 / valve.exponent) * (self._volume(state) + valve.dead_volume))
