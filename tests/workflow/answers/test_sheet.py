"""The data sheet: its checked numbers, its balance of energy, and the scene that asks for it."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from solver.load_path import LoadPath
from workflow.__main__ import main
from workflow.answers import sheet, sheet_figure, sheet_files
from workflow.answers.store import Store
from workflow.plan.plan import read
from workflow.plan.sheet_stops import stops_to
from workflow.study import library
from workflow.study.errors import StudyError
from workflow.study.study import load, load_library

ROOT = Path(__file__).parents[3]
STUDY = """
materials: {nbr: {c10: 0.345083, c01: 0.083805, stretch_limit: 2.0, density: 1.2}}
muscles:
  dmsp20:
    {inner_diameter: 20, wall_thickness: 2, length: 300, layer_depths: [0.3, 0.9], threads: 60,
     lead: 144, thread_stiffness: 315, thread_strength: 50, material: nbr,
     reference: [festo_musclesim]}
  built_in: {base: dmsp20, fitting_length: 40, dead_volume: 5000, ambient_pressure: 0.08,
    thread_diameter: 0.4, thread_density: 1.4, fitting_mass: 120}
scenes:
  mine:
    path: isobaric
    muscles: [dmsp20]
    pressure: [0.2, 0.3]
    contraction: [0, 0.2]
    load: [100]
    models: [cylinder]
    quantities: [sheet]
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("sheets")
    (made / "study.yaml").write_text(STUDY)
    return made


@pytest.fixture
def study(folder, monkeypatch):
    monkeypatch.chdir(folder)
    return load("study.yaml")


def test_the_sheet_of_the_muscle_of_the_paper(study):
    """By the solid at 0.3 MPa with 200 N, against the limit of its mesh (twice as fine)."""
    found = sheet.solved(study, "dmsp20", 0.3, load=200.0)
    assert found.value("blocked force") == pytest.approx(671.4, abs=0.05)
    assert found.value("free contraction") == pytest.approx(21.257, abs=5e-3)
    assert found.value("stroke at the load") == pytest.approx(38.021, abs=5e-3)
    assert found.value("work to free contraction") == pytest.approx(17.860, abs=5e-3)
    assert found.value("work at the load") == pytest.approx(7.60, abs=5e-3)
    assert found.value("air to free contraction") == pytest.approx(0.788, abs=5e-4)
    assert found.value("air at the load") == pytest.approx(0.675, abs=5e-4)
    assert found.value("efficiency at the load") == pytest.approx(7.1, abs=0.05)
    assert found.value("stiffness, valve open") == pytest.approx(8.781, abs=5e-3)
    assert found.value("largest thread force") == pytest.approx(7.485, abs=0.03)
    assert found.value("share of the thread's strength") == pytest.approx(14.97, abs=0.06)
    assert found.value("largest outer diameter") == pytest.approx(38.52, abs=5e-3)
    assert found.closes
    assert abs(found.value("energy balance")) < 1e-6
    assert found.outline[0, 1] == pytest.approx(38.420, abs=5e-3)  # at the last stop, 21 %
    assert found.outline_at == 0.21
    assert found.outline[-1] == pytest.approx([150 * 0.79, 24], abs=1.5)  # the fitting


def test_the_outline_of_a_membrane_is_that_of_its_outer_surface(study):
    found = sheet.solved(study, "dmsp20", 0.3, model="membrane", load=200.0)
    states = found.curve.solution.states
    widest = states["outer_diameter"][np.isclose(states["contraction"], 0.21)]
    assert found.outline_at == 0.21
    assert found.outline[0] == pytest.approx([0, widest[0]], rel=1e-6)
    assert found.outline[-1] == pytest.approx([150 * 0.79, 24], abs=1.5)  # the fitting
    assert (np.diff(found.outline[:, 0]) > 0).all()
    assert len(sheet_figure.draw(study, [found]).axes) == 2
    cylinder = sheet.solved(study, "dmsp20", 0.3, model="cylinder", load=200.0)
    assert len(sheet_figure.draw(study, [cylinder]).axes) == 1  # none of what is not there


