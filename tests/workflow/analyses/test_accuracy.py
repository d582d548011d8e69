"""The analysis of accuracy on made-up solutions, whose errors and orders are known."""

import warnings
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from solver.record import unreached
from solver.status import StateStatus
from workflow.analyses.accuracy import cases
from workflow.analyses.accuracy.errors import (
    exponent,
    extrapolate,
    grid_convergence_index,
    pair_error,
)
from workflow.analyses.accuracy.table import rows as table_of
from workflow.analyses.accuracy.take_over import take_over
from workflow.analyses.analysis import Solved
from workflow.plan.mesh_error import COLUMNS
from workflow.study.errors import StudyError
from workflow.study.study import load

from ..synthetic import converged

STUDY = Path(__file__).parents[3] / "config" / "config.yaml"
ORDER = {"membrane": 4.0, "solid": 2.5}
COEFFICIENT = {"membrane": 0.1, "solid": -2.0}  # N, error of the default mesh
MODELLING = {"geometric": 200.0, "cylinder": 20.0, "membrane": 4.0, "solid": 0.0, "cell": 19.0}  # N
LARGEST = 700.0


@pytest.mark.parametrize("order", [1.0, 2.0, 3.87])
@pytest.mark.parametrize("refinements", [(1, 2, 4), (1, 2, 3, 4, 6)])
def test_order_and_limit_are_recovered(order, refinements):
    limit = np.array([10.0, -3.0, 0.5])
    values = [limit + np.array([1.0, -2.0, 0.0]) * m**-order for m in refinements]
    found = extrapolate(refinements, values)
    assert found.order == pytest.approx(order, abs=0.01)
    np.testing.assert_allclose(found.limit, limit, atol=0.01)


def test_values_that_do_not_converge_have_no_order():
    assert np.isnan(extrapolate((1, 2, 4), [[1.0], [2.0], [4.0]]).order)
    with pytest.raises(ValueError, match="three meshes"):
        extrapolate((1, 2), [[1.0], [2.0]])


def test_grid_convergence_index_covers_the_error():
    """The example of Roache 1998: second order, ratio 2; and errors that follow the law."""
    assert grid_convergence_index(0.97050, 0.96854, 2.0, 1.786170) == pytest.approx(0.00100, 1e-2)
    order, ratio = 2.5, 1.5
    fine, coarse = 5 + 0.1, 5 + 0.1 * ratio**order
    assert grid_convergence_index(fine, coarse, ratio, order) == pytest.approx(1.25 * 0.1)


def test_a_pair_of_meshes_gives_the_error_of_the_coarser():
    assert pair_error(5 + 0.4, 5 + 0.1) == pytest.approx(0.4)  # of second order exactly
    assert pair_error(5 + 0.4, 5 + 0.4 / 2**2.7) > 0.4  # of higher order more than that


def test_exponent():
    x = np.array([10.0, 100.0, 700.0])
    assert exponent(x, 3 * x**1.25) == pytest.approx(1.25)
    assert np.isnan(exponent([1.0, 1.0], [1.0, 2.0]))


def made_up(asked) -> Solved:
    """A solution with the errors that the tags of a case ask for."""
    path, model = asked.case.path, asked.case.model
    states = unreached(path.states)
    stops = np.array([*path.stops, np.nan][: path.states])
    contraction = stops if path.kind == "isobaric" else np.full(path.states, path.held)
    refinement = float(asked.tags["refinement"]) or 0.5
    error = COEFFICIENT.get(model, 0.0) * refinement ** -ORDER.get(model, 1.0)
    if asked.tags["set"] == "tolerance":
        error += LARGEST * float(asked.tags["tolerance"])
    states["contraction"] = contraction
    states["force"] = LARGEST * (1 - 4 * contraction) + MODELLING[model] + error
    states["pressure"] = np.full(path.states, 0.136 * (1 + error / LARGEST))
    states["inner_diameter_inflated"] = 30 * (1 + error / LARGEST) + 0 * contraction
    states["stiffness"] = np.full(path.states, 10.0)
    states["iterations"] = np.full(path.states, 3.0)
    return Solved(asked, converged(states))


@pytest.fixture(scope="module")
def table() -> pd.DataFrame:
    return table_of([made_up(asked) for asked in cases.cases(load(STUDY))])


def test_every_setting_has_a_row(table):
    counts = table["set"].value_counts()
    assert counts["mesh"] == 2 + 2 * (5 + 2) + 3
    assert counts["steps"] == 2 * 4
    assert counts["tolerance"] == 2 * 8
    assert not table.duplicated(["set", "model", "mesh", "tolerance", "states"]).any()


