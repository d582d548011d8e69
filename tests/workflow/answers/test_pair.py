"""Two muscles on a pulley, by maps whose torque is worked out by hand."""

import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from workflow.__main__ import main
from workflow.answers.maps import pair
from workflow.answers.maps.build import Builder, Checked
from workflow.answers.maps.table import FORCE, VOLUME, Map
from workflow.plan.plan import read
from workflow.study.errors import StudyError
from workflow.study.study import load

STUDY = """
materials: {nbr: {c10: 0.345083, c01: 0.083805}}
muscles:
  dmsp20: {inner_diameter: 20, wall_thickness: 2, length: 200, layer_depths: [0.3, 0.9],
    threads: 60, lead: 144, thread_stiffness: 315, material: nbr}
scenes: {}
map:
  arm: {muscle: dmsp20, pressure: [0, 0.2, 0.4], contraction: [-0.05, 0, 0.25]}
pair:
  joint: {agonist: arm, radius: 20, contraction: 0.1, angle: {from: -60, to: 60, step: 30},
    pressure: [[0.3, 0.1], [0.2, 0.2]]}
"""


def made(length=200.0):
    """F = 1000 p (1 - 4 e) [N]."""
    p, e = np.array([0.0, 0.2, 0.4]), np.array([-0.05, 0.0, 0.25])
    pp, ee = np.meshgrid(p, e, indexing="ij")
    parts = {
        "": 1000 * pp * (1 - 4 * ee),
        "_by_pressure": 1000 * (1 - 4 * ee),
        "_by_contraction": -4000 * pp,
        "_mixed": np.full(pp.shape, -4000.0),
    }
    tables = {q + part: values for q in (FORCE, VOLUME) for part, values in parts.items()}
    return Map("m", "cylinder", length, p, e, tables, np.ones(pp.shape, bool))


JOINT = pair.Pair(made(), made(), radius=20.0, contraction=0.1)


def test_the_torque_in_the_middle():
    """180 N against 60 N at 20 mm."""
    assert JOINT.torque(0.0, 0.3, 0.1) == pytest.approx(2.4)
    assert JOINT.torque(0.0, 0.2, 0.2) == pytest.approx(0.0)


def test_the_torque_of_a_turned_joint():
    """At 0.5 rad the muscles are at 15 and 5 %: 120 N against 80 N."""
    assert JOINT.contractions(0.5) == (pytest.approx(0.15), pytest.approx(0.05))
    assert JOINT.torque(0.5, 0.3, 0.1) == pytest.approx(0.02 * (120 - 80))


def test_the_stiffness_goes_with_the_sum_of_the_pressures():
    """r^2 4000 (p + p') / L = 400 * 1600 / 200 N mm."""
    assert JOINT.stiffness(0.3, 0.3, 0.1) == pytest.approx(3.2)
    assert JOINT.stiffness(0.3, 0.2, 0.2) == pytest.approx(3.2)
    assert JOINT.stiffness(0.3, 0.4, 0.4) == pytest.approx(6.4)


def test_where_it_rests():
    """0.3 (0.6 - 4 x) = 0.1 (0.6 + 4 x) at x = 0.075, which are 15 mm of the pulley."""
    assert JOINT.rest(0.3, 0.1) == pytest.approx(0.75)
    assert JOINT.rest(0.2, 0.2) == pytest.approx(0.0, abs=1e-12)
    assert math.isnan(JOINT.rest(0.4, 0.0))  # 1.5 rad, where the antagonist would be at -5 %
    assert JOINT.reach == (pytest.approx(-1.5), pytest.approx(1.5))


def test_muscles_of_two_lengths_turn_alike():
    """The longer one is shortened by a smaller share."""
    joint = pair.Pair(made(), made(400.0), radius=20.0, contraction=0.1)
    assert joint.contractions(0.5) == (pytest.approx(0.15), pytest.approx(0.075))
    assert joint.torque(0.5, 0.3, 0.1) == pytest.approx(0.02 * (120 - 70))
    assert joint.stiffness(0.0, 0.3, 0.1) == pytest.approx(0.4 * (1200 / 200 + 400 / 400))


def test_the_stiffness_is_the_slope_of_the_torque():
    step = 1e-6
    ends = [float(JOINT.torque(0.2 + s * step, 0.35, 0.12)) for s in (1, -1)]
    slope = (ends[0] - ends[1]) / (2 * step)
    assert JOINT.stiffness(0.2, 0.35, 0.12) == pytest.approx(-slope, rel=1e-6)


def test_the_program_draws_it(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("study.yaml").write_text(STUDY)
    monkeypatch.setattr(
        Builder, "built", lambda self: Checked(made(), np.empty((0, 5)), 0.0, 0.0, 0.0, 0)
    )
    assert main(["pair", "joint", "--study", "study.yaml", "--folder", "pairs"]) == 0
    assert "joint at 0.3 and 0.1 MPa: rests at 43 degrees, 3.2 N m/rad" in capsys.readouterr().out
    rows = pd.read_csv("pairs/joint.csv")
    assert len(rows) == 2 * 5
    assert rows["torque [N m]"][2] == pytest.approx(2.4)
    assert rows["angle without a load [degree]"][0] == pytest.approx(math.degrees(0.75), rel=1e-6)
    assert "data:image/png" in Path("pairs/joint.html").read_text()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("agonist: arm", "agonist: leg"), "arm"),
        (("radius: 20", "radius: 0"), "greater than 0"),
        (("contraction: 0.1,", "contraction: 0.5,"), "-0.05 to 0.25, where the maps are"),
        (("[0.3, 0.1]", "[0.3, 0.5]"), "0 to 0.4 MPa, where the map is"),
        (("[[0.3, 0.1], [0.2, 0.2]]", "[0.3, 0.1]"), "a list of pairs of pressures"),
    ],
)
def test_a_pair_that_makes_no_sense_is_refused(tmp_path, change, said):
    assert change[0] in STUDY
    (tmp_path / "study.yaml").write_text(STUDY.replace(*change))
    with pytest.raises(StudyError) as refused:
        read(tmp_path / "study.yaml")
    assert said in str(refused.value)


def test_a_pair_is_read(tmp_path):
    (tmp_path / "study.yaml").write_text(STUDY)
    assert load(tmp_path / "study.yaml").pairs["joint"].antagonist is None
