"""The switches of a case and the settings of its solution."""

import itertools
import math

import pytest

from solver.effects import EFFECTS, Effects, End, ThreadLaw, active
from solver.effects import KINDS as SWITCHES
from solver.material import Thread
from solver.models import MODELS
from solver.numerics import KINDS, Clamp, Newton, Numerics, Slack
from solver.refusal import UnsolvableCase


def test_defaults_are_those_that_stay_valid():
    assert Effects() == Effects(end=End.CLAMP, threads=ThreadLaw.TENSION_ONLY)


def test_plain_words_become_members():
    effects = Effects(end="butt", threads="two_way")
    assert effects.end is End.BUTT
    assert effects.threads is ThreadLaw.TWO_WAY


@pytest.mark.parametrize("changes", [{"end": "glued"}, {"threads": "none"}, {"end": None}])
def test_refused_effects(changes):
    (field,) = changes
    with pytest.raises(UnsolvableCase) as refused:
        Effects(**changes)
    assert refused.value.field == field
    allowed = End if field == "end" else ThreadLaw
    assert all(member in refused.value.allowed for member in allowed)


@pytest.mark.parametrize(
    ("kind", "changes"),
    [
        (Newton, {"tolerance": 0}),
        (Newton, {"tolerance": 1e-2}),
        (Newton, {"tolerance": math.nan}),
        (Newton, {"iterations": 0}),
        (Newton, {"iterations": 2.5}),
        (Newton, {"smallest_step": 0}),
        (Newton, {"smallest_step": 1.5}),
        (Clamp, {"ramp": 0}),
        (Clamp, {"thread_stiffness": -1}),
        (Clamp, {"inner_stiffness": math.inf}),
        (Slack, {"width": 0}),
        (Slack, {"width": 0.2}),
        (Slack, {"stiffness": 0}),
    ],
)
def test_refused_numerics(kind, changes):
    (field,) = changes
    with pytest.raises(UnsolvableCase) as refused:
        kind(**changes)
    assert refused.value.field == field


def test_stiff_threads_slacken_over_a_narrower_strain(muscle):
    slack = Slack().of(muscle)
    assert slack.width_of(Thread(stiffness=20)) == 1e-3
    assert slack.width_of(Thread(stiffness=315)) == 1e-3
    assert slack.width_of(Thread(stiffness=3150)) == pytest.approx(1e-4)


def test_every_setting_belongs_to_a_model_or_an_effect():
    of_models = {name for model in MODELS.values() for name in model.numerics}
    of_effects = {"clamp", "slack", "spread"}
    assert of_models | of_effects == set(KINDS) == set(vars(Numerics()))


# --- the one list ---------------------------------------------------------------------------------


def test_every_switch_belongs_to_effects_and_models_that_carry_them():
    every = MODELS.values()
    read = {switch for model in every for switch in model.switches}
    assert set(SWITCHES) == read == set(vars(Effects()))
    assert {name for model in every for name in model.effects} == set(EFFECTS)
    assert {effect.switch for effect in EFFECTS.values()} == set(SWITCHES)
    for name, effect in EFFECTS.items():
        assert set(effect.off) < set(SWITCHES[effect.switch])
        assert any(name in m.effects and effect.switch in m.switches for m in every)


@pytest.mark.parametrize(
    ("model", "changes", "off"),
    [
        ("cylinder", {"wall": "one_radius"}, {"wall_thickness"}),
        ("cylinder", {"stretch": "rigid"}, {"thread_stretch"}),
        ("cylinder", {"rubber": "none"}, {"rubber"}),
        ("membrane", {"wall": "one_radius"}, {"wall_thickness"}),
        ("membrane", {"threads": "two_way"}, {"slackening"}),
        ("solid", {"volume": "incompressible"}, {"compressibility"}),
        ("solid", {"end": "sliding"}, {"end_caps", "cap_geometry"}),
        ("solid", {"end": "butt"}, set()),
        ("cell", {"layers": "smeared"}, {"discrete_threads"}),
        ("cell", {"layers": "wire"}, set()),
    ],
)
def test_what_a_switch_takes_away(model, changes, off):
    fullest = active(model, Effects(), braided=True)
    left = active(model, Effects(**changes), braided=True)
    assert set(fullest) - set(left) == off


def test_twist_is_off_until_asked_for():
    for model in ("cylinder", "cell"):
        held, free = (active(model, Effects(twist=t), braided=True) for t in ("held", "free"))
        assert set(free) - set(held) == {"twist"}


def test_the_ladder_adds_effects():
    ladder = [
        set(active(model, Effects(), braided=True))
        for model in ("geometric", "cylinder", "membrane", "solid")
    ]
    assert ladder[0] == set()
    assert all(below < above for below, above in itertools.pairwise(ladder))


def test_a_bare_tube_has_no_effects_of_threads():
    assert set(active("solid", Effects(), braided=False)) == {
        "rubber",
        "wall_thickness",
        "end_caps",
        "cap_geometry",
        "compressibility",
    }


@pytest.mark.parametrize("changes", [{"threads": "two_way"}, {"twist": "free"}])
def test_rigid_threads_neither_push_nor_twist(changes):
    with pytest.raises(UnsolvableCase, match="elastic"):
        Effects(stretch="rigid", **changes)
