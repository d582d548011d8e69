"""Every hand-written derivative of the FreeFEM models against central differences.

Also with the two ends of the thread law, slack and taut, in one state.
"""

import csv
from pathlib import Path

import pytest

from geometry.mesh_settings import CellMesh, SectionMesh
from geometry.muscle import LayeredBraid, Muscle
from solver.effects import Effects
from solver.friction import Friction
from solver.history import History
from solver.load_path import LoadPath
from solver.memory import Memory
from solver.numerics import Numerics

EDP = Path(__file__).parent / "edp"
CELL = Numerics(cell=CellMesh(thread_size=2, body_size=0.5))
COARSE = Numerics(section=SectionMesh(cap_step=2, body_step=4, growth=2))


@pytest.fixture
def errors(run_program, monkeypatch):
    """Relative errors by name, and facts about the state, of one model at one random state."""
    monkeypatch.setenv("FF_INCLUDEPATH", str(EDP))

    def run(case, **state):
        program = EDP / f"finite_differences_{case.model}.edp"
        with (run_program(case, program, **state) / "errors.csv").open() as file:
            return {row["name"]: float(row["value"]) for row in csv.DictReader(file)}

    return run


STATES = [
    pytest.param({"contraction": 0.0, "pressure": 0.3}, id="initial length"),
    pytest.param({"contraction": 0.15, "pressure": 0.6}, id="contracted"),
    pytest.param({"contraction": -0.05, "pressure": 0.0}, id="drawn out"),
]


def check(found, *, tolerance: float) -> None:
    facts = {n: found.pop(n) for n in ("margin", "thread_stretch_min", "thread_stretch_max")}
    assert facts["margin"] > 0.1, "the random state is valid"
    wrong = {name: error for name, error in found.items() if not error < tolerance}
    assert not wrong, f"derivatives that differ from differences: {wrong}"


@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize("threads", ["tension_only", "two_way"])
@pytest.mark.parametrize("wall", ["integrated", "one_radius"])
def test_membrane(make_case, errors, wall, threads, state):
    found = errors(
        make_case(model="membrane", effects=Effects(threads=threads, wall=wall)),
        amplitude=0.05,
        multiplier=0.0,
        **state,
    )
    check(found, tolerance=1e-6)


@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize("threads", ["tension_only", "two_way"])
@pytest.mark.parametrize("end", ["clamp", "butt", "sliding"])
def test_solid(make_case, errors, end, threads, state):
    case = make_case(model="solid", effects=Effects(end=end, threads=threads), numerics=COARSE)
    check(errors(case, amplitude=0.02, multiplier=0.1, **state), tolerance=1e-6)


@pytest.mark.parametrize("state", STATES)
def test_solid_that_keeps_its_volume(make_case, errors, state):
    effects = Effects(volume="incompressible")
    case = make_case(model="solid", effects=effects, numerics=COARSE)
    check(errors(case, amplitude=0.02, multiplier=0.1, **state), tolerance=1e-6)


@pytest.mark.parametrize("end", ["clamp", "butt", "sliding"])
def test_bare_solid(make_case, bare_tube, errors, end):
    case = make_case(model="solid", muscle=bare_tube, effects=Effects(end=end), numerics=COARSE)
    found = errors(case, amplitude=0.02, multiplier=0.1, contraction=0.1, pressure=0.05)
    check(found, tolerance=1e-6)


def test_bare_membrane(make_case, bare_tube, errors):
    case = make_case(model="membrane", muscle=bare_tube)
    found = errors(case, amplitude=0.02, multiplier=0.0, contraction=0.1, pressure=0.05)
    check(found, tolerance=1e-6)


@pytest.mark.parametrize("threads", ["tension_only", "two_way"])
@pytest.mark.parametrize("layers", ["discrete", "smeared", "wire"])
@pytest.mark.parametrize("twist", ["held", "free"])
def test_cell(make_case, errors, twist, layers, threads):
    effects = Effects(threads=threads, layers=layers, twist=twist)
    case = make_case(model="cell", effects=effects, numerics=CELL)
    found = errors(case, amplitude=0.02, multiplier=0.1, contraction=0.1, pressure=0.3)
    check(found, tolerance=1e-6)


