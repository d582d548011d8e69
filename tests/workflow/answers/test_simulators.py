"""What simulators make of a map: an FMU by fmpy, a mass by SciPy, a tendon by MuJoCo."""

import re
import subprocess
from pathlib import Path

import fmpy
import fmpy.validation
import mujoco
import numpy as np
import pytest

from workflow.__main__ import main
from workflow.answers.maps import files, fmu
from workflow.answers.maps.build import Builder, Checked
from workflow.answers.maps.table import FORCE, VOLUME, Map, read

from ..synthetic import MUSCLE

ANSWERS = Path(__file__).parents[3] / "docs" / "answers.md"
LENGTH, HUNG = 300.0, 20 * 9.80665  # mm, N


@pytest.fixture(scope="module")
def arm():
    """About the muscle of the paper: F = 2400 p (1 - 4 e) - 40 (1 + 9 e), V by its potential."""
    p, e = np.linspace(0, 0.6, 7), np.linspace(-0.1, 0.3, 9)
    pp, ee = np.meshgrid(p, e, indexing="ij")
    tables = {
        FORCE: 2400 * pp * (1 - 4 * ee) - 40 * (1 + 9 * ee),
        f"{FORCE}_by_pressure": 2400 * (1 - 4 * ee),
        f"{FORCE}_by_contraction": -9600 * pp - 360,
        f"{FORCE}_mixed": np.full(pp.shape, -9600.0),
        VOLUME: 1e5 + LENGTH * 2400 * (ee - 2 * ee**2),
        f"{VOLUME}_by_pressure": 0 * pp,
        f"{VOLUME}_by_contraction": LENGTH * 2400 * (1 - 4 * ee),
        f"{VOLUME}_mixed": 0 * pp,
    }
    return Map("arm", "solid", LENGTH, p, e, tables, np.ones(pp.shape, bool))


@pytest.fixture(scope="module")
def folder(arm, tmp_path_factory):
    """The files of the map where the examples look for them."""
    made = tmp_path_factory.mktemp("simulators")
    files.write(Checked(arm, np.empty((0, 5)), 0.0, 0.0, 0.0, 0), made / "results/maps/arm.nc")
    return made


def test_the_fmu_is_valid_and_compiled(folder):
    file = str(folder / "results/maps/arm.fmu")
    assert fmpy.validation.validate_fmu(file) == []
    assert fmpy.platform in fmpy.supported_platforms(file), "no C compiler"


def test_its_source_is_plain_c(arm, tmp_path):
    (tmp_path / "muscle.c").write_text(fmu.source(arm))
    words = ["gcc", "-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-c", "muscle.c"]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_its_description_has_license_and_units(folder):
    described = fmpy.read_model_description(str(folder / "results/maps/arm.fmu"))
    assert described.license == "MIT"
    dimensions = {
        unit.name: (unit.baseUnit.kg, unit.baseUnit.m, unit.baseUnit.s)
        for unit in described.unitDefinitions
    }
    assert dimensions["Pa"] == (1, -1, -2)
    assert dimensions["N/m"] == (1, 0, -2)
    assert {v.unit for v in described.modelVariables} == dimensions.keys()


def test_beyond_the_table_the_log_says_so_once(folder, arm):
    """Into 0.7 MPa, where there are 0.6, and back, twice."""
    said = []
    time = np.linspace(0, 1, 21)
    p = 0.5e6 + 0.2e6 * np.abs(np.sin(2 * np.pi * time))
    signal = np.array(
        list(zip(time, p, np.full(21, 0.27), strict=True)),
        dtype=[("time", float), ("p", float), ("l", float)],
    )
    found = fmpy.simulate_fmu(
        str(folder / "results/maps/arm.fmu"),
        stop_time=1.0,
        step_size=0.05,
        output_interval=0.05,
        input=signal,
        output=["F", "p", "valid"],
        logger=lambda *given: said.append(given[4].decode()),
    )
    outside = found["p"] > 0.6e6
    assert 0 < outside.sum() < 20
    assert ((found["valid"] == 0) == outside).all()
    np.testing.assert_allclose(found["F"][outside], arm(FORCE, 0.6, 0.1))
    assert len(said) == 2
    assert "pressure 6" in said[0]
    assert "(it has 0 to 600000)" in said[0]


