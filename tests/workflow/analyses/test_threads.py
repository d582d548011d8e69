"""Discrete threads: its cases, the correction in its table, what a picture shows."""

from pathlib import Path

import meshio
import numpy as np
import pytest

from geometry import cell
from geometry.cell import Box
from geometry.mesh_settings import CellMesh
from solver.record import unreached
from workflow.analyses import additions
from workflow.analyses.analysis import Solved
from workflow.analyses.threads import cases, figures, local, table
from workflow.data.principal_stress import principal_of_six
from workflow.study.study import load

from ..synthetic import converged

CONFIG = Path(__file__).parents[3] / "config" / "config.yaml"
CORNER = np.zeros((1, 6))
FORCE = {"discrete": 99.0, "smeared": 100.0, "wire": 90.0}


@pytest.fixture(scope="module")
def asked():
    return cases.cases(load(CONFIG))


@pytest.fixture(scope="module")
def solved(asked):
    """Every curve with a force that only its layers decide."""
    found = []
    for entry in asked:
        count = entry.case.path.states
        states = unreached(count)
        states["force"] = np.full(count, FORCE[str(entry.tags["layers"])])
        found.append(Solved(entry, converged(states)))
    return found


def test_every_curve_of_single_threads_has_its_smeared_one(solved):
    rows = table.table(solved)
    compared = rows[rows["set"] != "picture"]
    assert compared[compared["layers"] == "discrete"]["change [N]"].to_numpy() == pytest.approx(-1)
    assert compared[compared["layers"] == "smeared"]["change [N]"].to_numpy() == pytest.approx(0)
    assert compared[compared["layers"] == "wire"]["share [1]"].to_numpy() == pytest.approx(-0.1)


def test_walls_of_silicone_are_those_of_the_claim(solved):
    asked = {entry.case.key for entry in cases.of_claim(load(CONFIG))}
    change = table.change_by_wall([one for one in solved if one.asked.case.key in asked])
    assert change.to_dict() == pytest.approx(dict.fromkeys([1.5, 2.0, 2.5, 3.0], -1.0))


def test_the_picture_shows_both_rubbers(asked):
    pictures = [Solved(a, with_fields(a, {"corners": CORNER})) for a in asked if a.case.fields_at]
    assert len(pictures) == 4
    shown = figures.shown(pictures)
    assert list(shown) == ["NBR", "silicone"]
    assert {entry.asked.tags["layers"] for entry in shown.values()} == {"discrete"}


@pytest.fixture(scope="module")
def corners(muscle, tmp_path_factory):
    """Corners R, T, Z of all tetrahedra of a coarse cell, a little inside as FreeFEM has them."""
    file = tmp_path_factory.mktemp("cell") / "cell.mesh"
    cell.write(muscle, CellMesh(thread_size=2, body_size=0.5), 0.31, file)
    mesh = meshio.read(file)
    found = mesh.points[mesh.cells_dict["tetra"]]
    found += 1e-6 * (found.mean(axis=1, keepdims=True) - found)
    return found.reshape(-1, 3) / [1, 11, 1]


def made_up(corners, stretch=1.02):
    """Fields of an undeformed cell: hoop stress that rises with R, stretch the same everywhere."""
    stress, spread = np.zeros((len(corners), 6)), np.ones((len(corners), 4))
    stress[:, 1] = corners[:, 0]
    spread[:, :2] = stretch
    return {"corners": np.hstack([corners, corners]), "stress": stress, "threads": spread}


def with_fields(asked, fields):
    return converged(unreached(1), fields={0: fields})


def test_a_node_and_its_periodic_images_are_one(corners, muscle):
    places, values = local.nodes(made_up(corners), Box(muscle))
    own = len(places) // 9
    assert len(np.unique(np.round(places, 3), axis=0)) == len(places)
    assert own < len(corners) / 8  # of about 20 tetrahedra that meet at one
    assert values[:, 2] == pytest.approx(places[:, 0], abs=1e-3)
    assert values[:, 0] == pytest.approx(places[:, 0], abs=1e-3)
    sides = np.ptp(places, axis=0)
    box = Box(muscle)
    assert sides[1] > 2.5 * box.width
    assert sides[2] > 2.5 * box.spacing


def test_tension_is_that_of_the_thread_law(asked, corners):
    picture = next(a for a in asked if a.case.fields_at)
    rows = local.tension(Solved(picture, with_fields(picture, made_up(corners))))
    assert set(rows["layer"]) == {1, 2}
    assert rows["thread tension [N]"].to_numpy() == pytest.approx(0.02 * 315, rel=0.02)
    assert rows["along the cell [1]"].between(0, 1).all()


def test_pictures_say_how_much_higher_the_stress_is(asked, corners):
    size = {"discrete": 1.5, "smeared": 1.0}
    solved = []
    for entry in (a for a in asked if a.case.fields_at):
        fields = made_up(corners)
        fields["stress"] = fields["stress"] * size[str(entry.tags["layers"])]
        solved.append(Solved(entry, with_fields(entry, fields)))
    rows = table.table(solved)
    rows = rows[rows["set"] == "picture"].set_index(["rubber", "layers"])
    assert rows.loc[("NBR", "discrete"), "stress concentration [1]"] == pytest.approx(1.5)
    assert rows.loc[("silicone", "smeared"), "stress concentration [1]"] == pytest.approx(1.0)


def test_principal_stresses_of_six_components():
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    tensor = turn @ np.diag([-1.0, 2, 5]) @ turn.T
    six = tensor[[0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2]]
    assert principal_of_six(six[None])[0] == pytest.approx([-1, 2, 5])


def test_columns_stay_apart_in_the_dataset(solved):
    rows = table.table(solved)
    assert len(additions.group(rows)) == len(rows.columns)
