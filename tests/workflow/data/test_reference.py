"""The force maps against hand-computed values."""

import numpy as np
import pytest

from workflow.data import reference


@pytest.fixture(scope="module")
def maps():
    return reference.load()


def test_points_come_back_exactly(maps):
    for found in maps.values():
        for pressure, contraction, force in found.points:
            assert found.force(contraction, pressure) == pytest.approx(force, abs=1e-9)


def test_musclesim_between_its_points(maps):
    force = maps["festo_musclesim"].force([0.10, 0.15, 0.20], 0.3)
    assert force == pytest.approx([299, 160, 37], abs=0.5)


def test_linear_in_pressure(maps):
    # 282 mm: 309.7 N at 0.28125 MPa, 380.4 N at 0.3125 MPa
    assert maps["martens2017"].force(0.06, 0.3) == pytest.approx(309.7 + 0.6 * (380.4 - 309.7))


def test_two_points_are_joined_by_a_line(maps):
    # at 0.14625 MPa only 296 and 282 mm are under tension
    middle = 1 - 289 / 300
    assert maps["martens2017"].force(middle, 0.14625) == pytest.approx((273.3 + 21.1) / 2)


def test_suspect_point_is_not_used(maps):
    found = maps["festo_musclesim"]
    assert found.suspect.tolist() == [[0.2, 0.12, 112.0]]
    assert float(found.force(0.12, 0.2)) < 90  # between 240 N at 5 % and 8.7 N at 15.5 %
    assert 0.12 not in found.contractions(0.2)


def test_slack_zeros_are_no_forces(maps):
    assert np.all(maps["martens2017"].points[:, 2] > 0)
    assert not maps["martens2017"].inside(0.20, 0.3)  # between 250 mm, pulling, and 237 mm, slack
    assert maps["festo_musclesim"].force(0.0, 0.0) == 0  # there a zero is a zero


@pytest.mark.parametrize(
    ("name", "contraction", "pressure"),
    [
        ("festo_musclesim", 0.26, 0.3),
        ("festo_musclesim", 0.10, 0.7),
        ("martens2017", 0.0, 0.3),  # longer than the longest measured
        ("martens2017", 0.05, 0.03),
        ("martens2017", 0.10, 0.19),  # slack at 11 % and 0.18 MPa
    ],
)
def test_nan_outside(maps, name, contraction, pressure):
    assert np.isnan(maps[name].force(contraction, pressure))
    assert not maps[name].inside(contraction, pressure)


def test_tabulated_contractions_around_a_pressure(maps):
    assert maps["martens2017"].contractions(0.3) == pytest.approx([4 / 300, 0.06, 0.11, 1 / 6])
    assert maps["festo_musclesim"].contractions(0.7).size == 0


def test_a_single_point_is_no_curve(maps):
    # at 0.065 MPa only 296 mm is under tension
    found = maps["martens2017"].force([4 / 300, 0.02], 0.065)
    assert found[0] == pytest.approx(54.9)
    assert np.isnan(found[1])
    assert maps["martens2017"].force(4 / 300, 0.065).shape == ()


def test_a_small_force_is_small_whatever_else_is_asked():
    """The largest force is that of the map, not of the contractions that are asked for."""
    found = reference.musclesim()
    grid = np.linspace(0, 0.2, 5)
    small = grid[reference.is_small(found, grid, 0.1)]
    assert len(small)
    force = found.force(small, 0.1)
    assert np.isnan(reference.relative_deviation(found, small, 0.1, 1.1 * force)).all()
