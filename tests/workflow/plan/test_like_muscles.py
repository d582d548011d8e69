"""First guesses: of no size, with the coverage that is said, silent beyond what was tried."""

from dataclasses import replace

import numpy as np
import pytest

from geometry.muscle import Braid
from solver import rubber
from solver.load_path import LoadPath
from solver.material import Thread
from solver.record import unreached
from workflow.analyses.ladder.cases import RUNGS as OF_LADDER
from workflow.plan import like_muscles, likeness, mesh_error
from workflow.plan.judged import FOLLOWS

from ..synthetic import converged

PATH = LoadPath(kind="isobaric", held=0.3, stops=(0.0, 0.05, 0.1, 0.15, 0.2))
RUNGS = ("cylinder", "membrane", "solid, coarser", "solid", "solid, finer")


def scaled(case, factor):
    """The same muscle, so many times as large: forces go with the square."""
    muscle, braid = case.muscle, case.muscle.braid
    wider = tuple(factor * d for d in braid.layer_diameters)
    larger = replace(
        muscle,
        inner_diameter=factor * muscle.inner_diameter,
        wall_thickness=factor * muscle.wall_thickness,
        length=factor * muscle.length,
        cap_length=factor * muscle.cap_length,
        braid=Braid(lead=factor * braid.lead, threads=braid.threads, layer_diameters=wider),
    )
    return replace(case, muscle=larger, thread=Thread(stiffness=factor**2 * case.thread.stiffness))


def test_the_table_has_what_the_ladder_solves_and_finer_rungs_cost_more():
    assert like_muscles.rungs() == set(OF_LADDER) == set(RUNGS)
    costs = [like_muscles.seconds(rung) for rung in RUNGS]
    assert costs == sorted(costs)


def test_muscles_of_one_shape_have_one_guess(make_case):
    case = make_case(model="solid", path=PATH)
    own, larger = likeness.groups(case), likeness.groups(scaled(case, 2.0))
    assert own == pytest.approx(larger)
    one, other = (like_muscles.guess(c, "solid") for c in (case, scaled(case, 2.0)))
    assert one.median == pytest.approx(other.median)


def test_a_law_that_was_left_out_has_the_coverage_that_is_said():
    """Of noise that is known: laws of a hundred muscles against ten thousand others."""
    random = np.random.default_rng(5)
    slopes = random.normal(size=6)

    def drawn(count):
        x = random.normal(size=(count, 6))
        return x, np.exp(x @ slopes - 6 + 0.7 * random.normal(size=count))

    x, errors = drawn(100)
    kinds = np.array(["isobaric"] * 100)
    law = like_muscles.Law.fit(x, errors, np.arange(100), kinds)
    others, true = drawn(10000)
    value, wider = law.at(others, "isobaric")
    known = np.isfinite(value)
    assert known.mean() > 0.95  # the others are further out than any of the hundred
    within = np.log(true) <= value + wider * law.quantile(like_muscles.COVERAGE)
    covered = within[known].mean()
    assert covered == pytest.approx(like_muscles.COVERAGE, abs=0.04)


@pytest.mark.parametrize("rung", RUNGS)
def test_what_is_said_holds_for_the_muscles_of_the_table(rung):
    law = like_muscles._law(rung, FOLLOWS)
    assert len(law.spread) > 60
    assert np.mean(law.spread <= law.quantile(like_muscles.COVERAGE)) >= like_muscles.COVERAGE
    assert max(width for _, width in law.classes.values()) < 1.3  # a factor of 3.7


def test_where_muscles_are_pushed_they_are_further_from_the_law(make_case):
    """Most of them, as a fold is in no group; and what is not known is between the two."""
    case = make_case(model="solid", path=PATH)
    pulled, known, pushed = (
        like_muscles.guess(case, "solid", pushed=each) for each in (False, None, True)
    )
    assert pulled.high < known.high < pushed.high
    assert pushed.high > 2 * pulled.high


def test_a_class_has_its_own_mean_and_width_unless_it_is_small():
    random = np.random.default_rng(3)
    x = random.normal(size=(90, 2))
    wide = np.arange(90) % 3 == 0  # 30 of them
    off = np.where(wide, 1 + 1.5 * random.normal(size=90), 0.3 * random.normal(size=90))
    classes = np.where(wide, "isobaric, pushed", "isobaric, not pushed").astype(object)
    classes[:2] = "isometric", "isometric, pushed"
    law = like_muscles.Law.fit(x, np.exp(x @ [1.0, -1.0] - 6 + off), np.arange(90), classes)
    assert law.factors[1:] == pytest.approx([1.0, -1.0] * law.scale, abs=0.1)  # not the wide ones'
    means, widths = zip(*(law.classes[f"isobaric, {n}pushed"] for n in ("", "not ")), strict=True)
    assert means[0] - means[1] == pytest.approx(1, abs=0.5)
    assert widths == pytest.approx((1.5, 0.3), rel=0.3)
    assert "isometric, pushed" not in law.classes
    at = [law.at(x[:1], name) for name in ("isometric", "isometric, pushed")]
    assert at[0] == at[1]


