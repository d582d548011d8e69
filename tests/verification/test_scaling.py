"""A muscle scaled by a factor, its EA by the square of it: forces scale by the square too."""

from dataclasses import replace

import numpy as np
import pytest

from geometry.muscle import Braid, Muscle
from solver.load_path import LoadPath
from solver.material import Thread
from solver.numerics import Clamp, Numerics, Slack

EXACT = {"cylinder": 1e-9, "membrane": 1e-9, "solid": 1e-6}  # share of the largest force
PATHS = {
    "isobaric": LoadPath(kind="isobaric", held=0.3, stops=(0.0, 0.1, 0.2)),
    "low pressure": LoadPath(kind="isobaric", held=0.05, stops=(0.0, 0.02)),
    "isometric": LoadPath(kind="isometric", held=0.1, stops=(0.1, 0.2, 0.3), zero_force=True),
    "isotonic": LoadPath(kind="isotonic", held=100.0, stops=(0.1, 0.2, 0.3)),
}


def scaled(muscle: Muscle, factor: float, **changes: float) -> Muscle:
    """All lengths of a muscle by a factor."""
    braid = muscle.braid
    sizes = ("inner_diameter", "wall_thickness", "length", "cap_length")
    lengths = {name: changes.get(name, getattr(muscle, name)) * factor for name in sizes}
    diameters = tuple(d * factor for d in braid.layer_diameters)
    return Muscle(
        **lengths,
        braid=Braid(lead=braid.lead * factor, threads=braid.threads, layer_diameters=diameters),
    )


@pytest.fixture
def twins(make_case, solve_case, muscle):
    """States of a model at full size and scaled, forces divided by the square of the factor."""

    def states(model, path, stiffness, factor):
        found = []
        for f in (1.0, factor):
            load = f**2 if path.kind == "isotonic" else 1
            case = make_case(
                model=model,
                muscle=scaled(muscle, f, length=100.0),
                thread=Thread(stiffness=stiffness * f**2),
                path=replace(path, held=path.held * load),
            )
            solved = solve_case(case).states
            found.append({**solved, "force": solved["force"] / f**2})
        return found

    return states


@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize("factor", [0.1, 0.01])
@pytest.mark.parametrize("model", EXACT)
def test_forces_scale_with_the_section(twins, model, factor, path):
    full, small = twins(model, PATHS[path], 315.0, factor)
    largest = np.max(np.abs(full["force"]))
    assert np.isfinite(largest)
    for name, size in {"force": largest, "pressure": 0.3, "contraction": 1.0}.items():
        np.testing.assert_allclose(
            small[name], full[name], rtol=0, atol=EXACT[model] * size, err_msg=name
        )


@pytest.mark.parametrize("stiffness", [12.0, 100.0, 3150.0])
@pytest.mark.parametrize("model", EXACT)
def test_forces_scale_with_soft_and_stiff_threads(twins, model, stiffness):
    path = LoadPath(kind="isobaric", held=0.3, stops=(0.0, 0.1))
    for factor in (0.1, 0.01):
        full, small = (s["force"] for s in twins(model, path, stiffness, factor))
        assert np.isfinite(full[0])
        np.testing.assert_array_equal(np.isnan(small), np.isnan(full))
        error = np.nanmax(np.abs(small - full)) / np.nanmax(np.abs(full))
        assert error <= EXACT[model]


def test_what_was_given_stays_as_given(make_case, muscle):
    given = Numerics(clamp=Clamp(thread_stiffness=300), slack=Slack(stiffness=100))
    small = make_case(model="solid", muscle=scaled(muscle, 0.1), numerics=given).numerics
    assert small.clamp.thread_stiffness == 300
    assert small.slack.stiffness == 100
    assert small.clamp.inner_stiffness == pytest.approx(200, rel=1e-15)  # left out: 10 times


def test_defaults_stand_in_the_case(make_case, muscle):
    of_paper = make_case(model="solid").as_dict()["numerics"]
    assert of_paper["clamp"] == {"ramp": 1, "thread_stiffness": 200, "inner_stiffness": 20}
    assert of_paper["slack"] == {"width": 1e-3, "stiffness": 315}
    wide = scaled(muscle, 2.0)
    of_wide = make_case(model="solid", muscle=wide).as_dict()["numerics"]
    assert of_wide["clamp"] == {"ramp": 1, "thread_stiffness": 100, "inner_stiffness": 10}
    assert of_wide["slack"] == {"width": 1e-3, "stiffness": 1260}
