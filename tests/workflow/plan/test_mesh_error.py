"""Discretisation errors that are looked up: small enough, up to date, and taken over faithfully."""

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from solver.effects import Effects
from solver.load_path import LoadPath
from solver.numerics import Numerics
from solver.record import Solution, unreached
from solver.status import StateStatus
from workflow.analyses.accuracy.errors import pair_error, share
from workflow.plan import mesh_error
from workflow.plan.plan import plan
from workflow.study.study import load

from ..synthetic import converged

STUDY = Path(__file__).parents[3] / "config" / "config.yaml"
LARGEST = 0.01  # share of the largest value; of the muscle of the paper a quarter of that
AGAIN = "out of date: run snakemake --cores 2 accuracy, then .venv/bin/muscle mesh-errors"


@pytest.fixture(scope="module")
def rows() -> list[dict[str, str]]:
    with mesh_error.FILE.open() as stream:
        return list(csv.DictReader(line for line in stream if not line.startswith("#")))


@pytest.fixture(scope="module")
def planned():
    return plan(load(STUDY))


def solution(**values: list[float]) -> Solution:
    count = len(next(iter(values.values())))
    states = unreached(count) | {name: np.array(each) for name, each in values.items()}
    return converged(states)


def on_path(case, force):
    """States at the controls of a path, with forces; under a load that is the force."""
    path, count = case.path, len(force)
    swept = [*path.stops, *[path.stops[-1]] * (count - len(path.stops))]
    values = {
        "force": force,
        "contraction": [0.1 * k / count for k in range(1, count + 1)],
        "pressure": [0.2] * count,
        "stiffness": [10.0] * count,
        "force_by_pressure": [2000.0] * count,
    }
    return solution(
        **values | {path.kind.held.variable: [path.held] * count, path.kind.swept.variable: swept}
    )


def test_every_curve_of_the_scenes_has_a_known_error_that_is_small(planned):
    for each in planned.cases.values():
        case = each.case
        count = case.path.states
        states = on_path(case, [600 * (1 - k / count) for k in range(count)])
        name = case.path.kind.follows
        error = mesh_error.error(case, states, name)[: len(case.path.stops)]
        assert np.isfinite(error).all(), f"{each.label}: {AGAIN}"
        assert np.nanmax(error) <= LARGEST * np.abs(states.states[name]).max(), each.label
        assert "not known" not in mesh_error.known_by(case, states), each.label


def test_defaults_are_in_the_table(make_case):
    for model in mesh_error.PART:
        case = make_case(model=model)
        settings, refinement = mesh_error.settings_of(model, case.effects, case.numerics)
        found = mesh_error._of_paper().get(settings, [])
        assert refinement in [each.refinement for each in found], AGAIN


@pytest.mark.parametrize(("model", "refinement"), [("membrane", 1), ("solid", 1)])
def test_table_is_up_to_date(rows, planned, solve_case, model, refinement):
    """The worst curve, on its own mesh and on one twice as fine, has the error that is said."""
    row = next(r for r in rows if r["model"] == model and int(r["refinement"]) == refinement)
    case = next(each.case for each in planned.cases.values() if each.label == row["worst"])
    part = mesh_error.PART[model]
    finer = replace(getattr(case.numerics, part), refinement=2 * refinement)
    fine = replace(case, numerics=replace(case.numerics, **{part: finer}), fields_at=())
    coarse_force, fine_force = (solve_case(c).states["force"] for c in (case, fine))
    error = share(pair_error(coarse_force, fine_force), fine_force)
    assert error == pytest.approx(float(row["force_error"]), rel=0.1), AGAIN


def test_error_of_a_curve(make_case):
    path = LoadPath(kind="isobaric", held=0.3, stops=(0.0, 0.1, 0.2))
    case = make_case(model="solid", path=path)
    states = on_path(case, [800.0, 400.0, np.nan])
    found = mesh_error.error(case, states, "force")
    assert 0 < found[0] < found[1] < 0.01 * 800
    assert np.isnan(found[2])
    finer = on_path(case, [799.0, 402.0, 5.0])
    measured = mesh_error.error(case, states, "force", finer)
    np.testing.assert_allclose(measured, [2, 4, np.nan])
    words = [mesh_error.known_by(case, states, other) for other in (None, finer)]
    like = "estimated from 240 like muscles"
    assert words == [[like, like, "not known"], ["measured here"] * 2 + ["not known"]]
    none = make_case(model="cylinder", path=path)
    np.testing.assert_array_equal(mesh_error.error(none, states, "force"), [0, 0, np.nan])
    assert mesh_error.known_by(none, states) == ["no mesh"] * 3