@pytest.mark.parametrize("model", ["membrane", "solid"])
def test_discretisation_error_and_order(table, model):
    rows = table[(table["set"] == "mesh") & (table["model"] == model) & (table["refinement"] > 0)]
    assert rows["force_order [1]"].to_numpy() == pytest.approx(ORDER[model], abs=0.02)
    expected = abs(COEFFICIENT[model]) * rows["refinement"] ** -ORDER[model]
    largest = LARGEST + MODELLING[model]
    np.testing.assert_allclose(rows["force_error [1]"], expected / largest, rtol=0.02, atol=1e-7)
    index = rows["force_gci [1]"].iloc[1:]
    np.testing.assert_allclose(index, 1.25 * rows["force_error [1]"].iloc[1:], rtol=0.1, atol=1e-7)


def test_modelling_error_is_apart(table):
    mesh = table[table["set"] == "mesh"]
    for model, force in MODELLING.items():
        found = mesh.loc[mesh["model"] == model, "modelling_error [1]"]
        np.testing.assert_allclose(found, force / LARGEST, atol=1e-4)


def test_tolerance_is_judged_by_the_strictest(table):
    rows = table[(table["set"] == "tolerance") & (table["model"] == "membrane")]
    rows = rows.sort_values("tolerance")
    assert rows["force_error [1]"].iloc[0] == 0
    assert rows["force_error [1]"].iloc[-1] == pytest.approx(1e-3, rel=0.02)


def test_scenes_have_their_own_error(table):
    rows = table[(table["set"] == "scenes") & (table["refinement"] == 1)]
    solid = rows[(rows["model"] == "solid") & rows["mesh"].str.contains("isobaric")]
    assert len(solid) > 3
    factor = (1 - 2 ** -ORDER["solid"]) / (1 - 0.25)  # the order is assumed to be 2
    assert solid["force_error [1]"].to_numpy() == pytest.approx(2.0 * factor / LARGEST, rel=0.01)
    assert rows["force_error [1]"].notna().all()


def test_deviation_from_both_maps_is_apart(table):
    mesh = table[table["set"] == "mesh"]
    for name in ("festo_musclesim", "martens2017"):
        assert mesh[f"{name}_share [1]"].notna().all()
        ours = mesh.groupby("model")[f"{name}_share [1]"].first()
        assert ours["geometric"] > ours["cylinder"] > ours["membrane"]


def test_a_curve_that_ends_early_is_compared_as_far_as_it_goes():
    """One without any state has no error; nobody is told of an empty slice."""
    solved = [made_up(asked) for asked in cases.cases(load(STUDY))]
    ended = {"membrane coarser, mesh": 15, "membrane coarsest, mesh": 0}
    for one in solved:
        if one.asked.label in ended:
            for values in one.solution.states.values():
                values[ended[one.asked.label] :] = np.nan
            for k in range(ended[one.asked.label], len(one.solution.state_status)):
                one.solution.state_status[k] = StateStatus.NOT_REACHED
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = table_of(solved)
    mesh = found[(found["set"] == "mesh") & (found["model"] == "membrane")].set_index("mesh")
    expected = abs(COEFFICIENT["membrane"]) * 0.5 ** -ORDER["membrane"]
    largest = LARGEST + MODELLING["membrane"]
    assert mesh.loc["coarser", "force_error [1]"] == pytest.approx(expected / largest, rel=0.02)
    assert np.isfinite(mesh.loc["coarser", "total_error [1]"])
    assert mesh.loc["coarser", "festo_musclesim_left_out [1]"] == 0
    assert np.isnan(
        mesh.loc["coarsest", ["force_error [1]", "total_error [1]"]].astype(float)
    ).all()


def test_table_is_taken_over_from_the_study(tmp_path):
    study = tmp_path / "accuracy.csv"
    study.write_text(
        "set,model,end,mesh,refinement,cap_step,growth,body_step,rows,force_error [1],"
        "diameter_error [1]\n"
        "mesh,solid,clamp,1/1,1,1.0,1.5,2.0,1 1 1,0.5,0.5\n"
        "scenes,solid,clamp,one,1.0,1.0,1.5,2.0,1 1 1,0.001,0.0004\n"
        "scenes,solid,clamp,other,1.0,1.0,1.5,2.0,1 1 1,0.002,0.0003\n"
    )
    take_over(study, tmp_path / "found.csv")
    note, header, row = (tmp_path / "found.csv").read_text().splitlines()
    assert note.startswith("# 20")
    assert header == ",".join(COLUMNS)
    assert row == "solid,clamp,1,1.5,2,1 1 1,1,2.00e-03,4.00e-04,2,other"
    with pytest.raises(StudyError, match="snakemake accuracy"):
        take_over(tmp_path / "absent.csv")
