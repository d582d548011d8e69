"""The whole muscle: volumes, threads on their helices, and a STEP file that reads back."""

import math
import re

import gmsh
import numpy as np
import pytest

from geometry import whole
from geometry.muscle import Braid, Muscle, UnbuildableMuscle


def braided(**changes):
    values = {"inner_diameter": 20, "wall_thickness": 2, "length": 300} | changes
    diameter = values["inner_diameter"]
    braid = Braid.from_angle(
        angle=values.pop("angle", 24.82),
        threads=values.pop("threads", 60),
        layer_diameters=(diameter + 0.6, diameter + 1.8),
    )
    return Muscle(**values, braid=braid)


MUSCLES = {
    "paper": braided(),
    "short": braided(length=60),
    "long": braided(length=1000, threads=4),
    "slim": braided(inner_diameter=10, threads=12),
    "wide": braided(inner_diameter=200, threads=3),
    "steep": braided(angle=75, length=100, threads=2),
    "part of a turn": braided(angle=3, length=20, threads=1),
    "no caps": braided(cap_length=0, threads=2),
    "bare": Muscle(inner_diameter=20, wall_thickness=2, length=300, braid=None),
}


@pytest.fixture(params=MUSCLES, scope="module")
def muscle(request):
    return MUSCLES[request.param]


@pytest.fixture(scope="module")
def model(muscle, tmp_path_factory):
    """The STEP file, opened in gmsh: volumes of the solids; ends, points, length of the threads."""
    path = tmp_path_factory.mktemp("whole") / "muscle.step"
    whole.write(muscle, path)
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(path))
        solids = sorted(gmsh.model.occ.getMass(*solid) for solid in gmsh.model.getEntities(3))
        curves = [c for c in gmsh.model.getEntities(1) if gmsh.model.getType(*c) == "BSpline"]
        return solids, [spline(*curve) for curve in curves]
    finally:
        gmsh.finalize()


def spline(dimension, tag):
    """Length of a curve, and points from one end to the other."""
    (low,), (high,) = gmsh.model.getParametrizationBounds(dimension, tag)
    points = gmsh.model.getValue(dimension, tag, np.linspace(low, high, 3001))
    return gmsh.model.occ.getMass(dimension, tag), np.reshape(points, (-1, 3))


def test_tube_and_caps_have_their_volumes(muscle, model):
    cap = math.pi * muscle.outer_radius**2 * muscle.cap_length
    expected = [whole.volume(muscle), *([cap, cap] if cap else [])]
    assert model[0] == pytest.approx(sorted(expected), rel=1e-9)


def test_volume_is_that_of_the_rubber():
    assert whole.volume(MUSCLES["paper"]) == pytest.approx(math.pi * (12**2 - 10**2) * 300)


def test_every_thread_is_a_curve(muscle, model):
    assert len(model[1]) == (2 * muscle.braid.threads if muscle.braid else 0)


def test_threads_have_the_length_of_their_helix(muscle, model):
    """L / cos(angle of the layer), whose tangent is the circumference over the lead."""
    helices = [
        math.hypot(1, 2 * math.pi * radius / muscle.braid.lead) * muscle.length
        for radius in muscle.layer_radii
        for _ in range(muscle.braid.threads)
    ]
    assert sorted(length for length, _ in model[1]) == pytest.approx(helices, rel=1e-6)


def test_threads_stay_on_their_helix(muscle, model):
    """Within 1e-3 mm everywhere, the ends included; clockwise inside, the other way outside."""
    phases = ([], [])
    for _, points in model[1]:
        x, y, z = points.T
        radius = np.hypot(x, y)
        layer = int(radius.mean() > sum(muscle.layer_radii) / 2)
        turn = (1, -1)[layer] * 2 * math.pi * z / muscle.braid.lead
        phase = np.unwrap(np.arctan2(y, x)) - turn
        assert np.abs(radius - muscle.layer_radii[layer]).max() < 1e-3
        assert np.abs(phase - phase.mean()).max() * muscle.layer_radii[layer] < 1e-3
        assert sorted([z[0], z[-1]]) == pytest.approx([-muscle.length / 2, muscle.length / 2])
        phases[layer].append(phase.mean() % (2 * math.pi))
    if muscle.braid:
        for found in phases:  # evenly around the tube
            steps = np.diff([*sorted(found), min(found) + 2 * math.pi])
            assert steps == pytest.approx(2 * math.pi / muscle.braid.threads, abs=1e-5)


def test_the_inner_layer_is_clockwise():
    """Going away from the viewer, along Z: it turns from x to y, as right-hand screws do."""
    muscle = MUSCLES["paper"]
    quarter = np.array([0.0, muscle.braid.lead / 4])
    inner, outer = (whole.thread_points(muscle, layer, quarter)[0] for layer in (0, 1))
    assert inner == pytest.approx(np.array([[10.3, 0, 0], [0, 10.3, 36]]), abs=0.02)
    assert outer == pytest.approx(np.array([[10.9, 0, 0], [0, -10.9, 36]]), abs=0.02)


def test_parts_have_names(tmp_path):
    path = tmp_path / "muscle.step"
    whole.write(braided(threads=2), path)
    names = re.findall(r"PRODUCT\('([^']*)'", path.read_text())
    assert names == [
        "muscle",
        "tube",
        "cap 1",
        "cap 2",
        "thread clockwise 1",
        "thread clockwise 2",
        "thread counter-clockwise 1",
        "thread counter-clockwise 2",
    ]


def test_same_input_same_bytes(tmp_path):
    """Also after many other files of the same process, by which OpenCASCADE counts."""
    muscle = braided(threads=2, length=60)
    paths = [tmp_path / f"{number}.step" for number in range(12)]
    for path in paths:
        whole.write(muscle, path)
    assert len({path.read_bytes() for path in paths}) == 1
    assert sorted(tmp_path.iterdir()) == sorted(paths)  # nothing left beside them


def test_nothing_is_said(tmp_path, capfd):
    whole.write(braided(threads=1), tmp_path / "muscle.step")
    assert capfd.readouterr() == ("", "")


def test_threads_of_a_bare_tube_are_refused():
    with pytest.raises(UnbuildableMuscle, match="braid = None is refused"):
        whole.thread_points(MUSCLES["bare"], 0, np.zeros(1))


def test_a_lead_of_countless_turns_is_refused(tmp_path):
    braid = Braid(lead=0.1, threads=1, layer_diameters=(20.6, 21.8))
    muscle = Muscle(inner_diameter=20, wall_thickness=2, length=300, braid=braid)
    with pytest.raises(UnbuildableMuscle, match=r"lead = 0\.1 is refused; allowed: at least"):
        whole.write(muscle, tmp_path / "muscle.step")
    assert list(tmp_path.iterdir()) == []
