"""The largest principal stretch of the rubber, by the singular values of F and between models."""

from dataclasses import replace

import numpy as np
import pytest

from geometry.mesh_settings import CellMesh, SectionMesh
from solver.effects import Effects
from solver.load_path import LoadPath
from solver.models.cylinder.mechanics import Cylinder, State
from solver.numerics import Numerics

NAME = "rubber_stretch_max"
PATH = LoadPath(kind="isobaric", held=0.1, stops=(-0.1, 0.0, 0.05))
MESHES = {
    "solid": Numerics(section=SectionMesh(rows=(2, 2, 2), cap_step=1, body_step=0.1, growth=1)),
    "membrane": Numerics(),
    "cell": Numerics(cell=CellMesh(body_size=0.5)),
}


@pytest.mark.parametrize("twist", [0.0, 0.05])
@pytest.mark.parametrize("lz", [0.8, 1.0, 1.3])
def test_twisted_tube_by_singular_values(make_case, bare_tube, twist, lz):
    tube = Cylinder(make_case(model="cylinder", muscle=bare_tube, effects=Effects(twist="free")))
    state = State(r=11.0, lz=lz, twist=twist, pressure=0.0, force=0.0, torque=0.0)
    largest = []
    for radius in tube.radii:
        hoop = np.sqrt(state.r**2 + (radius**2 - tube.inner**2) / lz) / radius
        surface = np.array([[hoop, hoop * radius * twist], [0, lz]])
        largest += [np.linalg.svd(surface)[1][0], 1 / (hoop * lz)]
    assert tube.rubber_stretch(state) == pytest.approx(max(largest), rel=1e-12)


@pytest.mark.parametrize("model", ["solid", "cell"])
def test_bare_tube_of_a_meshed_model_is_the_cylinder(make_case, solve_case, bare_tube, model):
    tube = replace(bare_tube, length=4.0)
    effects = Effects(end="sliding") if model == "solid" else Effects()
    found = {
        name: solve_case(
            make_case(
                model=name,
                muscle=tube,
                path=PATH,
                effects=effects,
                numerics=MESHES.get(name, Numerics()),
            )
        ).states[NAME]
        for name in ("cylinder", model)
    }
    np.testing.assert_allclose(found[model], found["cylinder"], rtol=0.01)
    assert found["cylinder"].min() > 1.1


@pytest.mark.parametrize("model", ["membrane", "solid"])
def test_far_from_the_caps_it_is_the_hoop_of_the_bore(make_case, solve_case, model):
    path = LoadPath(kind="isobaric", held=0.3, stops=(0.1, 0.2))
    states = solve_case(make_case(model=model, path=path)).states
    bore = states["inner_diameter_inflated"] / 20
    np.testing.assert_allclose(states[NAME], bore, rtol=0.01)


def test_without_rubber_there_is_none(make_case, solve_case):
    net = make_case(model="cylinder", effects=Effects(rubber="none"))
    assert np.isnan(solve_case(net).states[NAME]).all()
