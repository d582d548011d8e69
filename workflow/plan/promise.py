"""A promise on one curve: the cheapest rung of the ladder that is proved exact enough for it.

A climb begins on the rung that like muscles call for (workflow/plan/like_muscles.py). A rung is
proved exact enough

- by like muscles, if ``CONFIDENT`` of them are; it must then have every state of the curve,
- by a better rung on this curve, at all states or at a few telling ones: the difference of the two
  and what the better one may itself be off are within the tolerance,
- or, of a mesh, by a coarser one on this curve, where no better one says it.

Like muscles say nothing of a tube that a mesh shows to be folded. Where no rung is proved it
climbs, but not to a finer mesh where coarser ones have lost states, or where the tube is folded:
finer ones mostly lose such states, at many times the cost. Nothing is promised there of states that
none has, as a finer one may have them. Where two meshes leave open
few states only, a finer one is solved at these alone: where a muscle folds, a curve of it costs
many times such a state. Of the cheapest rung that like muscles
prove it takes the finest mesh that they prove and that costs at most ``MORE`` times as much, which
mostly serves a tighter tolerance too. Pure but for the two functions that it is given: what a rung
gives is asked of ``solve``, what is there already of ``known``.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from math import inf, isfinite, nan
from typing import Any

import numpy as np

from solver.case import Case, canonical, digest
from solver.record import Solution
from workflow.plan.judged import (
    FOLLOWS,
    ZERO,
    difference,
    is_answer,
    is_lost,
    is_valid,
    variable_of,
)
from workflow.plan.like_muscles import Guess, guess, seconds
from workflow.plan.likeness import is_pushed, share

CONFIDENT = 0.97  # share of like muscles on which a rung must hold to be taken without a check
BY_COARSER = {  # error of a mesh by its difference from the next coarser one of the ladder:
    "default": 1.5,  # 92 of 100 curves of the ladder have less; their median is 0.45
    "finer": 0.5,  # of second order it is 1/3, and 1.5 of that for safety
}
START = 40  # states that cost as much as getting to the first one
CHEAP = 0.6  # of the cost of all states: a check at a few of them that costs more is not worth it
MORE = 1.5  # times the cost of a mesh that holds: a finer one is taken for so much
TELLING = 4  # states at most of a check
FOLDED = 0.8  # det F: where a pushed muscle has less on a mesh, the tube has a crease
LIKELY = 0.8  # error of the default mesh by its difference from the coarser one: 7 of 10 have less
Solve = Callable[[Case], Solution]
Known = Callable[[Case], Solution | None]


@dataclass(frozen=True)
class Promise:
    """What a scene asks of a curve.

    Attributes
    ----------
    tolerance : share of the largest value along the curve (workflow/plan/judged.py)
    judged : quantities that it is about
    rungs : the curve by every rung that can give it, cheapest first
    after : climbs of whose records alone it may know, by key; by default of all that are there
    """

    tolerance: float
    judged: tuple[str, ...]
    rungs: dict[str, Case]
    after: tuple[str, ...] | None = None

    @cached_property
    def key(self) -> str:
        """Name of its outcome in files."""
        cases = {name: case.as_dict() for name, case in self.rungs.items()}
        asked: dict[str, Any] = {"tolerance": self.tolerance, "judged": self.judged, "rungs": cases}
        if self.after is not None:
            asked["after"] = self.after
        return digest(canonical({"promise": asked}))

    @cached_property
    def guesses(self) -> dict[str, Guess | None]:
        """Of the error of every rung."""
        return {name: guess(case, name, self.judged) for name, case in self.rungs.items()}

    @property
    def start(self) -> str:
        """The rung on which a climb begins that knows nothing."""
        return _Climb(self, _unsolved, lambda _: None).first()

    def with_stops(self, stops: tuple[float, ...], *, zero_force: bool) -> "Promise":
        """The same of a curve with other stops."""
        return replace(
            self,
            rungs={
                name: replace(case, path=replace(case.path, stops=stops, zero_force=zero_force))
                for name, case in self.rungs.items()
            },
        )


@dataclass(frozen=True)
class Verdict:
    """What is known of a rung on a curve.

    Attributes
    ----------
    error : it is not expected to exceed this; a share, infinite where states are lost
    chance : that it is within the tolerance
    by : how that is known
    """

    error: float
    chance: float
    by: str

    @property
    def holds(self) -> bool:
        """Whether it is proved exact enough."""
        return self.chance >= CONFIDENT


@dataclass(frozen=True)
class Outcome:
    """How a climb has ended.

    Attributes
    ----------
    rung : that is taken; holds : whether it is proved, or else only the best there is
    error, by : of it, as in Verdict
    tried : what was asked for, in this order: rung and number of states
    verdicts : of every rung, in the end
    """

    rung: str
    holds: bool
    error: float
    by: str
    tried: tuple[tuple[str, int], ...]
    verdicts: dict[str, Verdict] = field(default_factory=dict)

    def as_dict(self) -> dict[str, Any]:
        """For a file."""
        shown = {name: vars(verdict) for name, verdict in self.verdicts.items()}
        return {**vars(self), "verdicts": shown}


def climb(asked: Promise, solve: Solve, known: Known) -> Outcome:
    """Keep a promise."""
    return _Climb(asked, solve, known).run()


def telling(case: Case, solution: Solution) -> tuple[int, ...]:
    """Stops that tell most of a curve: both ends, its largest bend, nearest to no force."""
    values = solution.states[case.path.kind.follows][: len(case.path.stops)]
    there = np.flatnonzero(is_valid(solution)[: len(values)])
    if there.size <= TELLING:
        return tuple(map(int, there))
    found = {int(there[0]), int(there[-1]), int(there[np.argmin(np.abs(values[there]))])}
    x, y = np.array(case.path.stops)[there], values[there]
    bend = np.abs(np.diff(np.diff(y) / np.diff(x)))
    found.add(int(there[1 + int(np.argmax(bend))]))
    return tuple(sorted(found))


@dataclass
class _Climb:
    asked: Promise
    solve: Solve
    known: Known

    def __post_init__(self) -> None:
        rungs = self.asked.rungs
        self.names = list(rungs)
        self.solved = {n: found for n, case in rungs.items() if (found := self.known(case))}
        self.checked: dict[tuple[str, str], float] = {}  # difference of a rung from a better one
        self.closed: dict[str, float] = {}  # error of a mesh by a finer one where that was open
        self.guessed: dict[tuple[str, bool], Guess | None] = {}  # by rung, and whether it is pushed
        self.tried: list[tuple[str, int]] = []

    def first(self) -> str:
        """The rung that is solved first."""
        holding = self._holding()
        return next(iter(self._worth(holding)), holding) or self._unguessed()

    def run(self) -> Outcome:
        """Climb until a rung holds, or none is left."""
        while True:
            holding = self._holding()
            if holding in self.solved:
                return self._outcome(holding)
            if worth := self._worth(holding):
                self._full(worth[0])
            elif pair := self._worth_a_look(holding):
                self._check(*pair)
            elif (name := holding or self._unguessed()) not in self.solved:
                if numbers := self._left_open(name):
                    self._close(name, numbers)
                else:
                    self._full(name)
            else:
                return self._outcome(self._best())

    # --- what is known ----------------------------------------------------------------------------

    def verdict(self, name: str) -> Verdict:
        """Of a rung: by a better one on this curve, else by like muscles."""
        if name in self.solved:
            if not is_valid(self.solved[name]).any():
                return Verdict(inf, 0.0, "no state is valid")
            if lost := self._lost(name):
                what = "state is" if lost == 1 else "states are"
                return Verdict(inf, 0.0, f"{lost} {what} lost, not valid or smoothed")
        if here := self._here(name):
            return here
        known = self._guess(name)
        if known is None:
            return Verdict(nan, 0.0, "not known")
        if self._is_folded(name):
            return Verdict(nan, 0.0, "not known, as the tube is folded")
        by = f"estimated from {known.count} like muscles"
        return Verdict(known.high, known.chance(self.asked.tolerance), by)

    def _here(self, name: str) -> Verdict | None:
        """By other rungs on this curve: by better ones, else by coarser meshes; None if by none."""
        better = self._above(name)[::-1]
        by_better = [v for each in better if (v := self._measured(name, each))]
        by_coarser = [v for v in (self._by_both(name), self._by_coarser(name)) if v]
        sure = [v for v in by_better if isfinite(v.error)]  # two meshes may agree and be wrong
        found = sure or by_coarser or by_better
        return min(found, key=lambda v: _worse(v.error)) if found else None

    def _guess(self, name: str) -> Guess | None:
        """By like muscles: those that are pushed too, or not, once that is known."""
        seen = self._is_pushed()
        if seen is None:
            return self.asked.guesses[name]
        if (name, seen) not in self.guessed:
            case = self.asked.rungs[name]
            self.guessed[name, seen] = guess(case, name, self.asked.judged, pushed=seen)
        return self.guessed[name, seen]

    def _is_pushed(self) -> bool | None:
        """Whether a state of the curve is pushed, as far as a solved rung shows it."""
        if any(is_pushed(found).any() for found in self.solved.values()):
            return True
        whole = any(not is_lost(found).any() for found in self.solved.values())
        return False if whole else None

    def _lost(self, name: str) -> int:
        """States of a solved rung that are no answer, unless no mesh of the best model has one."""
        case, own = self.asked.rungs[name], self.solved[name]
        good = is_answer(case, own) | ~(is_valid(own) | is_lost(own))
        every = self._meshes(self.names[-1])
        meshes = [each for each in every if each in self.solved]
        if self.names[-1] in meshes and len(meshes) >= min(2, len(every)):
            good |= ~np.any([is_valid(self.solved[n]) for n in meshes], axis=0)
        if ZERO not in self.asked.judged:
            good = good[: len(case.path.stops)]
        return int((~good).sum())

    def _measured(self, name: str, better: str) -> Verdict | None:
        """By a better rung; None if the two were not compared, or that has lost states itself."""
        case, count = self.asked.rungs[name], 0
        if better in self.solved and self._lost(better):
            return None
        if name in self.solved and better in self.solved:
            pair = self.solved[name], self.solved[better]
            off = max((difference(case, *pair, each) for each in self.asked.judged), key=_worse)
            count = case.path.states
        elif (name, better) in self.checked:
            off = self.checked[name, better]
        else:
            return None
        own = self._own_error(better)
        error, tolerance = off + own, self.asked.tolerance
        where = "all" if count else "telling"
        by = f"measured here by {better} at {where} states"
        if name in self.solved and (none := int((~is_valid(self.solved[name])).sum())):
            by += f"; {none} of them no rung has"
        return Verdict(error, float(error <= tolerance), by)

    def _by_coarser(self, name: str) -> Verdict | None:
        """Of a mesh, by the next coarser one of its model; None if the two are not solved."""
        meshes, mesh = self._meshes(name), name.partition(", ")[2] or "default"
        coarser = next(iter(meshes[meshes.index(name) + 1 :]), None)
        if coarser is None or not {name, coarser} <= self.solved.keys() or mesh not in BY_COARSER:
            return None
        pair = self.solved[coarser], self.solved[name]
        case = self.asked.rungs[coarser]
        off = max((difference(case, *pair, each) for each in self.asked.judged), key=_worse)
        if not isfinite(off):  # the coarser one has lost states: it says nothing of others
            return None
        error = BY_COARSER[mesh] * off
        return Verdict(error, float(error <= self.asked.tolerance), f"measured here by {coarser}")

    def _by_both(self, name: str) -> Verdict | None:
        """Of a mesh, by a finer one at the states that the coarser one left open."""
        error = self.closed.get(name, inf)
        if not isfinite(error):
            return None
        finer = self._meshes(name)[self._meshes(name).index(name) - 1]
        by = f"measured here by {finer} where coarser meshes leave it open"
        return Verdict(error, float(error <= self.asked.tolerance), by)

    def _own_error(self, name: str) -> float:
        """What a rung may itself be off: by others here, by like muscles; else infinite."""
        if here := self._here(name):
            return here.error
        known = self._guess(name)
        return inf if known is None or self._is_folded(name) else known.high

    def _meshes(self, name: str) -> list[str]:
        """The meshes of the model of a rung, finest first."""
        model = self.asked.rungs[name].model
        return [each for each in reversed(self.names) if self.asked.rungs[each].model == model]

    def _above(self, name: str) -> list[str]:
        return self.names[self.names.index(name) + 1 :]

    # --- what to do -------------------------------------------------------------------------------

    def _holding(self) -> str | None:
        """The rung to take of those that hold; of those that are there the most exact."""
        names = [name for name in self.names if not self._given_up(name)]
        holding = [name for name in names if self.verdict(name).holds]
        there = [name for name in holding if name in self.solved]
        if there or not holding:
            return there[-1] if there else None
        expected = {name: self._expected(name, holding) for name in holding}
        cheapest = min(expected, key=expected.__getitem__)
        meshes = [n for n in self._meshes(cheapest) if n in expected]  # finest first
        return next(n for n in meshes if expected[n] <= MORE * expected[cheapest])

    def _expected(self, name: str, holding: list[str]) -> float:
        """Seconds of a rung, and of the next one where it loses states."""
        known = self.asked.guesses[name]
        better = [each for each in holding if each in self._above(name)]
        lost = known.lost if known else 0.0
        return self._seconds(name) + lost * (self._seconds(better[0]) if better else 0.0)

    def _worth(self, holding: str | None) -> list[str]:
        """Meshes to solve that may prove each other, if likely cheaper than what holds."""
        if holding is None or holding in self.solved:
            return []
        meshes = self._meshes(holding)
        sure, below = self._seconds(holding), meshes[meshes.index(holding) + 1 :]
        for fine, coarse in pairwise(below):
            if self._by_coarser(fine) or self.verdict(fine).error == inf or self._given_up(fine):
                continue
            new = [name for name in (coarse, fine) if name not in self.solved]
            own = sum(self._seconds(name) for name in new)
            if own + (1 - self.verdict(fine).chance) * sure < sure:
                return new
        return []

    def _worth_a_look(self, holding: str | None) -> tuple[str, str] | None:
        """A rung that may do, and a better one by which it is checked at a few states of many."""
        if holding is None or holding in self.solved:
            return None
        sure, count = self._seconds(holding), len(self.asked.rungs[holding].path.stops)
        share = (START + TELLING) / (START + count)
        if share > CHEAP or self._own_error(holding) > self.asked.tolerance / 2:
            return None
        for name in self.names[: self.names.index(holding)]:
            verdict, known = self.verdict(name), self.asked.guesses[name]
            if not verdict.by.startswith("estimated") or known is None:
                continue
            chance = verdict.chance * (1 - known.lost)
            own = 0.0 if name in self.solved else self._seconds(name)
            if own + share * sure + (1 - chance) * sure < sure:
                return name, holding
        return None

    def _unguessed(self) -> str:
        """Without a guess: meshes of the best model, from the coarsest, until states are lost."""
        meshes = [n for n in self._meshes(self.names[-1])[::-1] if not self._given_up(n)]
        short = (n for n in meshes if n not in self.solved or is_lost(self.solved[n]).any())
        return next(short, meshes[-1])

    def _given_up(self, name: str) -> bool:
        """Whether a mesh is not tried: a coarser one has lost states, or is folded."""
        if name in self.solved:
            return False
        lost = any(is_lost(each).any() for each in self._coarser(name))
        open_ones_lost = inf in map(self.closed.get, self._meshes(name))
        return lost or open_ones_lost or self._is_folded(name)

    def _is_folded(self, name: str) -> bool:
        """Whether a tube has a crease by a mesh or a coarser one: the sharper the finer the mesh.

        At the ends of muscles that pull, rubber may have as small a det F, and nothing folds.
        """
        meshes = self._meshes(name)
        there = [self.solved[n] for n in meshes[meshes.index(name) :] if n in self.solved]
        return any((found.states["min_det_f"][is_pushed(found)] < FOLDED).any() for found in there)

    def _coarser(self, name: str) -> list[Solution]:
        """By the coarser meshes of a model, of those that are there."""
        meshes = self._meshes(name)
        return [self.solved[n] for n in meshes[meshes.index(name) + 1 :] if n in self.solved]

    def _left_open(self, name: str) -> tuple[int, ...]:
        """Stops of the next coarser mesh that its own coarser one leaves open; none if many.

        Nor where it is not likely exact enough there, as all of the finer mesh is needed then.
        """
        meshes = self._meshes(name)
        mesh, coarser, *_ = [*meshes[meshes.index(name) + 1 :], "", ""]
        if mesh in self.closed or not {mesh, coarser} <= self.solved.keys():
            return ()
        if ZERO in self.asked.judged or self._lost(mesh) or not self._by_coarser(mesh):
            return ()
        off, tolerance = self._off(coarser, mesh), self.asked.tolerance
        numbers = np.flatnonzero(self._factor(mesh) * off > tolerance)
        if LIKELY * np.nanmax(off) > tolerance or 2 * numbers.size > off.size:
            return ()
        return tuple(map(int, numbers))

    def _best(self) -> str:
        """The most exact of those that have most states."""
        counts = {name: int(is_valid(solution).sum()) for name, solution in self.solved.items()}
        most = max(counts.values())
        return max((n for n in counts if counts[n] == most), key=self.names.index)

    def _seconds(self, name: str) -> float:
        """Of the processor, by the muscles most like this one; else by all of the table."""
        known = self.asked.guesses[name]
        return known.seconds if known else seconds(name)

    # --- doing it ---------------------------------------------------------------------------------

    def _full(self, name: str) -> Solution:
        """Solve a rung at all states."""
        if name not in self.solved:
            case = self.asked.rungs[name]
            self.solved[name] = self.solve(case)
            self.tried.append((name, case.path.states))
        return self.solved[name]

    def _check(self, name: str, better: str) -> None:
        """Compare a rung with a better one at the telling states."""
        case, own = self.asked.rungs[name], self._full(name)
        if self._lost(name):
            self.checked[name, better] = inf
            return
        numbers = telling(case, own)
        path = self.asked.rungs[better].path
        path = replace(path, stops=tuple(path.stops[k] for k in numbers))
        found = self.solve(replace(self.asked.rungs[better], path=path))
        self.tried.append((better, path.states))
        at = [*numbers, *([len(case.path.stops)] if path.zero_force else [])]
        off = [difference(case, own, found, each, at) for each in self.asked.judged]
        self.checked[name, better] = max(off, key=_worse)

    def _close(self, finer: str, numbers: tuple[int, ...]) -> None:
        """Compare a mesh with a finer one at the states that are open; it may lose them, too."""
        meshes = self._meshes(finer)
        name, coarser = meshes[meshes.index(finer) + 1 :][:2]
        path = self.asked.rungs[finer].path
        path = replace(path, stops=tuple(path.stops[k] for k in numbers))
        found = self.solve(replace(self.asked.rungs[finer], path=path))
        self.tried.append((finer, path.states))
        if is_lost(found).any():
            self.closed[name] = inf
            return
        case, own = self.asked.rungs[name], self.solved[name]
        off = max(difference(case, own, found, each, numbers) for each in self.asked.judged)
        others = np.delete(self._off(coarser, name), numbers)
        self.closed[name] = max(
            (1 + BY_COARSER["finer"]) * off, self._factor(name) * np.nanmax(others, initial=0.0)
        )

    def _off(self, name: str, better: str) -> np.ndarray:
        """Differences at all stops, of the worst of what is judged; shares of the largest value."""
        case, pair = self.asked.rungs[name], (self.solved[name], self.solved[better])
        found = [share(case, *pair, each)[: len(case.path.stops)] for each in self.asked.judged]
        return np.asarray(np.max(found, axis=0))

    @staticmethod
    def _factor(name: str) -> float:
        return BY_COARSER[name.partition(", ")[2] or "default"]

    def _outcome(self, name: str) -> Outcome:
        verdicts = {each: self.verdict(each) for each in self.names}
        found = verdicts[name]
        return Outcome(name, found.holds, found.error, found.by, tuple(self.tried), verdicts)


def _worse(error: float) -> float:
    """To find the worst of some errors: one that is not known is worse than any."""
    return inf if error != error else error


def _unsolved(case: Case) -> Solution:
    raise AssertionError(f"{case.key} is only planned")


__all__ = ["FOLLOWS", "Guess", "Outcome", "Promise", "Verdict", "climb", "telling", "variable_of"]
