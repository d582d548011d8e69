"""Climbs, by made-up curves whose errors are known: what is solved, what is taken, what is said."""

from dataclasses import replace
from math import inf, isnan

import numpy as np
import pytest

from solver.load_path import LoadPath
from solver.record import Solution, unreached
from solver.status import CaseStatus, Flag, StateStatus
from workflow.plan import promise as module
from workflow.plan.effect_costs import MESHES
from workflow.plan.judged import FOLLOWS, ZERO, difference
from workflow.plan.like_muscles import Guess
from workflow.plan.promise import Promise, climb, telling

STOPS = (0.0, 0.05, 0.1, 0.15, 0.2)
FORCE = np.array([600.0, 400.0, 250.0, 120.0, 10.0])
RUNGS = {"cylinder": "cylinder", "membrane": "membrane", "solid": "solid", "solid, finer": "solid"}
SECONDS = {
    "cylinder": 0.1,
    "membrane": 0.2,
    "solid, coarser": 0.9,
    "solid": 1.0,
    "solid, finer": 5.0,
}


@pytest.fixture
def rungs(make_case):
    path = LoadPath(kind="isobaric", held=0.3, stops=STOPS)
    cases = {name: make_case(model=model, path=path) for name, model in RUNGS.items()}
    numerics = cases["solid"].numerics
    finer = replace(numerics, section=replace(numerics.section, refinement=2))
    return cases | {"solid, finer": replace(cases["solid"], numerics=finer)}


def guessed(monkeypatch, **errors):
    """Guesses by rung, each with a spread of a factor of two to either side; or none.

    Of muscles that are known to be pushed, of six.
    """

    def made(case, name, judged, *, pushed=None):
        median = errors.get(name.replace(", ", "_"))
        if median is None:
            return None
        spread = 6 if pushed else 2
        factors = tuple(float(f) for f in spread ** np.linspace(-1, 1, 99))
        return Guess(median, spread * median, factors, 0.0, SECONDS[name], 99)

    monkeypatch.setattr(module, "guess", made)


class Solver:
    """Gives curves that are off by known shares, and counts what it is asked for."""

    def __init__(self, rungs, lost=(), smoothed=(), none=False, at=None, det_f=None, **off):
        self.rungs, self.off, self.lost, self.smoothed = rungs, off, lost, smoothed
        self.good = StateStatus.INVALID_STATE if none else StateStatus.CONVERGED
        self.at = at or {}  # rungs that are off at one state alone
        self.det_f = det_f or {}  # by rung, of the last stop, which is pushed then
        self.pushed = -10.0
        self.asked = []
        self.known = {}

    def __call__(self, case):
        name = next(n for n, c in self.rungs.items() if self.same(c, case))
        self.asked.append((name, len(case.path.stops)))
        at = [STOPS.index(stop) for stop in case.path.stops]
        where = np.array([self.at.get(name, k) == k for k in at])
        off = self.off.get(name.replace(", ", "_"), 0) * 600 * where
        states = unreached(len(at)) | {"force": FORCE[at] + off}
        states["contraction"] = np.array(case.path.stops)
        if name in self.det_f:
            states["min_det_f"] = np.where(FORCE[at] == FORCE[-1], self.det_f[name], 0.95)
            states["force"] = np.where(FORCE[at] == FORCE[-1], self.pushed, states["force"])
        status = [self.good] * len(at)
        if name in self.lost:
            status[-1] = StateStatus.INVALID_STATE
        flags = [frozenset({Flag.SMOOTHED} if name in self.smoothed else ())] * len(at)
        self.known[case.key] = Solution(
            status=CaseStatus.CONVERGED, reason="", states=states, state_status=status, flags=flags
        )
        return self.known[case.key]

    @staticmethod
    def same(one, other):
        return one.model == other.model and one.numerics == other.numerics

    def there(self, case):
        return self.known.get(case.key)


def kept(rungs, solver, tolerance):
    return climb(Promise(tolerance, (FOLLOWS,), rungs), solver, solver.there)


