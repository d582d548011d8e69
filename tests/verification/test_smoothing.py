"""What the smoothing of the slack law adds to a force, against solves with a sharp law."""

import re
from dataclasses import replace

import numpy as np
import pytest

from geometry.muscle import Braid, Muscle
from solver.effects import Effects
from solver.load_path import LoadPath
from solver.material import Thread
from solver.numerics import Numerics, Slack
from solver.smoothing import MOST, scale
from solver.status import Flag

AS_WIDE = Slack(width=1e-3, stiffness=315)  # far too wide for a small muscle
SHARP = Slack(width=1e-6)


@pytest.fixture
def small(silicone):
    """A thin soft muscle with threads for a large one: silicone, 1.3 mm."""
    return {
        "muscle": Muscle(
            inner_diameter=1.3,
            wall_thickness=0.25,
            length=40,
            cap_length=1,
            braid=Braid.from_angle(angle=18, threads=24, layer_diameters=(1.5, 1.6)),
        ),
        "rubber": silicone,
        "path": LoadPath(kind="isobaric", held=0.02, stops=(0.0, 0.1)),
    }


def smoothed(solution) -> list[bool]:
    return [Flag.SMOOTHED in flags for flags in solution.flags]


@pytest.mark.parametrize("model", ["cylinder", "solid"])
def test_a_width_that_is_too_wide_is_marked(make_case, solve_case, small, model):
    case = make_case(model=model, numerics=Numerics(slack=AS_WIDE), **small)
    wide = solve_case(case)
    sharp = solve_case(replace(case, numerics=Numerics(slack=SHARP)))
    added = wide.states["force"] - sharp.states["force"]
    np.testing.assert_allclose(wide.states["smoothing"], added, rtol=0.02)
    assert min(abs(added)) > MOST * scale(case, wide)
    assert smoothed(wide) == [True, True]
    assert smoothed(sharp) == [False, False]
    assert sharp.notes == ["", ""]


@pytest.mark.parametrize("model", ["cylinder", "solid"])
def test_the_width_of_the_note_is_narrow_enough(make_case, solve_case, small, model):
    case = make_case(model=model, numerics=Numerics(slack=AS_WIDE), **small)
    sharp = solve_case(replace(case, numerics=Numerics(slack=SHARP)))
    for k, note in enumerate(solve_case(case).notes):
        width = float(re.search(r"a slack\.width of (\S+) brings that below 1 %", note)[1])
        narrow = solve_case(replace(case, numerics=Numerics(slack=replace(AS_WIDE, width=width))))
        assert not smoothed(narrow)[k]
        error = narrow.states["force"] - sharp.states["force"]
        assert abs(error[k]) < MOST * scale(case, narrow)
        assert width > 1e-6


@pytest.mark.parametrize("model", ["cylinder", "membrane", "solid"])
def test_the_default_goes_with_the_muscle(make_case, solve_case, small, model):
    path = replace(small["path"], stops=(0.0,))
    assert smoothed(solve_case(make_case(model=model, **small | {"path": path}))) == [False]


@pytest.mark.parametrize("model", ["cylinder", "membrane", "solid"])
def test_muscle_of_the_paper(make_case, solve_case, model):
    """Its 3.6 N without pressure are marked; where it works, smoothing adds 0.02 %."""
    slack = LoadPath(kind="isobaric", held=0.0, stops=(0.0,))
    idle = solve_case(make_case(model=model, path=slack))
    assert idle.states["smoothing"] == pytest.approx(idle.states["force"], rel=0.01)
    assert smoothed(idle) == [True]
    assert "% of what the curve bears; a slack.width of" in idle.notes[0]
    path = LoadPath(kind="isobaric", held=0.3, stops=(0.0, 0.1))
    case = make_case(model=model, path=path)
    working = solve_case(case)
    sharp = solve_case(replace(case, numerics=Numerics(slack=SHARP)))
    added = working.states["force"] - sharp.states["force"]
    np.testing.assert_allclose(working.states["smoothing"], added, rtol=0.02)
    assert smoothed(working) == [False, False]


@pytest.mark.parametrize("model", ["cylinder", "solid"])
def test_slack_tube_at_low_pressure(make_case, solve_case, model):
    path = LoadPath(kind="isometric", held=0.05, stops=(0.01, 0.05))
    case = make_case(model=model, path=path)
    solution = solve_case(case)
    sharp = solve_case(replace(case, numerics=Numerics(slack=SHARP)))
    added = solution.states["force"] - sharp.states["force"]
    np.testing.assert_allclose(solution.states["smoothing"], added, rtol=0.02)
    share = np.abs(added) / scale(case, solution)
    assert smoothed(solution) == list(share > MOST)


@pytest.mark.parametrize("model", ["cylinder", "membrane", "solid"])
def test_what_does_not_slacken_is_not_smoothed(make_case, solve_case, bare_tube, model):
    pushing = make_case(model=model, effects=Effects(threads="two_way"))
    bare = make_case(
        model=model,
        muscle=bare_tube,
        path=LoadPath(kind="isobaric", held=0.02, stops=(0.0,)),
    )
    for case in (pushing, bare):
        solution = solve_case(case)
        assert solution.states["smoothing"].tolist() == [0.0]
        assert smoothed(solution) == [False]


def test_stiffer_threads_slacken_over_less(make_case, solve_case):
    path = LoadPath(kind="isobaric", held=0.0, stops=(0.0,))
    stiff = solve_case(make_case(model="cylinder", thread=Thread(stiffness=20e3), path=path))
    soft = solve_case(make_case(model="cylinder", path=path))
    assert stiff.states["smoothing"][0] < 0.1 * soft.states["smoothing"][0]
