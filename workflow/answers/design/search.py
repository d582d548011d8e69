"""The muscle that meets requirements best: the cylinder looks for it, the solid judges it.

The cylinder's optimum is solved by the solid; every measure is then taken times the ratio of both
there, and the optimum looked for again from where it was, until the solid misses no requirement by
more than ``MISSED`` and the objective is as predicted. Numbers are found by differential evolution
(with the integers among them) and, near an optimum, by SLSQP between integers that stay.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np
from scipy.optimize import differential_evolution, minimize

from geometry.refusal import Refusal
from workflow.answers.curve import Curve
from workflow.answers.design.problem import Array, Measures, Problem, Requirement, cover
from workflow.answers.store import Store

MISSED, PREDICTED = 1e-3, 2e-3  # shares: of a requirement, of the objective
INSIDE = 3e-4  # share of its limit by which an optimum keeps clear of a requirement
FAR = 0.02  # what is missed by more than that is looked for everywhere once more
ROUNDS = 5  # solids of one muscle
POPULATION, GENERATIONS = 8, 24  # per free entry; of a search
QUICK_GENERATIONS = 16  # of a search for what stands in the way
CORNER = 1e3  # added where nothing is solved: too many threads, no state
WEIGHT = 10.0  # of a requirement that is missed, beside the objective as a share
STEPS = 1e-5  # of the range of a number, in finite differences
NEIGHBOURS = 12  # steps of an integer at most, from one optimum to the next
SETS, MOST_REMOVED = 40, 3  # sets of requirements that are tried without, and their size
RATIO = 3.0  # of solid to cylinder, beyond which the difference says more
FLAT, WAYS = 0.01, (0.01, 0.02, 0.05, 0.1, 0.2, 0.4)  # of the objective; of a number, up and down


@dataclass(frozen=True)
class Trial:
    """A candidate that the solid has judged."""

    x: Array
    measures: Measures
    predicted: float
    worst: float  # largest violation

    @property
    def feasible(self) -> bool:
        """Whether it misses nothing that counts."""
        return self.worst <= MISSED


@dataclass(frozen=True)
class Missed:
    """Requirements whose removal lets the others be met, and how near they themselves can come."""

    requirements: tuple[Requirement, ...]
    measures: Measures  # of the muscle that misses them least
    worst: float


@dataclass
class Found:
    """What a search has given.

    Attributes
    ----------
    trials : muscles that the solid has judged, in order
    objective : place of the one that is as small as may be, among those of the problem
    bound : what the other one may be at most, between the ends of a trade-off
    best : the best of them; None where none meets the requirements
    missed : where none can, the smallest sets of requirements that stand in the way, by how much
    flat : between which values a number may go for one per cent of the objective
    states, solves : of the cylinder; of the solid, that were not in the store
    agreed : whether two objectives have this one optimum
    """

    problem: Problem
    objective: int = 0
    bound: Requirement | None = None
    trials: list[Trial] = field(default_factory=list)
    best: Trial | None = None
    missed: list[Missed] = field(default_factory=list)
    flat: dict[str, tuple[float, float]] = field(default_factory=dict)
    states: int = 0
    solves: int = 0
    agreed: bool = False


class Search:
    """A search for the least of one objective of a problem, the other bounded or left out."""

    def __init__(
        self, problem: Problem, store: Store, objective: int = 0, bound: Requirement | None = None
    ) -> None:
        self.problem, self.store = problem, store
        self.minimised, self.bound = objective, bound
        self.ratios: dict[str, tuple[float, float]] = {}
        self.asked = [*problem.requirements, *([bound] if bound else [])]
        self.requirements: Sequence[Requirement] = self.asked
        self._scale = 0.0

    def run(self) -> Found:
        """Look for it."""
        found = Found(self.problem, self.minimised, self.bound)
        before, looked = sum(self.store.solves.values()), self.problem.evaluations
        x = self.refined(self.everywhere(self._cost))
        for _ in range(ROUNDS):
            if self.worst(x) > FAR:
                x = self.refined(self.everywhere(self._cost))  # once more, with what is known now
                if self.worst(x) > FAR:
                    found.missed = self.in_the_way()
                    break
            x = self.problem.rounded(x)
            trial = self._tried(x)
            if trial is None:
                break
            found.trials.append(trial)
            objective = self.objective(trial.measures)
            near = abs(trial.predicted - objective) <= PREDICTED * abs(objective)
            if trial.feasible and near:
                break
            x = self.refined(x)
        good = [trial for trial in found.trials if trial.feasible]
        found.best = min(good, key=lambda t: self.objective(t.measures), default=None)
        if found.best is None and not found.missed:
            found.missed = self.in_the_way()
        if found.best is not None:
            found.flat = self.flat(found.best.x)
        found.states = self.problem.evaluations - looked
        found.solves = sum(self.store.solves.values()) - before
        return found

    # --- measures, corrected ------------------------------------------------------------------

    def measures(self, x: Array) -> Measures | None:
        """By the cylinder, with the ratios of the solid to it."""
        cheap = self.problem.cheap(x)
        if cheap is None:
            return None
        plain = (1.0, 0.0)
        return {
            name: value * self.ratios.get(name, plain)[0] + self.ratios.get(name, plain)[1]
            for name, value in cheap.items()
        }

    def objective(self, measures: Measures) -> float:
        """What is to be as small as may be."""
        return measures[self.problem.objectives[self.minimised]]

    def violations(self, x: Array, requirements: Iterable[Requirement]) -> list[float]:
        """By how much requirements are missed."""
        measures = self.measures(x)
        if measures is None:
            return [CORNER for _ in requirements]
        return [requirement.violation(measures) for requirement in requirements]

    def worst(self, x: Array) -> float:
        """Largest of them."""
        return max(self.violations(x, self.requirements))

    def _tried(self, x: Array) -> Trial | None:
        """A candidate by the solid, whose ratios are taken over; None where it has no states."""
        problem, predicted = self.problem, self.measures(x)
        if predicted is None:
            return None
        studied = problem.muscle(x)
        curves = {}
        for pressure in problem.contractions(studied):
            case = problem.case(studied, pressure)
            curves[pressure] = Curve(case, self.store.solution(case))
        measures = problem.by_curves(studied, curves)
        cheap = problem.cheap(x)
        if measures is None or cheap is None:
            return None
        for name, value in measures.items():
            by = cheap[name]
            ratio = value / by if by else np.inf
            close = 1 / RATIO < ratio < RATIO
            self.ratios[name] = (ratio, 0.0) if close else (1.0, value - by)
        worst = max(r.violation(measures) for r in self.requirements)
        return Trial(x, measures, self.objective(predicted), worst)

    # --- looking ------------------------------------------------------------------------------

    def _cost(self, x: Array) -> float:
        """The objective as a share, and what is missed."""
        early = self._misfit(x)
        if early:
            return early
        measures = self.measures(x)
        if measures is None:
            return CORNER
        missed = sum(max(r.violation(measures), 0.0) for r in self.requirements)
        objective = self.objective(measures)
        self._scale = self._scale or abs(objective)  # by the first muscle that was looked at
        return WEIGHT * missed + objective / (self._scale or 1.0)

    def _misfit(self, x: Array) -> float:
        """What is missed without any state: too many threads, too long; 0 if nothing is."""
        try:
            studied = self.problem.muscle(x)
        except Refusal:
            return 2 * CORNER
        known = {"length": studied.muscle.length, "thread_cover": cover(studied), "scale": 0.0}
        off = [r.violation(known) for r in self.requirements if r.measure in known]
        worst = max(off, default=0.0)
        return CORNER * (1 + worst) if worst > 0.02 else 0.0

    def everywhere(self, cost: Callable[[Array], float], generations: int = GENERATIONS) -> Array:
        """The best candidate of the whole range."""
        found = differential_evolution(
            cost,
            self.problem.bounds,
            integrality=self.problem.integral,
            popsize=POPULATION,
            maxiter=generations,
            tol=1e-3,
            init="latinhypercube",
            polish=False,
            rng=self.problem.entry.seed,
        )
        return np.asarray(np.where(self.problem.integral, np.round(found.x), found.x))

    def refined(self, x: Array) -> Array:
        """The optimum near a candidate, its integers moved as long as that helps."""
        best = self.polished(x)
        count = len(self.problem.numbers)
        if not self.problem.has_threads:
            return best
        low, high = self.problem.bounds[count]
        for step in (1, -1):
            for _ in range(NEIGHBOURS):
                moved = best.copy()
                moved[count] += step
                if not low <= moved[count] <= high:
                    break
                moved = self.polished(moved)
                if not self._cost(moved) < self._cost(best) - 1e-6:
                    break
                best = moved
        return best

    def polished(self, x: Array, held: int | None = None) -> Array:
        """The optimum over the numbers (but one that is ``held``), its integers as they are."""
        numbers = [k for k in range(len(self.problem.numbers)) if k != held]
        if not numbers:
            return x
        bounds = np.array([self.problem.bounds[k] for k in numbers])
        low, size = bounds[:, 0], bounds[:, 1] - bounds[:, 0]

        def candidate(z: Array) -> Array:
            full = x.copy()
            full[numbers] = low + np.clip(z, 0, 1) * size
            return full

        def objective(z: Array) -> float:
            measures = self.measures(candidate(z))
            if measures is None:
                return CORNER
            return self.objective(measures) / (self._scale or 1.0)

        def margins(z: Array) -> Array:
            violations = np.array(self.violations(candidate(z), self.requirements))
            return np.asarray(-np.clip(violations + INSIDE, -10, 10))

        start = np.clip((x[numbers] - low) / size, 0, 1)
        found = minimize(
            objective,
            start,
            method="SLSQP",
            bounds=[(0.0, 1.0)] * len(numbers),
            constraints={"type": "ineq", "fun": margins},
            options={"eps": STEPS, "maxiter": 40, "ftol": 1e-8},
        )
        there = candidate(found.x)
        return there if self._cost(there) <= self._cost(x) else x

    # --- what can be said of it ---------------------------------------------------------------

    def in_the_way(self) -> list[Missed]:
        """The smallest sets of requirements without which the others can be met, nearest first."""
        every, tried = list(self.requirements), 0
        for size in range(1, min(MOST_REMOVED, len(every)) + 1):
            found = []
            for removed in combinations(every, size):
                tried += 1
                if tried > SETS:
                    break
                missed = self._without(removed)
                if missed is not None:
                    found.append(missed)
            if found:
                return sorted(found, key=lambda missed: missed.worst)
        return []

    def _without(self, removed: Sequence[Requirement]) -> Missed | None:
        """The muscle that misses some requirements least and meets the others, if one does."""
        kept = [r for r in self.asked if r not in removed]

        def cost(x: Array) -> float:
            self.requirements = kept
            early = self._misfit(x)
            measures = None if early else self.measures(x)
            if measures is None:
                return early or CORNER
            off = sum(max(r.violation(measures), 0.0) for r in kept)
            return WEIGHT * off + max(r.violation(measures) for r in removed)

        try:
            x = self.everywhere(cost, QUICK_GENERATIONS)
            worst = max(self.violations(x, kept), default=0.0)
        finally:
            self.requirements = self.asked
        measures = self.measures(x)
        if measures is None or worst > 10 * MISSED:
            return None
        return Missed(tuple(removed), measures, max(r.violation(measures) for r in removed))

    def flat(self, x: Array) -> dict[str, tuple[float, float]]:
        """Between which values every number may go, the others following, for little."""
        measures = self.measures(x)
        assert measures is not None
        least = self.objective(measures)
        found = {}
        for k, name in enumerate(self.problem.numbers):
            ends = []
            for sign in (-1, 1):
                end = float(x[k])
                for way in WAYS:
                    moved = x.copy()
                    moved[k] = np.clip(x[k] * (1 + sign * way), *self.problem.bounds[k])
                    moved = self.polished(moved, held=k)
                    there = self.measures(moved)
                    if there is None or self.worst(moved) > MISSED:
                        break
                    if self.objective(there) > least + FLAT * abs(least):
                        break
                    end = float(moved[k])
                ends.append(end)
            found[name] = ends[0], ends[1]
        return found


def looked_for(
    problem: Problem, store: Store, objective: int = 0, bound: Requirement | None = None
) -> Found:
    """The muscle that has the least of an objective of a problem.

    Raises
    ------
    StudyError
        If a curve could not be solved for a reason that says nothing about the muscle.
    """
    return Search(problem, store, objective, bound).run()