def test_like_muscles_are_enough(rungs, monkeypatch):
    guessed(monkeypatch, cylinder=0.1, membrane=0.004, solid=1e-4, solid_finer=1e-5)
    solver = Solver(rungs, membrane=0.004)
    end = kept(rungs, solver, 0.02)
    assert (end.rung, end.holds, solver.asked) == ("membrane", True, [("membrane", 5)])
    assert end.by == "estimated from 99 like muscles"
    assert end.error == pytest.approx(0.008)


def test_a_rung_that_loses_states_is_left(rungs, monkeypatch):
    guessed(monkeypatch, cylinder=0.1, membrane=0.004, solid=1e-4, solid_finer=1e-5)
    solver = Solver(rungs, lost=("membrane",))
    end = kept(rungs, solver, 0.02)
    assert (end.rung, end.holds) == ("solid", True)
    assert end.verdicts["membrane"].error == inf


def test_a_smoothed_state_is_none_of_a_cheap_rung(rungs, monkeypatch):
    guessed(monkeypatch, cylinder=0.1, membrane=0.004, solid=1e-4, solid_finer=1e-5)
    assert kept(rungs, Solver(rungs, smoothed=("membrane", "solid")), 0.02).rung == "solid"


@pytest.fixture
def many(rungs, monkeypatch):
    """The same curve with so many states that a look at a few of them is cheap."""
    stops = tuple(round(0.2 * k / 80, 6) for k in range(81))
    monkeypatch.setattr(__name__ + ".STOPS", stops)
    monkeypatch.setattr(__name__ + ".FORCE", 600 - 2950 * np.array(stops))
    return {n: replace(c, path=replace(c.path, stops=stops)) for n, c in rungs.items()}


def test_what_may_do_is_checked_at_a_few_states_of_many(many, monkeypatch):
    guessed(monkeypatch, cylinder=0.1, membrane=0.006, solid=1e-4, solid_finer=1e-5)
    solver = Solver(many, membrane=0.006)
    end = kept(many, solver, 0.01)
    assert [name for name, _ in solver.asked] == ["membrane", "solid"]
    assert solver.asked[1][1] <= 4
    assert (end.rung, end.holds) == ("membrane", True)
    assert end.by == "measured here by solid at telling states"
    assert end.error == pytest.approx(0.006 / 1.006 + 2e-4)


def test_a_check_that_fails_is_climbed_over(many, monkeypatch):
    guessed(monkeypatch, cylinder=0.1, membrane=0.006, solid=1e-4, solid_finer=1e-5)
    solver = Solver(many, membrane=0.013)
    end = kept(many, solver, 0.01)
    assert [name for name, _ in solver.asked] == ["membrane", "solid", "solid"]
    assert (end.rung, end.holds) == ("solid", True)
    assert end.verdicts["membrane"].by == "measured here by solid at all states"


def test_of_few_states_the_better_rung_is_solved_at_once(rungs, monkeypatch):
    guessed(monkeypatch, cylinder=0.1, membrane=0.006, solid=1e-4, solid_finer=1e-5)
    solver = Solver(rungs, membrane=0.006)
    assert kept(rungs, solver, 0.01).rung == "solid"
    assert solver.asked == [("solid", 5)]


@pytest.fixture
def meshes(rungs):
    """With the coarser mesh of the planner, in its place."""
    numerics = replace(rungs["solid"].numerics, **MESHES["coarser"])
    coarser = replace(rungs["solid"], numerics=numerics)
    first = {name: rungs[name] for name in ("cylinder", "membrane")}
    return first | {"solid, coarser": coarser} | {n: rungs[n] for n in ("solid", "solid, finer")}


def test_what_no_muscles_are_like_is_measured_by_two_meshes(meshes, monkeypatch):
    guessed(monkeypatch)
    solver = Solver(meshes, solid_coarser=0.003)
    end = kept(meshes, solver, 0.01)
    assert solver.asked == [("solid, coarser", 5), ("solid", 5)]
    assert (end.rung, end.holds) == ("solid", True)
    assert end.by == "measured here by solid, coarser"
    assert end.error == pytest.approx(1.5 * 0.003 / 1.003)


