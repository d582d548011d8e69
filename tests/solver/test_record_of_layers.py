"""A muscle with a sleeve as a record: written, read back, drawn."""

from types import SimpleNamespace

import h5py
import numpy as np
import pandas as pd
import pytest

from geometry.muscle import LayeredBraid, Muscle
from solver import record
from solver.models import MODELS
from solver.models.cylinder.curve import solve
from workflow.data import labelled, tidy
from workflow.data.records import Curve
from workflow.data.scene_data import SceneData
from workflow.data.states import Table
from workflow.figures import fig03, general
from workflow.figures.muscle_drawing import laid_open
from workflow.plan.plan import plan
from workflow.study.study import load


def sleeved() -> Muscle:
    braid = LayeredBraid(
        kinds=("embedded", "sleeve"),
        layer_diameters=(21.0, 27.0),
        leads=(140.0, 150.0),
        threads=(30, 40),
        senses=(1, 0),
        stiffness_shares=(1.0, 0.5),
    )
    return Muscle(inner_diameter=20, wall_thickness=2, length=300, braid=braid)


def test_it_is_read_as_it_was_written(make_case, tmp_path):
    case = make_case(model="cylinder", muscle=sleeved())
    path = tmp_path / "case.h5"
    record.write(path, case, solve(case))
    again, _ = record.read(path)
    assert again.key == case.key
    assert again.muscle.braid == case.muscle.braid
    with h5py.File(path) as file:
        found = file["parameters/muscle/braid"]
        assert [kind.decode() for kind in found["kinds"][()]] == ["embedded", "sleeve"]
        assert found["leads"].attrs["units"] == "mm"


@pytest.mark.parametrize("model", ["geometric", "geometric_layers"])
def test_a_model_that_knows_no_contact_says_nothing_of_it(make_case, tmp_path, model):
    braid = LayeredBraid(
        kinds=("sleeve",),
        layer_diameters=(24.4,),
        leads=(144.0,),
        threads=(60,),
        senses=(0,),
        stiffness_shares=(1.0,),
    )
    muscle = Muscle(inner_diameter=20, wall_thickness=2, length=300, braid=braid)
    case = make_case(model=model, muscle=muscle)
    record.write(tmp_path / "case.h5", case, MODELS[model].solve(case))
    states = record.read(tmp_path / "case.h5")[1].states
    assert np.isnan(states["contact_pressure"]).all()
    assert np.isfinite(states["force"]).all()


def test_it_is_drawn_from_its_table():
    table = fig03.table(SimpleNamespace(muscles={"one": sleeved()}))
    assert fig03._layered(table.iloc[0]) == sleeved().braid
    names = [body.name for body in laid_open(sleeved(), 90)]
    assert names == [
        "sleeve, clockwise",
        "sleeve, counter-clockwise",
        "tube",
        "layer, clockwise",
    ]
    fig03.draw(table)


STUDY = """\
materials:
  nbr: {c10: 0.345083, c01: 0.083805}
muscles:
  inside: {inner_diameter: 20, wall_thickness: 2, length: 300, layer_depths: [0.3, 0.9],
    threads: 60, lead: 144, thread_stiffness: 315, material: nbr}
  outside: {base: inside, layers: [{kind: sleeve, gap: 1}]}
scenes:
  curves: {path: isobaric, muscles: [outside], pressure: 0.3, contraction: [0, 0.1],
    models: [cylinder], quantities: contact_pressure,
    figure: {y: contact_pressure}}
"""


def of_study(tmp_path, text, *, muscle):
    """The curve of a study, the table and the dataset of it."""
    path = tmp_path / "study.yaml"
    path.write_text(text)
    study = load(path)
    planned = plan(study)
    found = [
        Curve(planned.cases[key].case, solve(planned.cases[key].case), (0.0, 0.1), place)
        for place, key in planned.scenes["curves"].items()
    ]
    return SceneData("curves", planned, found), Table.of(found, {muscle: study.muscles[muscle]})


def test_the_contact_pressure_is_in_the_dataset_where_there_is_a_sleeve(tmp_path):
    """With its unit, in the figure that shows it; other muscles' datasets have no such variable."""
    data, table = of_study(tmp_path, STUDY, muscle="outside")
    expected = data.curves[0].solution.states["contact_pressure"]
    assert expected.min() > 0.05
    found = labelled.tree(table)["isobaric"].contact_pressure
    assert found.attrs["units"] == "MPa"
    assert found.squeeze().values.tolist() == expected.tolist()
    tidy.write(table, tmp_path / "states.parquet")
    assert "contact_pressure" in pd.read_parquet(tmp_path / "states.parquet")
    rows = general.table(data)
    assert rows["contact_pressure [MPa]"].tolist() == expected.tolist()

    without = STUDY.replace("[outside]", "[inside]").replace("quantities: contact_pressure,", "")
    without = without.replace("{y: contact_pressure}", "{y: force}")
    _, table = of_study(tmp_path, without, muscle="inside")
    assert "contact_pressure" not in labelled.tree(table)["isobaric"]
    assert "contact_pressure" not in table.states
