"""What a stable computation must not depend on: steps, way, direction, units, rounding, mesh.

On small meshes, for the membrane and for the solid with its clamp.
"""

import json
import math

import numpy as np
import pytest

from geometry.mesh_settings import MeridianMesh, SectionMesh
from geometry.muscle import Muscle
from solver.case import Case
from solver.effects import Effects
from solver.load_path import Control, LoadPath, Waypoint
from solver.numerics import Newton, Numerics

MODELS = ("membrane", "solid")
COARSE = SectionMesh(cap_step=2.0, growth=2.0, body_step=4.0)
TIGHT = Numerics(newton=Newton(tolerance=1e-11), section=COARSE)
AREA = math.pi * 10**2  # of the cap, mm2


@pytest.fixture
def solve(make_case, solve_case):
    """States of a case that must converge."""

    def states(**keywords):
        solution = solve_case(make_case(**{"numerics": TIGHT} | keywords))
        assert solution.status == "converged", solution.reason
        return solution.states

    return states


def isobaric(*stops: float, pressure: float = 0.3) -> LoadPath:
    return LoadPath(kind="isobaric", held=pressure, stops=stops)


# --- steps and way --------------------------------------------------------------------------------


@pytest.mark.parametrize("model", MODELS)
def test_one_step_or_fifty(solve, model):
    one = solve(model=model, path=isobaric(0.2))
    fifty = solve(model=model, path=isobaric(*(round(0.004 * k, 4) for k in range(1, 51))))
    for name in ("force", "inner_diameter_inflated", "volume", "energy"):
        assert fifty[name][-1] == pytest.approx(one[name][0], rel=1e-8), name


def loop(*targets: tuple[Control, float, Control, float]) -> list[Waypoint]:
    return [Waypoint(*target, stop=k) for k, target in enumerate(targets)]


@pytest.mark.parametrize("model", MODELS)
def test_there_and_back(walk, make_case, model):
    """Up in pressure, short, long, short again, down in pressure: each state returns."""
    p, eps = Control.PRESSURE, Control.CONTRACTION
    way = loop(
        (eps, 0.0, p, 0.0),
        (eps, 0.0, p, 0.1),
        (eps, 0.0, p, 0.3),
        (p, 0.3, eps, 0.25),
        (p, 0.3, eps, -0.05),
        (p, 0.3, eps, 0.0),
        (eps, 0.0, p, 0.6),
        (eps, 0.0, p, 0.1),
        (eps, 0.0, p, 0.0),
    )
    rows = walk(make_case(model=model, numerics=TIGHT), way)
    assert len(rows) == len(way)
    for first, again in ((2, 5), (1, 7), (0, 8)):
        for name in ("force", "inner_diameter_inflated", "volume", "energy"):
            assert rows[again][name] == pytest.approx(rows[first][name], rel=1e-8), name


@pytest.mark.parametrize("model", MODELS)
def test_every_kind_of_path_meets_in_one_state(solve, model):
    """Descending in pressure at 10 %, shortening at 0.3 MPa, inflating under the same load."""
    short = solve(model=model, path=isobaric(0.05, 0.1))
    held = solve(model=model, path=LoadPath(kind="isometric", held=0.1, stops=(0.2, 0.3, 0.4)))
    force = short["force"][1]
    loaded = solve(model=model, path=LoadPath(kind="isotonic", held=force, stops=(0.2, 0.3)))
    assert held["pressure"][1] == pytest.approx(0.3, rel=1e-12)
    assert held["force"][1] == pytest.approx(force, rel=1e-6)
    assert loaded["force"][1] == pytest.approx(force, rel=1e-9)
    assert loaded["contraction"][1] == pytest.approx(0.1, rel=1e-6)
    for name in ("inner_diameter_inflated", "outer_diameter", "volume", "energy"):
        assert held[name][1] == pytest.approx(short[name][1], rel=1e-6), name
        assert loaded[name][1] == pytest.approx(short[name][1], rel=1e-6), name


# --- rounding -------------------------------------------------------------------------------------


def numbers(values: dict, path: tuple = ()) -> list[tuple]:
    """Keys of every real number in nested mappings and lists; counts are not among them."""
    found = []
    for key, value in values.items() if isinstance(values, dict) else enumerate(values):
        if isinstance(value, dict | list | tuple):
            found += numbers(value, (*path, key))
        elif isinstance(value, float) and value != 0:
            found.append((*path, key))
    return found


def scaled(values: dict, path: tuple, factor: float) -> dict:
    """A copy with one number multiplied."""
    copy = json.loads(json.dumps(values))
    entry = copy
    for key in path[:-1]:
        entry = entry[key]
    entry[path[-1]] *= factor
    return copy


@pytest.mark.parametrize("model", MODELS)
def test_perturbed_parameters(make_case, solve_case, model):
    """1e-8 more or less of every number of a case moves the force by less than 1e-5 of it."""
    muscle = Muscle.from_dict(as_floats(make_case().muscle.as_dict()))
    case = make_case(model=model, muscle=muscle, numerics=TIGHT)
    force = solve_case(case).states["force"][0]
    values = json.loads(json.dumps(as_floats(case.as_dict())))
    paths = numbers(values)
    assert len(paths) > 12
    signs = np.random.default_rng(0).choice([-1, 1], size=(5, len(paths)))
    for row in signs:
        near = values
        for path, sign in zip(paths, row, strict=True):
            near = scaled(near, path, 1 + sign * 1e-8)
        moved = abs(solve_case(Case.from_dict(near)).states["force"][0] / force - 1)
        assert 0 < moved < 1e-5