def test_two_meshes_are_cheaper_than_the_finest(meshes, monkeypatch):
    known = {"solid_coarser": 9e-3, "solid": 6e-3, "solid_finer": 1e-4}
    guessed(monkeypatch, cylinder=0.1, membrane=0.03, **known)
    solver = Solver(meshes, solid_coarser=0.002)
    end = kept(meshes, solver, 0.01)
    assert solver.asked == [("solid, coarser", 5), ("solid", 5)]
    assert (end.rung, end.by) == ("solid", "measured here by solid, coarser")


def test_a_better_rung_is_taken_that_costs_hardly_more(meshes, monkeypatch):
    known = {"solid_coarser": 4e-3, "solid": 1e-3, "solid_finer": 1e-4}
    guessed(monkeypatch, cylinder=0.1, membrane=0.03, **known)
    solver = Solver(meshes)
    assert kept(meshes, solver, 0.01).rung == "solid"
    assert kept(meshes, solver, 0.005).rung == "solid"
    assert solver.asked == [("solid", 5)]
    monkeypatch.setattr(module, "MORE", 1.0)
    assert kept(meshes, Solver(meshes), 0.01).rung == "solid, coarser"


def test_a_mesh_that_has_lost_states_is_refined_no_further(meshes, monkeypatch):
    guessed(monkeypatch)
    solver = Solver(meshes, lost=("solid, coarser", "solid"), solid_coarser=0.02)
    end = kept(meshes, solver, 0.01)
    assert solver.asked == [("solid, coarser", 5)]
    assert (end.rung, end.holds, end.error) == ("solid, coarser", False, inf)
    assert not kept(meshes, solver, 0.05).holds  # a finer mesh may have what this has lost


def test_a_folded_tube_is_refined_no_further(meshes, monkeypatch):
    guessed(monkeypatch, solid_coarser=0.02, solid=0.02, solid_finer=1e-4)
    solver = Solver(meshes, det_f={"solid, coarser": 0.9, "solid": 0.7}, solid_coarser=0.009)
    for name in ("solid, coarser", "solid"):
        solver(meshes[name])
    assert kept(meshes, solver, 0.015).holds
    end = kept(meshes, solver, 0.01)
    assert len(solver.asked) == 2  # though like muscles would prove the finest
    assert (end.rung, end.holds) == ("solid", False)
    assert end.error == pytest.approx(1.5 * 0.009, rel=0.01)
    assert end.verdicts["solid, finer"].by == "not known, as the tube is folded"
    solver(meshes["solid, finer"])  # what is there is looked at nevertheless
    assert kept(meshes, solver, 0.01).rung == "solid, finer"


def test_of_a_pushed_muscle_say_those_that_are_pushed_too(meshes, monkeypatch):
    guessed(monkeypatch, solid=0.002, solid_finer=0.0019)
    assert kept(meshes, Solver(meshes), 0.005).by == "estimated from 99 like muscles"
    pressed = {"solid, coarser": 0.9, "solid": 0.9}
    solver = Solver(meshes, det_f=pressed, solid_coarser=0.002)
    end = kept(meshes, solver, 0.005)
    assert [name for name, _ in solver.asked] == ["solid", "solid, coarser"]
    assert (end.rung, end.holds, end.by) == ("solid", True, "measured here by solid, coarser")
    by_like = end.verdicts["solid, finer"]
    assert by_like.error == pytest.approx(6 * 0.0019)
    assert not by_like.holds


@pytest.mark.parametrize(
    ("lost", "force", "expected"),
    [((), 10.0, False), ((), -10.0, True), (("solid",), -10.0, None), (("solid",), 10.0, None)],
)
def test_whether_a_muscle_is_pushed_is_not_known_of_states_that_are_lost(
    meshes, monkeypatch, lost, force, expected
):
    asked = []
    guessed(monkeypatch)
    monkeypatch.setattr(module, "guess", lambda *_, pushed=None: asked.append(pushed))
    solver = Solver(meshes, lost=lost, det_f={"solid": 0.95})
    solver.pushed = force
    solver(meshes["solid"])
    promise = Promise(0.01, (FOLLOWS,), meshes)
    module._Climb(promise, solver, solver.there).verdict("solid, finer")
    assert asked[-1] is expected


