"""The numbers of each figure, worked out by hand from made-up solutions."""

import importlib

import numpy as np
import pytest

from solver.status import StateStatus
from workflow.data.principal_stress import principal_of_four
from workflow.data.scene_data import COLUMN, CONTRACTION, FORCE, PRESSURE, WALL
from workflow.data.stress import LARGEST, SMALLEST, along_meridian, wall
from workflow.figures.labels import SERIES
from workflow.study.errors import StudyError

ANGLE = np.arctan(np.pi * 21.2 / 144)
FE = 0.8  # of the force of Eq. (1), see conftest.py


def eq_1(pressure, contraction, diameter=20.0):
    """Written out again, from the paper."""
    bracket = 3 * np.cos(ANGLE) ** 2 * (1 - contraction) ** 2 - 1
    return pressure * np.pi * diameter**2 / (4 * np.sin(ANGLE) ** 2) * bracket


@pytest.fixture
def table(scene_data):
    return lambda name: importlib.import_module(f"workflow.figures.{name}").table(scene_data(name))


def only(table, **chosen):
    for column, value in chosen.items():
        table = table[table[column] == value]
    return table


def test_fig03(table):
    row = table("fig03").iloc[0]
    assert row["braid_angle [deg]"] == pytest.approx(24.82, abs=0.005)
    assert row["axial_spacing [mm]"] == 2.4
    assert row["layer_diameter_1 [mm]"] == pytest.approx(20.6)


def test_fig04_forces_and_deviation(table):
    found = table("fig04")
    at = only(found, **{PRESSURE: 0.3, CONTRACTION: 0.1}).set_index("source")
    assert at.loc["geometric", FORCE] == pytest.approx(eq_1(0.3, 0.1))
    assert at.loc["solid", FORCE] == pytest.approx(FE * eq_1(0.3, 0.1))
    expected = at.loc["festo_musclesim", FORCE]
    assert expected == pytest.approx(299, abs=0.5)
    deviation = "deviation from Festo MuscleSIM [1]"
    assert at.loc["geometric", deviation] == pytest.approx(eq_1(0.3, 0.1) / expected - 1)
    # at 20 % MuscleSIM gives 37 N, less than a tenth of its 760 N at 0 %
    assert only(found, **{PRESSURE: 0.3, CONTRACTION: 0.2})[deviation].isna().all()


def test_fig04_has_the_scenes_stops_and_the_maps_own_points(table):
    found = table("fig04")
    solid = only(found, source="solid", **{PRESSURE: 0.2})
    assert solid[CONTRACTION].tolist() == [k / 100 for k in range(26)]
    own = only(found, source="festo_musclesim", point="tabulated", status="reference")
    assert only(own, **{PRESSURE: 0.2})[CONTRACTION].tolist() == [0.01, 0.05, 0.155, 0.25]
    assert only(found, status="suspect")[FORCE].tolist() == [112]


def test_fig05_part_of_the_table_is_the_wall(table):
    found = table("fig05")
    corners = only(found, where="wall", **{PRESSURE: 0.3})
    assert len(corners) == 6
    assert corners[LARGEST].tolist() == pytest.approx([1.0, 0.9, 0.0, 1.0, 0.0, -0.1])
    assert corners[SMALLEST].min() == pytest.approx(-0.3)
    assert corners["z of the cap [mm]"].unique() == pytest.approx(135)


def test_fig06_threshold_is_a_row_of_its_own(table):
    found = table("fig06")
    assert set(only(found, point="zero force")["source"]) == {"membrane", "solid"}
    at = only(found, point="stop", source="membrane", **{PRESSURE: 0.4})
    assert at[FORCE].item() == pytest.approx(FE * eq_1(0.4, 0.1))
    own = only(found, source="martens2017", point="tabulated")
    assert own[PRESSURE].min() == 0.1975  # below it the muscle was slack at 11 %


def test_fig07_equivalent_diameter_only_where_the_muscle_pulls(table):
    found = only(table("fig07"), source="solid")
    equivalent, inflated = COLUMN["equivalent_diameter"], COLUMN["inner_diameter_inflated"]
    at = only(found, **{PRESSURE: 0.3}).iloc[0]
    assert at[equivalent] == pytest.approx(np.sqrt(4 * FE * eq_1(0.3, 0.1) / (np.pi * 0.3)))
    assert at["equivalent / inflated - 1 [1]"] == pytest.approx(at[equivalent] / at[inflated] - 1)
    assert only(found, **{PRESSURE: 0.0})[equivalent].isna().all()
    assert (found["initial_inner_diameter [mm]"] == 20).all()


