"""States beyond what thread and rubber bear: marked when gathered, and nothing is solved for it."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from solver.effects import Effects
from solver.load_path import LoadPath
from solver.record import unreached
from solver.status import CaseStatus, Flag
from workflow.data import strain
from workflow.plan.plan import plan
from workflow.run import failures
from workflow.study.errors import StudyError
from workflow.study.limits import Limits
from workflow.study.study import load

from ..synthetic import converged

STUDY = """
materials:
  nbr: {c10: 0.345083, c01: 0.083805}
muscles:
  one: {inner_diameter: 20, wall_thickness: 2, length: 300, layer_depths: [0.3, 0.9],
        threads: 60, lead: 144, thread_stiffness: 315, material: nbr}
scenes:
  few: {path: isobaric, muscles: [one], pressure: [0.3], contraction: [0, 0.1],
        models: [cylinder]}
"""
ROOM = "threads side by side"


@pytest.fixture
def study(tmp_path):
    """The study with a change."""

    def made(old="", new=""):
        assert old in STUDY
        file = tmp_path / "study.yaml"
        file.write_text(STUDY.replace(old, new, 1))
        return load(file)

    return made


@pytest.fixture
def solved(make_case):
    """A case with four states, and a solution with given stretches."""
    path = LoadPath(kind="isobaric", held=0.3, stops=(0.0, 0.1, 0.2, 0.3))

    def made(thread, rubber, **changes):
        states = unreached(4)
        states["force"][:] = 1.0
        states["thread_stretch_max"][:] = thread
        states["rubber_stretch_max"][:] = rubber
        return make_case(model="solid", path=path, **changes), converged(states)

    return made


def beyond(solution):
    return [Flag.OVERSTRAINED in flags for flags in solution.flags]


def test_threads_beyond_their_strength(solved):
    """315 N of EA: 12.6 N at 4 %, 15.75 at 5 %."""
    case, solution = solved([1.02, 1.04, 1.05, np.nan], 1.5)
    judged = strain.judged(case, solution, Limits(thread_strength=13.0))
    assert beyond(judged) == [False, False, True, False]
    assert judged.notes == ["", "", "thread tension 15.8 N, of 13 N", ""]


def test_rubber_beyond_its_limit(solved):
    case, solution = solved(1.01, [1.2, 1.9, 2.1, np.nan])
    judged = strain.judged(case, solution, Limits(stretch_limit=2.0))
    assert beyond(judged) == [False, False, True, False]
    assert judged.notes[2] == "rubber stretch 2.1, of 2"


def test_rubber_beyond_the_tests_of_its_law(solved):
    case, solution = solved(1.01, [1.2, 1.5, 1.6, np.nan])
    judged = strain.judged(case, solution, Limits(fitted_range=(1.0, 1.5)))
    assert [flags == {Flag.EXTRAPOLATED} for flags in judged.flags] == [False, False, True, False]
    assert judged.notes == ["", "", "rubber stretch 1.6; its law was fitted up to 1.5", ""]


def test_without_a_strength_long_threads_are_named(solved):
    case, solution = solved([1.04, 1.06, 1.13, np.nan], 1.5)
    judged = strain.judged(case, solution, Limits())
    assert beyond(judged) == [False] * 4
    named = ["", "1.06", "1.13", ""]
    assert judged.notes == [
        f"threads stretched to {x}; {strain.UNKNOWN}" if x else "" for x in named
    ]
    assert strain.judged(case, solution, Limits(thread_strength=1000)).notes == [""] * 4


def test_rigid_threads_have_no_tension(solved, make_case):
    _, solution = solved(1.0, 1.5)
    path = LoadPath(kind="isobaric", held=0.3, stops=(0.0, 0.1, 0.2, 0.3))
    rigid = make_case(model="cylinder", effects=Effects(stretch="rigid"), path=path)
    assert not any(beyond(strain.judged(rigid, solution, Limits(thread_strength=1e-6))))


def test_failures_name_the_worst_state(solved, study, tmp_path):
    found = plan(study())
    (key,) = found.cases
    case, solution = solved([1.04, 1.06, 1.13, np.nan], 1.5)
    judged = strain.judged(case, solution, Limits())
    curve = SimpleNamespace(key=key, solution=judged, place=SimpleNamespace(muscle="one"))
    said = strain.summary([curve])
    table = tmp_path / "failures.csv"
    failures.write(found, {key: judged}, table, said)
    text, failed = failures.report(table)
    assert not failed  # it is an answer
    solved_all = "one cylinder isobaric 0.3 MPa: solved; 2 of 4 states of one have long threads"
    assert text.startswith(f"{solved_all}, at most: threads stretched to 1.13")
    ended = replace(judged, status=CaseStatus.LIMIT_POINT, reason="fold\nat contraction 0.3")
    failures.write(found, {key: ended}, table, said)
    assert "limit_point, fold at contraction 0.3; 2 of 4 states" in failures.report(table)[0]


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("thread_stiffness: 315", "thread_stiffness: 315, thread_strength: 20"),
        ("c01: 0.083805", "c01: 0.083805, stretch_limit: 3"),
        ("c01: 0.083805", "c01: 0.083805, fitted_range: [1, 1.5]"),
    ],
)
def test_limits_are_no_part_of_a_case(study, old, new):
    before, after = plan(study()), plan(study(old, new))
    assert before.cases.keys() == after.cases.keys()
    assert before.digest() != after.digest()  # but what is gathered is gathered again
    assert before.digest("few") != after.digest("few")


def test_a_diameter_that_fits_changes_no_state(study):
    """Only what the muscle weighs."""
    given = study("thread_stiffness: 315", "thread_stiffness: 315, thread_diameter: 0.4")
    assert plan(study()).cases.keys() == plan(given).cases.keys()
    assert study().muscles["one"].limits == given.muscles["one"].limits


def test_limits_of_a_study(study):
    limits = study("c01: 0.083805", "c01: 0.083805, stretch_limit: 3").muscles["one"].limits
    assert (limits.stretch_limit, limits.thread_strength) == (3, None)
    strong = study("thread_stiffness: 315", "thread_stiffness: 315, thread_strength: 20")
    assert strong.muscles["one"].limits.thread_strength == 20


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("c01: 0.083805", "c01: 0.083805, stretch_limit: 1", "stretch_limit = 1"),
        ("c01: 0.083805", "c01: 0.083805, fitted_range: [0.5, 0.9]", "fitted_range = [0.5, 0.9]"),
        ("lead: 144", "lead: 144, thread_strength: 0", "thread_strength = 0"),
        ("lead: 144", "lead: 144, thread_diameter: -1", "thread_diameter = -1"),
        # 59.0 mm of circumference times cosine in the inner layer, for 60 threads
        ("lead: 144", "lead: 144, thread_diameter: 0.99", f"0.984 mm, with 60 {ROOM}"),
        ("threads: 60", "threads: 3000", "threads = 3000"),
    ],
)
def test_what_cannot_be_is_refused(study, old, new, said):
    with pytest.raises(StudyError) as refused:
        study(old, new)
    assert said in str(refused.value)


def test_many_threads_on_a_thin_tube(study):
    thin = "inner_diameter: 0.5, wall_thickness: 0.2, length: 30, layer_depths: [0.05, 0.1]"
    normal = "inner_diameter: 20, wall_thickness: 2, length: 300, layer_depths: [0.3, 0.9]"
    rest = ",\n        threads: 60, lead: 144, thread_stiffness: 315"
    with pytest.raises(StudyError, match="threads = 3000 is refused"):
        study(normal + rest, thin + ",\n        threads: 3000, lead: 4, thread_stiffness: 1")


def test_threads_that_fit_only_if_they_are_stiff_have_a_note(study, solved):
    """200 threads of 0.437 mm at 2100 MPa are 87 mm, where there are 59."""
    limits = study("threads: 60", "threads: 200").muscles["one"].limits
    assert "no thread_diameter is given" in limits.room
    case, solution = solved(1.0, 1.5)
    assert strain.judged(case, solution, limits).notes == [limits.room] * 4
    assert (
        study("threads: 60", "threads: 200, thread_diameter: 0.2").muscles["one"].limits.room == ""
    )
    stiff = study("scenes:", "numerics: {spread: {modulus: 10000}}\nscenes:")
    assert stiff.muscles["one"].limits.room == ""
    assert study().muscles["one"].limits.room == ""