def test_like_muscles_say_nothing_of_a_fold(meshes, monkeypatch):
    guessed(monkeypatch, solid=1e-4)
    solver = Solver(meshes, det_f={"solid, coarser": 0.9, "solid": 0.6}, solid_coarser=0.01)
    end = kept(meshes, solver, 0.05)
    assert [name for name, _ in solver.asked] == ["solid", "solid, coarser"]
    assert (end.holds, end.by) == (True, "measured here by solid, coarser")


@pytest.mark.parametrize(("det_f", "force"), [(0.7, 10.0), (0.8, -10.0)])
def test_a_tube_that_pulls_or_is_hardly_pressed_is_refined(meshes, monkeypatch, det_f, force):
    guessed(monkeypatch)
    solver = Solver(meshes, det_f={"solid, coarser": 0.95, "solid": det_f}, solid_coarser=0.009)
    solver.pushed = force
    kept(meshes, solver, 0.005)
    assert [name for name, _ in solver.asked] == ["solid, coarser", "solid", "solid, finer"]


def test_a_finer_mesh_is_solved_where_coarser_ones_leave_it_open(meshes, monkeypatch):
    guessed(monkeypatch)
    solver = Solver(meshes, at={"solid, coarser": 0}, solid_coarser=0.009, solid=0.0)
    solver.off["solid_finer"] = 0.001
    end = kept(meshes, solver, 0.01)
    assert solver.asked == [("solid, coarser", 5), ("solid", 5), ("solid, finer", 1)]
    assert (end.rung, end.holds) == ("solid", True)
    assert end.by == "measured here by solid, finer where coarser meshes leave it open"
    assert end.error == pytest.approx(1.5 * 0.001)
    assert kept(meshes, solver, 0.02).by == "measured here by solid, coarser"


def test_where_that_proves_nothing_all_of_the_finer_mesh_is_solved(meshes, monkeypatch):
    guessed(monkeypatch)
    off = {"solid_coarser": 0.009, "solid_finer": 0.03}
    solver = Solver(meshes, at={"solid, coarser": 0}, **off)
    end = kept(meshes, solver, 0.01)
    assert solver.asked[2:] == [("solid, finer", 1), ("solid, finer", 5)]
    assert end.rung == "solid, finer"


def test_a_finer_mesh_that_loses_an_open_state_is_not_solved_elsewhere(meshes, monkeypatch):
    guessed(monkeypatch)
    solver = Solver(meshes, at={"solid, coarser": 0}, lost=("solid, finer",), solid_coarser=0.009)
    end = kept(meshes, solver, 0.01)
    assert solver.asked[2:] == [("solid, finer", 1)]
    assert (end.rung, end.holds) == ("solid", False)


def test_a_coarser_mesh_that_has_lost_states_says_nothing_of_a_finer_one(meshes, monkeypatch):
    known = {"solid_coarser": 9e-3, "solid": 3e-3, "solid_finer": 1e-4}
    guessed(monkeypatch, cylinder=0.1, membrane=0.03, **known)
    solver = Solver(meshes, lost=("solid, coarser",))
    for name in ("solid, coarser", "solid"):
        solver(meshes[name])
    end = kept(meshes, solver, 0.01)
    assert (end.rung, end.holds, end.by) == ("solid", True, "estimated from 99 like muscles")


def test_two_meshes_that_agree_are_wrong_where_a_finer_one_says_so(meshes, monkeypatch):
    guessed(monkeypatch)
    solver = Solver(meshes, solid_finer=0.02)
    for name in ("solid, coarser", "solid", "solid, finer"):
        solver(meshes[name])
    end = kept(meshes, solver, 0.005)
    assert not end.holds
    assert end.verdicts["solid"].by == "measured here by solid, finer at all states"
    assert end.verdicts["solid"].error == pytest.approx(1.5 * 0.02)


