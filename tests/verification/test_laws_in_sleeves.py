"""Rubbers of every law in a sleeve with a gap: derivatives, work, models among each other.

And what of that no model has is refused with its reason.
"""

import csv
import math
from pathlib import Path

import numpy as np
import pytest

from geometry.mesh_settings import SectionMesh
from geometry.muscle import LayeredBraid, Muscle
from solver import rubber
from solver.effects import Effects
from solver.load_path import LoadPath
from solver.material import Thread
from solver.models.cylinder.mechanics import Cylinder
from solver.numerics import Numerics
from solver.refusal import UnsolvableCase

EDP = Path(__file__).parents[1] / "solver" / "edp"
COARSE = Numerics(section=SectionMesh(cap_step=2, body_step=4, growth=2))
LAWS = {  # all of 0.44 MPa at rest, as the latex of test_sleeves.py
    "yeoh": {"c1": 0.22, "c2": -0.004, "c3": 0.0004},
    "rivlin": {"c10": 0.2, "c01": 0.02, "c11": 0.002, "c20": -0.002},
    "ogden": {"convention": "textbook", "mu": [0.6, 0.0004, -0.049], "alpha": [1.3, 5, -2]},
    "gent": {"mu": 0.44, "jm": 40},
    "arruda_boyce": {"mu": 0.42, "lambda_m": 3.5},
}


def muscle(senses=(0,), gap=1.5) -> Muscle:
    """The bladder of test_sleeves.py in sleeves of a gap, 30 degrees at theirs."""
    radius, count = 6.35 + gap, len(senses)
    braid = LayeredBraid(
        kinds=("sleeve",) * count,
        layer_diameters=(2 * radius,) * count,
        leads=(2 * math.pi * radius / math.tan(math.radians(30)),) * count,
        threads=(30,) * count,
        senses=senses,
        stiffness_shares=(1.0,) * count,
    )
    return Muscle(inner_diameter=9.5, wall_thickness=1.6, length=200, braid=braid, cap_length=6.4)


@pytest.fixture
def case_of(make_case):
    def made(law, **more):
        values = {"muscle": muscle(), "thread": Thread(stiffness=400), "model": "cylinder"}
        values["path"] = LoadPath(kind="isobaric", held=0.3, stops=(0.0, 0.1))
        return make_case(rubber=rubber.from_dict({"law": law} | LAWS[law]), **(values | more))

    return made


@pytest.mark.parametrize("law", LAWS)
def test_models_agree(solve_case, case_of, law):
    """Ends take what they take of the latex, 5 to 10 %; membrane and solid are near each other."""
    found = {}
    for model in ("cylinder", "membrane", "solid"):
        solution = solve_case(case_of(law, model=model))
        assert solution.status == "converged", (model, solution.reason)
        found[model] = solution.states
    blocked = found["cylinder"]["force"][0]
    assert found["membrane"]["force"] == pytest.approx(found["solid"]["force"], abs=0.01 * blocked)
    assert found["membrane"]["force"] == pytest.approx(
        found["cylinder"]["force"], abs=0.08 * blocked
    )
    assert found["solid"]["contact_pressure"] == pytest.approx(
        found["cylinder"]["contact_pressure"], rel=0.04
    )
    assert found["solid"]["min_det_f"].min() > 0.5


@pytest.mark.parametrize("model", ["membrane", "solid"])
@pytest.mark.parametrize("law", ["ogden", "gent"])
def test_derivatives(case_of, run_program, monkeypatch, law, model):
    """Of a taut sleeve, against central differences at a random state."""
    monkeypatch.setenv("FF_INCLUDEPATH", str(EDP))
    case = case_of(law, model=model, numerics=COARSE, muscle=muscle(gap=-0.2))
    state = {"contraction": -0.02, "pressure": 0.1, "amplitude": 0.02}
    state["multiplier"] = 0.0 if model == "membrane" else 0.05
    program = EDP / f"finite_differences_{model}.edp"
    with (run_program(case, program, **state) / "errors.csv").open() as file:
        found = {row["name"]: float(row["value"]) for row in csv.DictReader(file)}
    assert found.pop("margin") > 0.1
    assert found["thread_stretch_max"] > 1.005
    errors = {name: error for name, error in found.items() if "thread_stretch" not in name}
    assert max(errors.values()) < 1e-6, errors


@pytest.mark.parametrize("law", LAWS)
def test_one_family_twists_by_its_energy(case_of, law):
    """Pressure, force and torque are slopes of the energy."""
    case = case_of(law, muscle=muscle(senses=(1,), gap=0.0), effects=Effects(twist="free"))
    tube, at, step = Cylinder(case), np.array([1.3, 0.97, 0.02]), 1e-6

    def energy(k: int, moved: float) -> float:
        x = at.copy()
        x[k] += moved
        return tube.energy(tube.state(x))

    state = tube.state(at)
    assert tube.thread_stretch(state).max() > 1.01
    by = [(energy(k, step) - energy(k, -step)) / (2 * step) for k in range(3)]
    push = 2 * math.pi * state.r * state.lz * state.pressure
    assert push * tube.inner == pytest.approx(by[0], rel=1e-6)
    assert state.force == pytest.approx(by[1] - state.pressure * math.pi * state.r**2, rel=1e-6)
    assert state.torque == pytest.approx(by[2] * tube.inner, rel=1e-6)


@pytest.mark.parametrize(
    ("law", "more", "said"),
    [
        ("ogden", {"model": "cell"}, "a cell of the braid repeats only where two embedded"),
        ("yeoh", {"model": "cell"}, "a cell of the braid repeats only where two embedded"),
        ("gent", {"model": "membrane", "muscle": muscle((1,))}, "a muscle twists, and no plane"),
        ("gent", {"model": "solid", "muscle": muscle((1, 1))}, "a muscle twists, and no plane"),
        ("gent", {"effects": Effects(threads="two_way")}, "a sleeve lies on the wall, and cannot"),
        ("gent", {"effects": Effects(wall="one_radius")}, "integrated, where layers have radii"),
    ],
)
def test_what_no_model_has_is_refused(case_of, law, more, said):
    with pytest.raises(UnsolvableCase, match=said):
        case_of(law, **more)