def test_better_rungs_are_guessed_to_be_more_exact(make_case):
    case = make_case(model="solid", path=PATH)
    medians = [like_muscles.guess(case, rung).median for rung in RUNGS]
    assert medians == sorted(medians, reverse=True)
    assert 0.02 < medians[0] < 0.2
    chances = [like_muscles.guess(case, "membrane").chance(t) for t in (0.001, 0.01, 0.05)]
    assert chances == sorted(chances)
    assert chances[0] < 0.1 < 0.9 < chances[2]


@pytest.mark.parametrize(
    "change",
    [
        {"path": LoadPath(kind="isobaric", held=3.0, stops=(0.0, 0.1))},
        {"path": LoadPath(kind="isometric", held=0.1, stops=(0.001, 0.1))},
        {"thread": Thread(stiffness=1.0)},
        {"rubber": rubber.from_dict({"c10": 30.0, "c01": 0.0, "kappa": 1e4})},
    ],
)
def test_beyond_what_was_tried_nothing_is_said(make_case, change):
    case = make_case(**{"model": "solid", "path": PATH} | change)
    assert like_muscles.guess(case, "solid") is None


@pytest.mark.parametrize("rung", ["membrane", "solid"])
def test_in_every_range_and_yet_like_none(make_case, muscle, rung):
    """An isometric curve from a low pressure up: the table has none so wide."""
    stops = tuple(round(0.02 * k, 2) for k in range(21))
    braid = Braid.from_angle(angle=22, threads=48, layer_diameters=(22.6, 23.8))
    finger = replace(
        muscle, inner_diameter=22, wall_thickness=1.5, length=200, cap_length=6, braid=braid
    )
    path = LoadPath(kind="isometric", held=0.1, stops=stops)
    case = make_case(model="solid", muscle=finger, path=path)
    assert like_muscles.is_like(case)
    assert like_muscles.guess(case, rung) is None


def test_nothing_is_said_of_a_bare_tube_or_of_zero_force(make_case, bare_tube):
    assert (
        like_muscles.guess(make_case(model="solid", path=PATH, muscle=bare_tube), "solid") is None
    )
    case = make_case(model="solid", path=PATH)
    assert like_muscles.guess(case, "solid", (FOLLOWS, "zero_force")) is None


def test_a_muscle_of_latex_has_a_bar_of_its_own(make_case, muscle):
    """Thin, soft and pushed to 30 %: 0.39 % off its largest force against refinement 4."""
    stops = tuple(round(0.03 * k, 2) for k in range(11))
    braid = Braid.from_angle(angle=30, threads=30, layer_diameters=(12.66, 12.68))
    latex = replace(
        muscle, inner_diameter=9.5, wall_thickness=1.6, length=200, cap_length=6.4, braid=braid
    )
    case = make_case(
        model="solid",
        muscle=latex,
        rubber=rubber.from_dict({"c10": 0.2, "c01": 0.02}),
        thread=Thread(stiffness=300),
        path=LoadPath(kind="isobaric", held=0.2, stops=stops),
    )
    force = np.array([110.0, 79, 57, 39, 24, 11, -0.9, -11.7, -21.7, -30.8, -39.2])
    states = unreached(11) | {
        "force": force,
        "contraction": np.array(stops),
        "pressure": 0 * force + 0.2,
    }
    found = mesh_error.error(case, converged(states), "force")
    assert found.max() >= 0.005 * 110
    assert np.argmax(found) == 10
    by = mesh_error.known_by(case, converged(states))
    assert set(by) == {"estimated from 240 like muscles"}


def test_nothing_is_guessed_where_threads_stretch_by_a_fifth(make_case):
    """Of threads of less and less stiffness, in every other range: a thin net's stretch says it."""
    case = make_case(model="solid", path=PATH)
    own = likeness.groups(case)
    softer = 0.21 / likeness.thread_stretch(own)
    soft = replace(case, thread=Thread(stiffness=case.thread.stiffness / softer))
    assert likeness.thread_stretch(likeness.groups(soft)) == pytest.approx(0.21)
    assert like_muscles.guess(soft, "solid") is None
    assert like_muscles.guess(case, "solid") is not None


def test_a_membrane_near_crumpling_has_the_larger_error(make_case):
    """Pushed with nine tenths of what the pressure on its bore pulls with."""
    row = dict(zip(("at", "pressure", "angle", "contraction"), (0.7, 0.7, 24.8, 0.2), strict=True))
    bore = like_muscles._near_crumpling(row | {"pull": 0.0})
    assert bore == pytest.approx(1)
    section = (1 - (np.cos(np.radians(24.8)) * 0.8) ** 2) / np.sin(np.radians(24.8)) ** 2
    for pull, near in ((-0.9 * section, 10), (-section, 10), (section, 0.5)):
        assert like_muscles._near_crumpling(row | {"pull": pull}) == pytest.approx(near)
    assert like_muscles._near_crumpling(row | {"at": 0.0, "pull": 1.0}) == 0
    case = make_case(path=LoadPath(kind="isobaric", held=0.3, stops=(0.0, 0.2)))
    errors = {}
    for force in (60.0, -60.0):
        states = converged(
            unreached(2)
            | {
                "force": np.array([600.0, force]),
                "contraction": np.array([0.0, 0.2]),
                "pressure": np.array([0.3, 0.3]),
            }
        )
        errors[force] = mesh_error.error(case, states, "force")[1]
    assert errors[-60.0] > 1.5 * errors[60.0] > 0