def test_stiffness_behind_a_closed_valve_is_that_of_states_with_the_same_air(study):
    """Two states beside the one at the load, whose pressures keep the air that is inside."""
    found = sheet.solved(study, "dmsp20", 0.3, model="cylinder", load=200.0)
    case, around, dead = found.curve.case, 0.101325, 0.0
    at = found.curve.contraction_of(200.0)
    inside = float(found.curve.volume(at)) + dead
    step = 1e-3
    for name, exponent in (("slow", 1.0), ("fast", 1.4)):
        forces = []
        for contraction in (at - step, at + step):
            pressure, last = 0.3, None
            for _ in range(30):
                stops = (round(pressure, 9),)
                path = LoadPath(kind="isometric", held=round(contraction, 9), stops=stops)
                states = Store(study).solution(replace(case, path=path, fields_at=())).states
                volume = states["volume"][0] + dead
                pressure = (0.3 + around) * (inside / volume) ** exponent - around
                last = states["force"][0]
                if abs(pressure - stops[0]) < 1e-8:
                    break
            forces.append(last)
        by_length = (forces[0] - forces[1]) / (2 * step * 300)
        assert found.value(f"stiffness, valve closed, {name}") == pytest.approx(by_length, rel=2e-3)


def test_what_it_is_built_into(study):
    plain = sheet.solved(study, "dmsp20", 0.3, model="cylinder", load=200.0)
    built = sheet.solved(study, "built_in", 0.3, model="cylinder", load=200.0)
    assert built.case == plain.case  # nothing is solved again
    assert math.isnan(plain.value("installed length"))
    assert built.value("installed length") == 380.0
    air, around = built.value("air at the load"), 0.08
    full = float(built.curve.volume(built.curve.contraction_of(200.0)))
    inside = (full + 5000) * (0.3 + around) - (math.pi * 100 * 300 + 5000) * around
    assert air == pytest.approx(inside / around / 1e6, rel=1e-12)
    assert built.value("stiffness, valve closed, slow") < plain.value(
        "stiffness, valve closed, slow"
    )
    rubber = math.pi / 4 * (24**2 - 20**2) * (300 + 2 * 8) / 1000 * 1.2
    turns = [300 / 144 * math.hypot(144, math.pi * d) for d in (20.6, 21.8)]
    threads = 60 * sum(turns) * math.pi * 0.2**2 / 1000 * 1.4
    assert built.value("mass") == pytest.approx(rubber + threads + 120, rel=1e-9)
    row = next(row for row in plain.rows if row.name == "mass")
    assert row.value == pytest.approx(rubber)
    assert "thread_diameter" in row.note
    assert "fitting_mass" in row.note


@pytest.mark.parametrize("name", library.names("muscles"))
def test_the_balance_closes_for_every_muscle_of_the_library(name, folder, monkeypatch):
    """By the solid at 0.3 MPa, whatever its braid and rubber."""
    monkeypatch.chdir(folder)
    found = sheet.solved(load_library(), name, 0.3)
    assert found.closes
    assert abs(found.value("energy balance")) < 1e-5


def test_a_curve_that_ends_before_its_free_contraction_says_how_far_it_goes(study, folder):
    fine = sheet.solved(study, "dmsp20", 0.3, model="cylinder")
    short = replace(fine.curve.case.path, stops=stops_to(0.1), zero_force=False)
    case = replace(fine.curve.case, path=short)
    found = sheet.sheet(
        study.muscles["dmsp20"], "dmsp20", "default", case, Store(study).solution(case)
    )
    assert math.isnan(found.value("free contraction"))
    rows = {row.name: row for row in found.rows}
    for name in ("largest thread force", "largest rubber stretch", "largest outer diameter"):
        assert rows[name].note.endswith("to 10 %, as far as it goes")
        assert rows[name].value <= fine.value(name)  # threads bear the most on the way
    assert rows["largest outer diameter"].value < fine.value("largest outer diameter")
    assert rows["energy balance"].note.endswith("to 10 %, as far as it goes")
    assert {row.name: row for row in fine.rows}["largest outer diameter"].note.endswith(
        "to free contraction"
    )


