"""The switches of a case and the settings of its solution."""

import math

import pytest

from solver.effects import Effects, End, ThreadLaw
from solver.material import Thread
from solver.numerics import KINDS, NUMERICS_OF_MODEL, Clamp, Newton, Numerics, Slack
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


def test_stiff_threads_slacken_over_a_narrower_strain():
    slack = Slack()
    assert slack.width_of(Thread(stiffness=20)) == 1e-3
    assert slack.width_of(Thread(stiffness=315)) == 1e-3
    assert slack.width_of(Thread(stiffness=3150)) == pytest.approx(1e-4)


def test_every_setting_belongs_to_a_model_or_an_effect():
    of_models = {name for names in NUMERICS_OF_MODEL.values() for name in names}
    of_effects = {"clamp", "slack", "spread"}
    assert of_models | of_effects == set(KINDS) == set(vars(Numerics()))
