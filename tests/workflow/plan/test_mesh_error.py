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
from workflow.analyses.accuracy.errors import pair_error, share
from workflow.plan import mesh_error
from workflow.plan.plan import plan
from workflow.study.study import load

from ..synthetic import converged

STUDY = Path(__file__).parents[3] / "config" / "config.yaml"
LARGEST = 0.0025  # share of the largest force: a quarter of a tolerance of 1 %
AGAIN = "out of date: run snakemake --cores 2 accuracy, then .venv/bin/python -m workflow bounds"


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


def test_every_curve_of_the_scenes_has_a_known_error_that_is_small(planned):
    for each in planned.cases.values():
        case = each.case
        states = solution(force=[600.0] * case.path.states)
        error = mesh_error.error(case, states, "force")
        assert np.isfinite(error).all(), f"{each.label}: {AGAIN}"
        assert error.max() <= LARGEST * 600, each.label


def test_defaults_are_in_the_table(make_case):
    for model in mesh_error.PART:
        case = make_case(model=model)
        settings, refinement = mesh_error.settings_of(model, case.effects, case.numerics)
        bounds = mesh_error._bounds().get(settings, [])
        assert refinement in [bound.refinement for bound in bounds], AGAIN


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
    states = solution(force=[-800.0, 400.0, np.nan])
    found = mesh_error.error(make_case(model="solid", path=path), states, "force")
    assert found[0] == found[1] == pytest.approx(0.000866 * 800, rel=0.2)
    assert np.isnan(found[2])
    none = mesh_error.error(make_case(model="cylinder", path=path), states, "force")
    np.testing.assert_array_equal(none, [0, 0, np.nan])


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


def test_a_finer_mesh_is_bounded_by_the_next_coarser(make_case):
    path = LoadPath(kind="isobaric", held=0.3, stops=(0.0,))
    states, default = solution(force=[800.0]), Numerics()

    def error(refinement: int) -> float:
        mesh = replace(default.section, refinement=refinement)
        case = make_case(model="solid", path=path, numerics=replace(default, section=mesh))
        return float(mesh_error.error(case, states, "force")[0])

    assert error(1) > error(2) == error(3) == error(5) > 0
