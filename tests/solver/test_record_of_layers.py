"""A muscle with a sleeve as a record: written, read back, drawn."""

from types import SimpleNamespace

import h5py

from geometry.muscle import LayeredBraid, Muscle
from solver import record
from solver.models.cylinder.curve import solve
from workflow.figures import fig03
from workflow.figures.muscle_drawing import laid_open


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