def test_what_a_climb_has_tried_says_how_far_a_mesh_is_off(make_case, muscle):
    """Also of a muscle that no others are like; where a mesh has lost a state that is no number."""
    path = LoadPath(kind="isobaric", held=0.3, stops=(0.0, 0.1, 0.2))
    case = make_case(model="solid", path=path, muscle=replace(muscle, length=3000))
    states, coarser = on_path(case, [800.0, 400.0, 90.0]), on_path(case, [790.0, 400.1, 90.0])
    by = "measured here by a coarser mesh"
    found = mesh_error.error(case, states, "force", None, coarser)
    np.testing.assert_allclose(found, [15, 3, 3])  # 1.5 times, at least a fifth of the most
    assert mesh_error.known_by(case, states, None, coarser) == [by] * 3
    lost = replace(coarser, state_status=[*coarser.state_status[:2], StateStatus.INVALID_STATE])
    found = mesh_error.error(case, states, "force", None, lost)
    np.testing.assert_allclose(found, [15, 3, np.nan])
    assert mesh_error.known_by(case, states, None, lost) == [by, by, "not known"]
    finer = on_path(case, [801.0, 400.0, 90.0])  # says more than a coarser one
    np.testing.assert_allclose(mesh_error.error(case, states, "force", finer, lost)[0], 2)
    numerics = replace(case.numerics, section=replace(case.numerics.section, refinement=2))
    fine = replace(case, numerics=numerics)  # of second order off by a third of the difference
    found = mesh_error.error(fine, states, "force", None, coarser)
    np.testing.assert_allclose(found, [5, 1, 1])


def test_error_of_what_is_looked_for_where_the_force_is_zero(make_case):
    path = LoadPath(kind="isometric", held=0.1, stops=(0.2, 0.3), zero_force=True)
    case = make_case(model="solid", path=path)
    states = on_path(case, [200.0, 400.0, 0.0])
    force = mesh_error.error(case, states, "force")
    found = mesh_error.error(case, states, "pressure")
    assert np.isnan(found[:2]).all()  # prescribed
    assert found[2] == pytest.approx(force[2] / 2000)
    finer = on_path(case, [200.0, 400.0, 0.0])
    finer.states["pressure"][2] -= 0.001
    assert mesh_error.error(case, states, "pressure", finer)[2] == pytest.approx(0.002)
    by_coarser = mesh_error.error(case, states, "pressure", None, finer)[2]
    assert by_coarser == pytest.approx(0.0015)


def test_the_share_of_the_paper_s_muscle_is_no_other_one_s(make_case, muscle):
    path = LoadPath(kind="isobaric", held=0.3, stops=(0.0, 0.1))
    fine = replace(Numerics(), section=replace(Numerics().section, cap_step=0.25, refinement=2))
    longer = replace(muscle, length=301)
    for of, known in ((muscle, True), (longer, False)):
        case = make_case(model="solid", path=path, muscle=of, numerics=fine)
        found = mesh_error.error(case, on_path(case, [800.0, 400.0]), "force")
        assert np.isfinite(found).all() == known


def test_error_of_the_contraction_under_a_load(make_case):
    path = LoadPath(kind="isotonic", held=200.0, stops=(0.2, 0.3))
    states = solution(force=[200.0, 200.0], contraction=[0.05, 0.1], stiffness=[10.0, -20.0])
    case = make_case(model="membrane", path=path)
    force = mesh_error.error(case, states, "force")
    found = mesh_error.error(case, states, "contraction")
    np.testing.assert_allclose(found, force / np.array([10 * 300, 20 * 300]))


def test_what_is_not_known_is_nan(make_case):
    path = LoadPath(kind="isobaric", held=0.3, stops=(0.0, 0.1))
    states = solution(force=[800.0, 400.0])
    sharp = make_case(model="solid", path=path, effects=Effects(end="butt"))
    default = Numerics()
    other = replace(default, section=replace(default.section, cap_step=3))
    for case in (sharp, make_case(model="solid", path=path, numerics=other)):
        assert np.isnan(mesh_error.error(case, states, "force")).all()
    assert np.isnan(mesh_error.error(make_case(model="solid", path=path), states, "volume")).all()


def test_a_finer_mesh_has_the_error_of_the_next_coarser(make_case):
    path = LoadPath(kind="isobaric", held=0.3, stops=(0.0,))
    states, default = solution(force=[800.0]), Numerics()

    def error(refinement: int) -> float:
        mesh = replace(default.section, refinement=refinement)
        case = make_case(model="solid", path=path, numerics=replace(default, section=mesh))
        return float(mesh_error.error(case, states, "force")[0])

    assert error(1) > error(2) == error(3) == error(5) > 0