@pytest.mark.parametrize("lost", ["solid, coarser", "solid"])
def test_a_mesh_that_has_lost_states_is_not_refined(meshes, monkeypatch, lost):
    """Even where like muscles would prove a finer one: it mostly loses states as well."""
    guessed(monkeypatch, solid_finer=1e-4)
    solver = Solver(meshes, lost=(lost,))
    solver(meshes[lost])
    end = kept(meshes, solver, 0.01)
    assert "solid, finer" not in {name for name, _ in solver.asked}
    assert not end.holds


def test_a_rung_that_has_lost_states_proves_no_other(meshes, monkeypatch):
    guessed(monkeypatch)
    solver = Solver(meshes, lost=("solid",), solid_coarser=0.003)
    end = kept(meshes, solver, 0.01)
    assert [name for name, _ in solver.asked][:2] == ["solid, coarser", "solid"]
    assert not end.verdicts["solid, coarser"].by.startswith("measured here by solid at")


def test_the_best_there_is_is_no_promise_kept(meshes, monkeypatch):
    guessed(monkeypatch)
    solver = Solver(meshes, solid_coarser=0.9, solid=0.3)
    end = kept(meshes, solver, 0.01)
    assert (end.rung, end.holds) == ("solid, finer", False)
    assert end.error == pytest.approx(0.5 * 0.3 / 1.3)


def test_where_no_rung_has_a_state_that_is_said(rungs, monkeypatch):
    guessed(monkeypatch, cylinder=0.1, membrane=0.004, solid=1e-4, solid_finer=1e-5)
    end = kept(rungs, Solver(rungs, none=True), 0.02)
    assert (end.holds, end.error, end.by) == (False, inf, "no state is valid")


def test_a_state_that_no_rung_has_is_no_failure_of_one(rungs, monkeypatch):
    guessed(monkeypatch, cylinder=0.1, membrane=0.004, solid=1e-4, solid_finer=1e-5)
    solver = Solver(rungs, lost=tuple(rungs), membrane=0.004)
    solver(rungs["solid, finer"])
    end = kept(rungs, solver, 0.02)
    assert (end.rung, end.holds) == ("solid, finer", True)
    by = "measured here by solid, finer at all states; 1 of them no rung has"
    assert end.verdicts["membrane"].by == by


def test_a_curve_that_is_nowhere_at_zero_force_lacks_none_there(meshes, monkeypatch):
    guessed(monkeypatch)
    path = replace(meshes["solid"].path, zero_force=True)
    curves = {name: replace(case, path=path) for name, case in meshes.items()}
    known = {}

    def solve(case):
        states = unreached(6) | {"force": np.append(FORCE, np.nan)}
        status = [StateStatus.CONVERGED] * 5 + [StateStatus.NO_ROOT]
        flags = [frozenset()] * 6
        known[case.key] = Solution(
            status=CaseStatus.CONVERGED, reason="", states=states, state_status=status, flags=flags
        )
        return known[case.key]

    promise = Promise(0.01, (FOLLOWS, ZERO), curves)
    end = climb(promise, solve, lambda case: known.get(case.key))
    assert (end.rung, end.holds, end.error) == ("solid", True, 0.0)
    assert len(known) == 2


def test_the_finest_mesh_may_lose_what_a_coarser_one_has(meshes, monkeypatch):
    guessed(monkeypatch, cylinder=0.1, membrane=0.03, solid_coarser=0.02, solid_finer=1e-4)
    solver = Solver(meshes, lost=("solid, finer",), solid_coarser=0.004)
    end = kept(meshes, solver, 0.01)
    assert (end.rung, end.holds, end.by) == ("solid", True, "measured here by solid, coarser")
    assert end.verdicts["solid, finer"].error == inf


def test_one_model_alone_is_not_known(rungs, monkeypatch):
    guessed(monkeypatch)
    solver = Solver(rungs)
    end = kept({"cylinder": rungs["cylinder"]}, solver, 0.02)
    assert (end.rung, end.holds, end.by) == ("cylinder", False, "not known")
    assert isnan(end.error)


