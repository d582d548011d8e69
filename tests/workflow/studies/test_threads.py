"""The study of discrete threads: its cases, the correction in its table, the cut of a picture."""

from pathlib import Path

import numpy as np
import pytest

from solver.record import Solution, unreached
from solver.status import CaseStatus, StateStatus
from workflow.config import load
from workflow.principal import principal_of_six
from workflow.studies import Solved, threads
from workflow.studies.threads_figures import cut

CONFIG = Path(__file__).parents[3] / "config" / "config.yaml"
FORCE = {"discrete": 99.0, "smeared": 100.0, "wire": 90.0}


@pytest.fixture(scope="module")
def asked():
    return threads.cases(load(CONFIG))


@pytest.fixture(scope="module")
def solved(asked):
    """Every curve with a force that only its layers decide."""
    found = []
    for entry in asked:
        count = entry.case.path.states
        states = unreached(count)
        states["force"] = np.full(count, FORCE[str(entry.tags["layers"])])
        status = [StateStatus.CONVERGED] * count
        solution = Solution(
            status=CaseStatus.CONVERGED, reason="", states=states, state_status=status
        )
        found.append(Solved(entry, solution))
    return found


def test_every_curve_of_single_threads_has_its_smeared_one(solved):
    rows = threads.table(solved)
    compared = rows[rows["set"] != "picture"]
    assert compared[compared["layers"] == "discrete"]["change [N]"].to_numpy() == pytest.approx(-1)
    assert compared[compared["layers"] == "smeared"]["change [N]"].to_numpy() == pytest.approx(0)
    assert compared[compared["layers"] == "wire"]["share [1]"].to_numpy() == pytest.approx(-0.1)


def test_walls_of_silicone_are_those_of_the_claim(solved):
    walls = threads.silicone_walls(threads.table(solved))
    assert list(walls.index) == [1.5, 2.0, 2.5, 3.0]
    assert list(walls.columns) == [0.2, 0.3, 0.4]


def test_the_picture_shows_both_rubbers(asked):
    shown = [entry for entry in asked if entry.case.fields_at]
    assert [entry.tags["rubber"] for entry in shown] == ["NBR", "silicone"]


def test_a_tetrahedron_is_cut_in_a_triangle_or_a_quadrangle():
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    assert cut(corners, corners[:, 2] - 2) == []
    (triangle,) = cut(corners, corners[:, 2] - 0.5)
    assert triangle[:, :2].max() == pytest.approx(0.5)
    (quadrangle,) = cut(corners, corners[:, 0] + corners[:, 1] - 0.5)
    assert len(quadrangle) == 4


def test_principal_stresses_of_six_components():
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    tensor = turn @ np.diag([-1.0, 2, 5]) @ turn.T
    six = tensor[[0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2]]
    assert principal_of_six(six[None])[0] == pytest.approx([-1, 2, 5])
