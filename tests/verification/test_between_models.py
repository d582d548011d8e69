"""Where two models must agree: a nearly incompressible solid with sliding ends is a cylinder."""

import numpy as np
import pytest

from geometry.mesh_settings import SectionMesh
from geometry.muscle import Muscle
from solver.effects import Effects, ThreadLaw
from solver.load_path import LoadPath
from solver.numerics import Newton, Numerics
from solver.rubber.mooney_rivlin.law import MooneyRivlin

PATHS = {
    "isobaric": LoadPath(kind="isobaric", held=0.3, stops=(-0.05, 0.0, 0.1, 0.2)),
    "isometric": LoadPath(kind="isometric", held=0.1, stops=(0.1, 0.2, 0.3), zero_force=True),
    "isotonic": LoadPath(kind="isotonic", held=100.0, stops=(0.1, 0.2, 0.3)),
}


@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize("threads", ThreadLaw)
def test_sliding_solid_is_the_cylinder(make_case, solve_case, muscle, path, threads):
    short = Muscle(inner_diameter=20, wall_thickness=2, length=4, braid=muscle.braid)
    case = {
        "muscle": short,
        "rubber": MooneyRivlin(c10=0.345083, c01=0.083805, kappa=1e6),
        "path": PATHS[path],
        "effects": Effects(end="sliding", threads=threads),
    }
    mesh = Numerics(
        newton=Newton(tolerance=1e-11),
        section=SectionMesh(rows=(1, 2, 3), cap_step=0.25, body_step=0.025, growth=1),
    )
    solid = solve_case(make_case(model="solid", numerics=mesh, **case)).states
    cylinder = solve_case(make_case(model="cylinder", **case)).states
    size = {"force": 689.5, "pressure": 0.3, "contraction": 1}
    for name in ("inner_diameter_inflated", "thread_stretch_min", "thread_stretch_max"):
        np.testing.assert_allclose(solid[name], cylinder[name], rtol=1e-5, err_msg=name)
    np.testing.assert_allclose(solid["outer_diameter"], cylinder["outer_diameter"], rtol=1e-5)
    for name, scale in size.items():
        np.testing.assert_allclose(
            solid[name], cylinder[name], rtol=0, atol=1e-5 * scale, err_msg=name
        )