def test_a_later_climb_solves_nothing_that_is_there(rungs, monkeypatch):
    guessed(monkeypatch, cylinder=0.1, membrane=0.004, solid=1e-4, solid_finer=1e-5)
    solver = Solver(rungs, membrane=0.004)
    assert kept(rungs, solver, 0.001).rung == "solid"
    before = list(solver.asked)
    end = kept(rungs, solver, 0.02)  # looser: a better one is there and costs nothing
    assert (end.rung, solver.asked) == ("solid", before)


def test_the_tolerance_and_what_is_judged_are_of_the_key(rungs):
    one = Promise(0.01, (FOLLOWS,), rungs)
    assert one.key == Promise(0.01, (FOLLOWS,), rungs).key
    others = {
        Promise(0.02, (FOLLOWS,), rungs).key,
        Promise(0.01, (FOLLOWS, "volume"), rungs).key,
        Promise(0.01, (FOLLOWS,), rungs, after=()).key,
    }
    assert len(others | {one.key}) == 4


def test_telling_states_are_the_ends_the_bend_and_no_force(rungs):
    case = rungs["membrane"]
    stops = tuple(round(0.02 * k, 2) for k in range(11))
    case = replace(case, path=replace(case.path, stops=stops))
    force = np.where(
        np.array(stops) < 0.05, 500 - 5000 * np.array(stops), 120 - 800 * np.array(stops)
    )
    states = unreached(11) | {"force": force, "contraction": np.array(stops)}
    found = Solution(
        status=CaseStatus.CONVERGED,
        reason="",
        states=states,
        state_status=[StateStatus.CONVERGED] * 11,
    )
    numbers = telling(case, found)
    assert {0, 10} <= set(numbers)
    assert int(np.argmin(np.abs(force))) in numbers
    assert {2, 3} & set(numbers)


def test_the_difference_is_a_share_of_the_largest_value(rungs):
    solver = Solver(rungs, membrane=0.01, lost=("cylinder",))
    curves = {name: solver(case) for name, case in rungs.items()}
    case = rungs["membrane"]
    off = difference(case, curves["membrane"], curves["solid"], FOLLOWS)
    assert off == pytest.approx(6 / 606, rel=1e-6)
    lost = difference(rungs["cylinder"], curves["cylinder"], curves["solid"], FOLLOWS)
    assert lost == inf


def of_threshold(make_case, pressure, status=StateStatus.CONVERGED):
    """A curve at constant length whose last state is that of zero force, at a pressure."""
    path = LoadPath(kind="isometric", held=0.0, stops=(0.1, 0.2), zero_force=True)
    states = unreached(3) | {"pressure": np.array([0.1, 0.2, pressure])}
    states["force"] = np.array([50.0, 100.0, 0.0])
    each = [StateStatus.CONVERGED, StateStatus.CONVERGED, status]
    return make_case(model="solid", path=path), Solution(
        status=CaseStatus.CONVERGED, reason="", states=states, state_status=each
    )


@pytest.mark.parametrize(
    ("own", "better", "expected"),
    [(0.11, 0.1, 0.1), (0.0, 0.0, 0.0), (1e-13, 0.0, 0.0), (0.01, 0.0, 5e4)],  # of 1e-6 of 0.2 MPa
)
def test_a_threshold_is_judged_by_itself_and_may_be_at_no_pressure(
    make_case, own, better, expected
):
    """As of a muscle at its own length, which pulls as soon as it has any."""
    case, found = of_threshold(make_case, own)
    off = difference(case, found, of_threshold(make_case, better)[1], ZERO)
    assert off == pytest.approx(expected, rel=1e-6, abs=1e-6)


def test_a_threshold_that_the_better_rung_has_not_is_no_error_of_the_other(make_case):
    none = StateStatus.INVALID_STATE
    case, found = of_threshold(make_case, 0.1, none)
    assert difference(case, found, of_threshold(make_case, 0.1, none)[1], ZERO) == 0
    assert difference(case, found, of_threshold(make_case, 0.1)[1], ZERO) == inf