def test_bare_cell(make_case, bare_tube, errors):
    case = make_case(model="cell", muscle=bare_tube, numerics=CELL)
    found = errors(case, amplitude=0.02, multiplier=0.1, contraction=0.1, pressure=0.05)
    check(found, tolerance=1e-6)


@pytest.mark.parametrize(("model", "multiplier"), [("membrane", 0.0), ("solid", 0.05)])
def test_sleeve_that_hangs_from_its_collar(make_case, errors, model, multiplier):
    """Off the wall near the cap, on it elsewhere: what the gap gives way by is in the tangent."""
    braid = LayeredBraid(
        kinds=("sleeve",),
        layer_diameters=(26.0,),
        leads=(150.0,),
        threads=(40,),
        senses=(0,),
        stiffness_shares=(1.0,),
        crimp_radii=(12.8,),
    )
    muscle = Muscle(inner_diameter=20, wall_thickness=2, length=100, braid=braid)
    case = make_case(model=model, muscle=muscle, numerics=COARSE)
    state = {"amplitude": 0.02, "contraction": -0.02, "pressure": 0.3}
    found = errors(case, multiplier=multiplier, **state)
    assert found["thread_stretch_max"] > 1.005
    check(found, tolerance=1e-5)


@pytest.mark.parametrize("model", ["membrane", "solid"])
def test_sleeve_around_one_layer_in_the_wall(make_case, errors, model):
    """A taut sleeve, narrower than the tube, and under it a layer of two families."""
    braid = LayeredBraid(
        kinds=("embedded", "sleeve"),
        layer_diameters=(21.0, 23.8),
        leads=(140.0, 150.0),
        threads=(30, 40),
        senses=(0, 0),
        stiffness_shares=(1.0, 0.5),
    )
    muscle = Muscle(inner_diameter=20, wall_thickness=2, length=300, braid=braid)
    case = make_case(model=model, muscle=muscle, numerics=COARSE)
    found = errors(
        case,
        amplitude=0.02,
        multiplier=0.1 if model == "solid" else 0.0,
        contraction=-0.02,
        pressure=0.3,
    )
    assert found["thread_stretch_max"] > 1.005
    check(found, tolerance=1e-6)


def in_time(make_case, model, **given):
    """A case along a history: a tube in a sleeve that is narrower, and so taut."""
    braid = LayeredBraid(
        kinds=("sleeve",),
        layer_diameters=(23.0,),
        leads=(150.0,),
        threads=(40,),
        senses=(0,),
        stiffness_shares=(0.5,),
    )
    muscle = Muscle(inner_diameter=20, wall_thickness=2, length=100, braid=braid)
    history = History(times=(0.0, 1.0))
    path = LoadPath(kind="isobaric", held=0.3, stops=(0.0, 0.1), history=history)
    return make_case(model=model, muscle=muscle, path=path, numerics=COARSE, **given)


@pytest.mark.parametrize("model", ["membrane", "solid"])
def test_crossings_that_do_not_slip(make_case, errors, model):
    """They are elastic then; of those that slip the tangent leaves out how the limit changes."""
    friction = Friction(coefficient=2, contact=10, slip=0.1)
    state = {"amplitude": 0.001, "contraction": -0.04, "pressure": 0.3}
    multiplier = 0.1 if model == "solid" else 0.0
    found = errors(in_time(make_case, model, friction=friction), multiplier=multiplier, **state)
    assert 0.1 < found.pop("borne") < 0.95
    check(found, tolerance=1e-6)


@pytest.mark.parametrize(
    ("model", "volume"),
    [("membrane", "compressible"), ("solid", "compressible"), ("solid", "incompressible")],
)
def test_branches_of_a_memory(make_case, errors, model, volume):
    """In a step from another state; what they add to the energy is not in ``energy``."""
    memory = Memory.flat(0.12, 1e-3, 1e3)
    state = {"amplitude": 0.02, "contraction": 0.15, "pressure": 0.3}
    multiplier = 0.1 if model == "solid" else 0.0
    case = in_time(make_case, model, memory=memory, effects=Effects(volume=volume))
    found = errors(case, multiplier=multiplier, step=0.1, **state)
    for name in ("force", "cap_force"):
        assert found.pop(name) > 1e-3
    check(found, tolerance=1e-6)