@pytest.mark.parametrize(
    "rubber",
    [
        "{law: ogden, convention: textbook, mu: [0.6, 0.02], alpha: [1.5, 5]}",
        "{law: gent, mu: 0.8, jm: 40}",
    ],
)
@pytest.mark.parametrize("model", ["cylinder", "membrane"])
def test_the_balance_closes_with_other_laws(rubber, model, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = STUDY.replace("materials: {", f"materials: {{other: {rubber}, ")
    text = text.replace("  built_in:", "  other: {base: dmsp20, material: other}\n  built_in:")
    Path("study.yaml").write_text(text)
    found = sheet.solved(load("study.yaml"), "other", 0.3, model=model)
    assert abs(found.value("energy balance")) < 1e-5


def test_a_balance_that_does_not_close_is_said(study, folder):
    """With two far stops the cubics between them are not good enough."""
    fine = sheet.solved(study, "dmsp20", 0.3, model="cylinder").curve.case
    coarse = replace(fine, path=replace(fine.path, stops=(0.0, 0.2)))
    solution = Store(study).solution(coarse)
    found = sheet.sheet(study.muscles["dmsp20"], "dmsp20", "default", coarse, solution)
    assert not found.closes
    assert "does not close" in sheet.warnings([found])[0]


def test_a_scene_asks_for_sheets(study, folder, capsys):
    plan = read("study.yaml")
    for planned in plan.cases.values():
        assert planned.case.path.stops == stops_to(0.2)
        assert planned.case.path.zero_force
        Store(study).solution(planned.case)
    output = Path("results/sheets/mine.html")
    words = ["sheets", "--study", "study.yaml", "--scene", "mine", "--output", str(output)]
    assert main(words) == 0
    found = json.loads(output.with_suffix(".json").read_text())
    assert [sheet["pressure"]["value"] for sheet in found] == [0.2, 0.3]
    assert all(sheet["energy_balance_closes"] for sheet in found)
    loads = [r["value"] for sheet in found for r in sheet["rows"] if r["name"] == "load"]
    assert loads == [100, 100]
    page = output.read_text()
    assert "stiffness, valve closed" in page
    assert "data:image/png" in page
    assert "deviation from festo_musclesim" in page
    with pytest.raises(StudyError, match="nearest: mine"):
        sheet_files.of_scene(plan, "mini")


def test_the_command_prints_it(study, folder, capsys):
    words = ["sheet", "dmsp20", "--pressure", "3bar", "--load", "200N", "--study", "study.yaml"]
    assert main([*words, "--model", "cylinder"]) == 0
    assert "blocked force                   689.5 N" in capsys.readouterr().out
    assert main([*words, "--model", "geometric"]) == 1
    assert "cylinder, membrane, solid" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("load: [100]", "load: [100, 200]"), "one load > 0"),
        (("load: [100]", "load: [-5]"), "one load > 0"),
        (("contraction: [0, 0.2]", "contraction: [-0.02, 0]"), "pulls no more"),
        (("models: [cylinder]", "models: [geometric]"), "only by cylinder, membrane, solid"),
        (("quantities: [sheet]", "quantities: [force]"), "this key is not used on an isobaric"),
        (("density: 1.2", "density: 0"), "a finite number > 0 (g/cm3)"),
        (("dead_volume: 5000", "dead_volume: -1"), "a finite number >= 0 (mm3)"),
    ],
)
def test_a_study_that_asks_for_none_is_refused(tmp_path, change, said):
    assert change[0] in STUDY
    (tmp_path / "study.yaml").write_text(STUDY.replace(*change))
    with pytest.raises(StudyError) as refused:
        read(tmp_path / "study.yaml")
    assert said in str(refused.value)


def test_stops_are_close_and_exact():
    assert stops_to(0.03) == (0.0, 0.01, 0.02, 0.03)
    assert stops_to(0.025) == (0.0, 0.01, 0.02, 0.025)
    assert np.all(np.diff(stops_to(0.5)) <= 0.01 + 1e-12)
