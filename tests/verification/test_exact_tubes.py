"""The solid against exact solutions of thick rubber tubes in plane strain or at a given stretch.

A tube whose ends slide is a piece of an infinite one. The exact solutions are incompressible, so
the bulk modulus is 10^6 shear moduli: what it leaves is below the digits compared.
"""

import math

import numpy as np
import pytest

from geometry.mesh_settings import SectionMesh
from geometry.muscle import Muscle
from solver.case import Case
from solver.effects import Effects
from solver.load_path import LoadPath
from solver.numerics import Newton, Numerics
from solver.rubber.mooney_rivlin.law import MooneyRivlin

SLIDING = Effects(end="sliding")


def tube(inner: float, outer: float, c10: float, c01: float, stretch: float, pressure: float):
    """Keywords of a case: a tube 4 mm long at one stretch and one pressure."""
    return {
        "model": "solid",
        "muscle": Muscle(
            inner_diameter=2 * inner, wall_thickness=outer - inner, length=4, braid=None
        ),
        "rubber": MooneyRivlin(c10=c10, c01=c01, kappa=2e6 * (c10 + c01)),
        "effects": SLIDING,
        "path": LoadPath(kind="isometric", held=round(1 - stretch, 10), stops=(pressure,)),
        "fields_at": (pressure,),
    }


def even_mesh(refinement: int, rows: tuple[int, int, int], step: float, muscle: Muscle) -> Numerics:
    """Cells of nearly the same size everywhere, ``step`` mm long."""
    return Numerics(
        newton=Newton(tolerance=1e-11),
        section=SectionMesh(
            rows=rows,
            cap_step=step / muscle.wall_thickness,
            body_step=step / muscle.inner_diameter,
            growth=1,
            refinement=refinement,
        ),
    )


@pytest.fixture
def nbr_tube(make_case, solve_case):
    """Radius of the inner surface [mm] and force [N] of R 10/12 NBR; the volume's mean radius."""

    def solve(stretch: float, refinement: int) -> dict[str, float]:
        keywords = tube(10, 12, 0.345083, 0.083805, stretch, 0.05)
        mesh = even_mesh(refinement, (1, 1, 1), 1, keywords["muscle"])
        case: Case = make_case(**keywords, numerics=mesh)
        solution = solve_case(case)
        assert solution.status == "converged", solution.reason
        s = {name: values[0] for name, values in solution.states.items()}
        return {
            "inner radius": s["inner_diameter_inflated"] / 2,
            "outer radius": s["outer_diameter"] / 2,
            "mean radius": math.sqrt(s["volume"] / (math.pi * 4 * stretch)),
            "force": s["force"],
        }

    return solve


@pytest.mark.parametrize(
    ("stretch", "radius", "force"),
    [(1.0, 11.199271, -1.33429), (0.9, 11.701958, -42.01424), (0.8, 12.292304, -96.44634)],
)
def test_bare_tube_is_exact(nbr_tube, stretch, radius, force):
    found = nbr_tube(stretch, refinement=2)
    outer = math.sqrt(radius**2 + (12**2 - 10**2) / stretch)
    assert found["inner radius"] == pytest.approx(radius, abs=3e-6)
    assert found["outer radius"] == pytest.approx(outer, abs=3e-6)
    assert found["mean radius"] == pytest.approx(radius, abs=1e-6)
    assert found["force"] == pytest.approx(force, abs=3e-5)


def test_order_of_convergence(nbr_tube):
    coarse, medium, fine = (nbr_tube(0.8, m) for m in (1, 2, 4))
    order = {
        name: math.log2(abs(coarse[name] - medium[name]) / abs(medium[name] - fine[name]))
        for name in coarse
    }
    # displacements one order above their gradients, forces and volumes as the energy
    assert order["inner radius"] > 2.8, order
    assert order["outer radius"] > 2.8, order
    assert order["mean radius"] > 3.6, order
    assert order["force"] > 3.5, order


@pytest.fixture
def thick_tube(make_case, solve_case):
    """Solution of a thick tube on a mesh that is fine enough for its table."""

    def solve(**keywords):
        mesh = even_mesh(4, (1, 1, 2), 2, keywords["muscle"])
        solution = solve_case(make_case(**keywords, numerics=mesh))
        assert solution.status == "converged", solution.reason
        return solution

    return solve


def test_neo_hooke_thick_tube(thick_tube):
    """mu = 1000/3 MPa, R 8/16, 100 MPa: the table published with solids4foam."""
    solution = thick_tube(**tube(8, 16, 1000 / 6, 0, stretch=1, pressure=100))
    inner = solution.states["inner_diameter_inflated"][0] / 2 - 8
    outer = solution.states["outer_diameter"][0] / 2 - 16
    assert inner == pytest.approx(2.252601910, abs=3e-5)
    assert outer == pytest.approx(1.237048643, abs=3e-5)

    fields = solution.fields[0]
    at_inner = np.abs(fields["corners"][:, 0] - 8) < 1e-9
    radial, shear, _, hoop = fields["stress"][at_inner].T
    np.testing.assert_allclose(hoop, 244.5276753, rtol=0.005)
    np.testing.assert_allclose(radial, -100, rtol=0.005)
    np.testing.assert_allclose(shear, 0, atol=0.5)


def test_neo_hooke_stress_through_the_wall(thick_tube):
    """sigma_rr and sigma_tt at every corner, from the exact solution."""
    solution = thick_tube(**tube(8, 16, 1000 / 6, 0, stretch=1, pressure=100))
    mu, grown = 1000 / 3, (8 + 2.252601910) ** 2 - 8**2

    def antiderivative(r):  # of (sigma_tt - sigma_rr) / r = mu (r/R^2 - R^2/r^3)
        big = r**2 - grown
        return mu * (np.log(big) / 2 - np.log(r) - grown / (2 * r**2))

    fields = solution.fields[0]
    r = fields["corners"][:, 2]
    big = r**2 - grown
    radial = antiderivative(r) - antiderivative(np.sqrt(16**2 + grown))
    hoop = radial + mu * (r**2 / big - big / r**2)
    np.testing.assert_allclose(fields["stress"][:, 0], radial, atol=0.01 * 100)
    np.testing.assert_allclose(fields["stress"][:, 3], hoop, atol=0.01 * 244.5)


def test_mooney_rivlin_thick_tube(thick_tube):
    """80/20 MPa, R 7/18.625, 150 MPa."""
    solution = thick_tube(**tube(7, 18.625, 80, 20, stretch=1, pressure=150))
    inner = solution.states["inner_diameter_inflated"][0] / 2 - 7
    assert inner == pytest.approx(7.181871426, abs=1e-4)