def test_fig08_has_one_series_per_load(table):
    found = table("fig08")
    assert found[SERIES].unique().tolist() == ["100 N", "200 N", "300 N"]
    at = only(found, **{PRESSURE: 0.3, FORCE: 200.0}).iloc[0]
    assert eq_1(0.3, at[CONTRACTION]) == pytest.approx(200)


def test_fig09_tells_angles_apart(table):
    found = table("fig09")
    assert set(found[SERIES]) == {"24.8°", "17.1°"}
    assert found["braid_angle [deg]"].max() == pytest.approx(24.82, abs=0.005)


def test_fig10_tells_diameter_and_threads_apart(table):
    names = {"20 mm, 60 threads", "40 mm, 60 threads", "40 mm, 120 threads"}
    assert set(table("fig10")[SERIES]) == names


def test_fig11_ratio_of_eq_1_is_4(table):
    found = table("fig11")
    assert "dmsp20" not in set(found["muscle"])
    ratio = only(found, source="geometric")["force / force of the narrowest [1]"]
    assert ratio.to_numpy() == pytest.approx(4, rel=1e-9)
    share = only(found, source="geometric", **{CONTRACTION: 0.1})
    expected = eq_1(0.3, 0.1) / eq_1(0.3, 0.0)
    assert share["force of the narrowest / its largest [1]"].to_numpy() == pytest.approx(expected)


def test_fig11_takes_the_worse_status_of_the_two(scene_data, fail):
    from workflow.figures import fig11

    def spoil(case, solution):
        narrow = case.muscle.inner_diameter == 20 and case.model == "solid"
        return fail(solution, StateStatus.NOT_REACHED, 3) if narrow else solution

    found = fig11.table(scene_data("fig11", spoil))
    bad = found[found["status"] == "not_reached"]
    assert set(bad["source"]) == {"solid"}
    assert set(bad[CONTRACTION]) == {0.03}
    assert set(bad["muscle"]) == {"dmsp20_d40", "dmsp20_d40_n120"}


@pytest.mark.parametrize(("name", "column"), [("fig12", FORCE), ("fig13", CONTRACTION)])
def test_fig12_and_fig13_run_along_wall_thickness(table, name, column):
    found = table(name)
    assert set(found[SERIES]) == {"NBR", "silicone"}
    nbr = only(found, **{SERIES: "NBR"})
    assert nbr[WALL].tolist() == [1.5, 2, 2.5, 3]
    assert nbr[column].notna().all()


def test_principal_stresses():
    # in-plane 2 and 8 MPa turned by 30 degrees, hoop 5; then hoop the largest, hoop the smallest
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    rr, zz, rz = 2 * c**2 + 8 * s**2, 2 * s**2 + 8 * c**2, 6 * s * c
    rows = np.array([[rr, rz, zz, 5.0], [rr, rz, zz, 9.0], [rr, rz, zz, 1.0]])
    largest, smallest = principal_of_four(rows)
    assert largest == pytest.approx([8, 9, 8])
    assert smallest == pytest.approx([2, 2, 1])


def test_mean_through_the_wall_is_that_of_the_area():
    # a stress 1 + R - 10 MPa on a wall from R = 10 to 12: mean 2
    corners = [(10, 0), (12, 0), (12, 5), (10, 0), (12, 5), (10, 5)]
    hoop = [1 + r - 10 for r, _ in corners]
    table = wall(
        {
            "corners": np.array([[r, z, r, z] for r, z in corners], float),
            "stress": np.array([[0, 0, 0, t] for t in hoop], float),
        }
    )
    lines = along_meridian(table)
    assert only(lines, where="mean")[LARGEST].tolist() == pytest.approx([2])
    assert only(lines, where="inner surface")[LARGEST].tolist() == pytest.approx([1, 1])
    assert only(lines, where="outer surface")["Z [mm]"].tolist() == [0, 5]


def test_fig11_of_one_muscle_is_refused(small_scene):
    from workflow.figures import fig11

    with pytest.raises(StudyError, match="at least two muscles"):
        fig11.table(small_scene())