def test_a_simulator_gets_the_forces_of_the_map(folder, arm):
    """A pressure that rises while the muscle gets shorter; SI units."""
    time = np.linspace(0, 1, 41)
    p, e = 0.1 + 0.45 * time, -0.05 + 0.3 * time
    signal = np.array(
        list(zip(time, p * 1e6, LENGTH * 1e-3 * (1 - e), strict=True)),
        dtype=[("time", float), ("p", float), ("l", float)],
    )
    names = [name for name, _, causality, _ in fmu.VARIABLES if causality == "output"]
    found = fmpy.simulate_fmu(
        str(folder / "results/maps/arm.fmu"),
        stop_time=1.0,
        step_size=0.025,
        output_interval=0.025,
        input=signal,
        output=[*names, "p", "l"],
    )
    at_p, at_e = found["p"] * 1e-6, 1 - found["l"] / (LENGTH * 1e-3)
    assert at_p[-1] > 0.5
    assert np.abs(found["F"] - arm(FORCE, at_p, at_e)).max() < 0.05
    np.testing.assert_allclose(found["F"], arm(FORCE, at_p, at_e), atol=1e-9)
    np.testing.assert_allclose(found["V"], arm(VOLUME, at_p, at_e) * 1e-9, rtol=1e-12)
    by_p, by_e = (arm(FORCE, at_p, at_e, by=k) for k in ("pressure", "contraction"))
    np.testing.assert_allclose(found["dF_dp"], by_p * 1e-6, rtol=1e-9)
    np.testing.assert_allclose(found["dF_dl"], -by_e / (LENGTH * 1e-3), rtol=1e-9)
    assert (found["valid"] == 1).all()


def examples():
    """Blocks of Python of the page, by a word that only they have."""
    blocks = re.findall(r"^```python\n(.*?)^```$", ANSWERS.read_text(), re.M | re.S)
    return {
        word: next(b for b in blocks if word in b) for word in ("table.read", "scipy", "mujoco")
    }


@pytest.fixture
def ran(folder, monkeypatch):
    """Runs examples of the page, the map first, and gives what they have defined."""
    monkeypatch.chdir(folder)

    def run(word):
        names: dict = {}
        for each in ("table.read", word):
            exec(compile(examples()[each], str(ANSWERS), "exec"), names)
        return names

    return run


def test_the_example_with_scipy_comes_to_rest_where_the_mass_hangs(ran, arm):
    found = ran("scipy")["found"]
    assert found.success
    expected = arm.contraction_for(0.3, HUNG)
    assert found.y[0, -1] == pytest.approx(expected, abs=1e-3)
    assert found.y[0].min() + 1e-9 > 0


def test_the_example_with_mujoco_does_too(ran, arm):
    """The real simulator: a mass on a tendon whose force is that of the table."""
    try:
        names = ran("mujoco")
        contraction = 1 - names["data"].ten_length[0] / 0.3
    finally:
        mujoco.set_mjcb_act_gain(None)
        mujoco.set_mjcb_act_bias(None)
    assert contraction == pytest.approx(arm.contraction_for(0.3, HUNG), abs=1e-4)


def test_a_map_is_read_as_it_was_written(folder, arm):
    again = read(str(folder / "results/maps/arm.nc"))
    assert again(FORCE, 0.37, 0.11) == arm(FORCE, 0.37, 0.11)


def test_without_a_compiler_the_source_is_there_and_it_is_said(arm, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(fmu.shutil, "which", lambda name: None)
    monkeypatch.chdir(tmp_path)
    checked = Checked(arm, np.empty((0, 5)), 0.0, 0.0, 0.0, 0)
    monkeypatch.setattr(Builder, "built", lambda self: checked)
    Path("study.yaml").write_text(
        MUSCLE + "scenes: {}\n"
        "map: {arm: {muscle: one, pressure: [0, 0.1, 0.2], contraction: [0, 0.1, 0.2]}}\n"
    )
    assert main(["map", "arm", "--study", "study.yaml", "--folder", "maps"]) == 0
    assert "there is no C compiler" in capsys.readouterr().out
    assert fmpy.supported_platforms("maps/arm.fmu") == ["c-code"]