def as_floats(values):
    """Real numbers as floats, so that they are told from counts by their type."""
    real = {"inner_diameter", "wall_thickness", "length", "cap_length", "lead", "stiffness"}
    if isinstance(values, dict):
        return {
            k: float(v) if k in real and not isinstance(v, dict) else as_floats(v)
            for k, v in values.items()
        }
    return values


# --- units ----------------------------------------------------------------------------------------

PATHS = {
    "isobaric": {"kind": "isobaric", "held": "stress", "stops": "1"},
    "isometric": {"kind": "isometric", "held": "1", "stops": "stress"},
    "isotonic": {"kind": "isotonic", "held": "force", "stops": "stress"},
}
VALUES = {
    "isobaric": (0.3, (0.0, 0.1, 0.2)),
    "isometric": (0.1, (0.15, 0.2, 0.3)),
    "isotonic": (100.0, (0.0, 0.2, 0.3)),
}
UNIT_OF_RESULT = {
    "force": "force",
    "pressure": "stress",
    "contraction": "1",
    "inner_diameter_inflated": "length",
    "outer_diameter": "length",
    "volume": "volume",
    "energy": "energy",
    "min_det_f": "1",
    "thread_stretch_max": "1",
    "stiffness": "line load",
}


@pytest.fixture
def in_units(make_case, solve_case):
    """States of the normal muscle in units ``length`` and ``stress`` times larger."""

    def states(model: str, kind: str, length: float, stress: float):
        unit = units(length, stress)
        case = make_case(model=model, numerics=TIGHT).as_dict()
        muscle = case["muscle"]
        for name in muscle.keys() - {"braid"}:
            muscle[name] *= length
        muscle["braid"]["lead"] *= length
        muscle["braid"]["layer_diameters"] = [
            d * length for d in muscle["braid"]["layer_diameters"]
        ]
        case["rubber"] = {name: value * stress for name, value in case["rubber"].items()}
        case["thread"]["stiffness"] *= unit["force"]
        case["numerics"]["slack"]["stiffness"] *= unit["force"]
        if "clamp" in case["numerics"]:
            clamp = case["numerics"]["clamp"]
            clamp["thread_stiffness"] *= stress / length
            clamp["inner_stiffness"] *= stress / length
        held, stops = VALUES[kind]
        case["path"] = {
            "kind": kind,
            "held": held * unit[PATHS[kind]["held"]],
            "stops": [value * unit[PATHS[kind]["stops"]] for value in stops],
        }
        solution = solve_case(Case.from_dict(case))
        assert solution.status == "converged", solution.reason
        return solution.states

    return states


def units(length: float, stress: float) -> dict[str, float]:
    force = stress * length**2
    return {
        "1": 1.0,
        "length": length,
        "volume": length**3,
        "stress": stress,
        "force": force,
        "energy": force * length,
        "line load": force / length,
    }


@pytest.mark.parametrize("kind", PATHS)
@pytest.mark.parametrize(("length", "stress"), [(1e3, 1.0), (1e-3, 1.0), (1.0, 1e6), (1.0, 1e-6)])
@pytest.mark.parametrize("model", ["cylinder", *MODELS])
def test_no_hidden_unit(in_units, model, kind, length, stress):
    """In other units the same muscle has the same states: there is no absolute tolerance."""
    expected, found = in_units(model, kind, 1.0, 1.0), in_units(model, kind, length, stress)
    unit = units(length, stress)
    for name in ("iterations", "cutbacks"):
        np.testing.assert_array_equal(found[name], expected[name], err_msg=name)
    for name, dimension in UNIT_OF_RESULT.items():
        values = expected[name]
        np.testing.assert_allclose(
            found[name] / unit[dimension],
            values,
            rtol=1e-6,
            atol=1e-6 * np.nanmax(np.abs(values)),
            err_msg=name,
        )


# --- mesh -----------------------------------------------------------------------------------------


def test_membrane_converges_with_fourth_order(solve):
    force = {}
    for m in (1, 2, 4):
        mesh = Numerics(newton=TIGHT.newton, meridian=MeridianMesh(refinement=m))
        force[m] = solve(model="membrane", path=isobaric(0.1), numerics=mesh)["force"][0]
    order = math.log2(abs(force[1] - force[2]) / abs(force[2] - force[4]))
    assert order > 3.5
    assert abs(force[1] - force[4]) < 1e-5 * 672


# --- past the largest pressure --------------------------------------------------------------------


def test_bare_tube_under_volume_control(walk, make_case, bare_tube, nbr):
    """At stretch 1 the pressure of a bare tube tends to 2 (C10 + C01) ln(R_o/R_i) from below."""
    case = make_case(model="solid", muscle=bare_tube, effects=Effects(end="sliding"))
    rest = AREA * bare_tube.length
    growths = (1.2, 1.5, 2, 3, 4, 5, 6)  # of the inner radius
    way = loop(*((Control.CONTRACTION, 0.0, Control.VOLUME, g**2 * rest) for g in growths))
    rows = walk(case, way)
    assert len(rows) == len(growths)
    limit = 2 * (nbr.c10 + nbr.c01) * math.log(12 / 10)
    assert limit == pytest.approx(0.15639, abs=1e-5)
    pressures = np.array([row["pressure"] for row in rows])
    assert np.all(np.diff(pressures) > 0), "an asymptote, no fold"
    assert pressures[2] / limit == pytest.approx(0.92, abs=0.005)  # r_i = 20 mm
    assert pressures[4] / limit == pytest.approx(0.994, abs=0.0005)  # r_i = 40 mm
    assert pressures[6] == pytest.approx(limit, rel=0.01)
    assert rows[6]["inner_diameter_inflated"] == pytest.approx(120, rel=1e-4)
