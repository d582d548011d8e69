"""What stands in Python and in FreeFEM is the same in both: flags, labels, controls, columns."""

import csv
import re
from pathlib import Path

import pytest

from geometry.labels import Boundary
from geometry.mesh_settings import CellMesh
from solver import solve
from solver.effects import Effects, End, ThreadLaw
from solver.load_path import Control, Waypoint
from solver.models import MODELS
from solver.numerics import Numerics
from solver.program import composition, flags, includes
from solver.record import SLEEVED, VARIABLES
from solver.rubber import default

SOLVER = Path(solve.__file__).parent
SHARED = [path for path in SOLVER.rglob("*.?dp") if SOLVER / "rubber" not in path.parents]
FILES = {path.name: path for path in [*SHARED, *default().includes()[0].glob("*.idp")]}
REQUIRED = re.compile(r'^[^/\n]*require(?:Real|Int|String)\("-(\w+)"\)', re.M)
INCLUDE = re.compile(r'^\s*include\s+"([\w.]+)"', re.M)
MESHED = tuple(name for name, model in MODELS.items() if model.mesh)
COARSE = Numerics(cell=CellMesh(thread_size=2, body_size=0.8))


def sources(name: str, composed: str) -> str:
    """A program with all it includes; ``composed`` stands for composition.idp."""
    text = composed if name == "composition.idp" else FILES[name].read_text()
    return text + "".join(sources(included, composed) for included in INCLUDE.findall(text))


EFFECTS = [
    pytest.param(model, Effects(end=end, threads=threads), id=f"{model} {end} {threads}")
    for model in MESHED
    for end in End
    for threads in ThreadLaw
] + [
    pytest.param("membrane", Effects(wall="one_radius"), id="membrane at one radius"),
    pytest.param("solid", Effects(volume="incompressible"), id="solid that keeps its volume"),
]


def test_no_two_files_have_one_name():
    """Includes are found by their name alone, in several folders."""
    assert len(FILES) == len(SHARED) + len(list(default().includes()[0].glob("*.idp")))


@pytest.mark.parametrize(("model", "effects"), EFFECTS)
@pytest.mark.parametrize("braided", [True, False])
def test_flags_are_those_that_are_read(make_case, bare_tube, tmp_path, model, effects, braided):
    muscle = {} if braided else {"muscle": bare_tube}
    case = make_case(model=model, effects=effects, **muscle)
    read = REQUIRED.findall(sources(f"{model}.edp", composition(case)))
    assert len(read) == len(set(read)), "a flag is read twice"
    assert set(flags(case, tmp_path / "mesh")) == set(read)


@pytest.mark.parametrize(("model", "effects"), EFFECTS)
def test_every_effect_has_its_include(make_case, model, effects):
    case = make_case(model=model, effects=effects)
    files = INCLUDE.findall(composition(case))
    expected = [f"threads_{effects.threads}.idp"]
    expected += [f"membrane_wall_{effects.wall}.idp"] if model == "membrane" else []
    solid = [f"ends_{effects.end}.idp", f"solid_{effects.volume}.idp"]
    expected += solid if model == "solid" else []
    expected += [f"cell_layers_{effects.layers}.idp"] if model == "cell" else []
    assert files == expected
    assert all(any((folder / file).exists() for folder in includes(case)) for file in files)


def test_integers_and_decimals_keep_their_kind(make_case, tmp_path):
    """FreeFEM reads them by atoi and atof; a count must not arrive as 2.0."""
    given = flags(make_case(model="solid"), tmp_path)
    text = FILES["parameters.idp"].read_text()
    counts = set(re.findall(r'requireInt\("-(\w+)"\)', text))
    words = set(re.findall(r'requireString\("-(\w+)"\)', text))
    assert counts <= {name for name, value in given.items() if isinstance(value, int)}
    assert {name for name, value in given.items() if isinstance(value, str)} == words


def test_labels():
    found = dict(re.findall(r"^int label(\w+) = (\d+);", FILES["labels.idp"].read_text(), re.M))
    assert found == {b.name.title().replace("_", ""): str(int(b)) for b in Boundary}


def test_every_label_in_use_is_defined():
    text = "".join(path.read_text() for path in FILES.values())
    used = set(re.findall(r"\blabel[A-Z]\w*", text))
    defined = set(re.findall(r"int (label\w+) = \d+;", FILES["labels.idp"].read_text()))
    assert used == defined


def test_controls():
    text = FILES["newton.idp"].read_text()
    found = {name: int(number) for name, number in re.findall(r"\bby([A-Z]\w+) = (\d)", text)}
    assert {control.name.title(): int(control) for control in Control}.items() <= found.items()
    assert len(set(found.values())) == len(found), "two controls have one number"


@pytest.mark.parametrize("model", MESHED)
def test_columns_are_the_variables(run_program, make_case, model):
    """Each column of states.csv has a place in the record, and each place but one a column."""
    way = [Waypoint(Control.CONTRACTION, 0.0, Control.PRESSURE, 0.1, stop=0)]
    with (
        run_program(make_case(model=model, numerics=COARSE), way=way) / "states.csv"
    ).open() as file:
        header, row = csv.reader(file)
    assert len(header) == len(set(header)) == len(row)
    derived = {"equivalent_diameter", "torque"}
    assert set(header) - {"waypoint"} == (VARIABLES.keys() | SLEEVED.keys()) - derived


@pytest.mark.parametrize("model", ["geometric", "cylinder", *MESHED])
def test_each_model_says_which_variables_it_has(solve_case, make_case, model):
    """A variable of the record is NaN in a converged state only if the model has none."""
    absent = {
        "geometric": VARIABLES.keys()
        - {"contraction", "pressure", "force", "inner_diameter_inflated", "equivalent_diameter"},
        "cylinder": {
            "bulge",
            "unstable_modes",
            "residual",
            "iterations",
            "cutbacks",
        },
        "membrane": {"torque"},
        "solid": {"torque"},
        "cell": {"torque"},
    }
    states = solve_case(make_case(model=model, numerics=COARSE)).states
    assert {name for name in VARIABLES if states[name][0] != states[name][0]} == absent[model]
