"""The picture: what faces the viewer and no more, legible names, every number of the muscle."""

import io
import math
from dataclasses import replace
from itertools import combinations, pairwise

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.text import Text

from geometry.muscle import Braid, Muscle
from workflow.figures.muscle_drawing import draw, laid_open, numbers, spread
from workflow.figures.muscle_painting import COVER, LAYER_COLOURS, TURNED, Body, paint, project

LUMINANCE = np.array([0.299, 0.587, 0.114])


def braided(diameter, wall, length, *, threads=60, depths=(0.3, 0.9), **more):
    layers = tuple(diameter + 2 * depth for depth in depths)
    braid = Braid.from_angle(angle=24.82, threads=threads, layer_diameters=layers)
    return Muscle(inner_diameter=diameter, wall_thickness=wall, length=length, braid=braid, **more)


MUSCLES = {
    "short": braided(20, 2, 60),
    "long and slim": braided(10, 2, 1000),
    "stout": braided(40, 3, 30, threads=120, cap_length=2),
    "layers at one surface": braided(20, 2, 300, depths=(0.05, 0.1)),
    "few threads": braided(20, 1.5, 300, threads=3),
    "no caps": braided(20, 2, 300, cap_length=0),
    "bare": Muscle(inner_diameter=20, wall_thickness=2, length=300, braid=None),
}


@pytest.fixture(params=["paper", *MUSCLES])
def any_muscle(request, muscle):
    return MUSCLES.get(request.param, muscle)


def texts(figure):
    """Everything that is written and not empty."""
    every = [*figure.texts, *(text for axes in figure.axes for text in axes.texts)]
    return [text for text in every if text.get_text()]


def picture(figure):
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=50)
    return stream.getvalue()


def painted_threads(muscle, layer, length):
    """Corners of the bands of a layer's threads on a cylinder, and that cylinder."""
    axes = Figure().add_subplot()
    body = Body(
        name="", radius=muscle.layer_radii[layer], start=0, stop=length, greys=(0, 1), layer=layer
    )
    paint(axes, muscle, [body])
    colour = pytest.approx(to_rgb(LAYER_COLOURS[layer]))
    for collection in axes.collections:
        if isinstance(collection, PolyCollection) and len(collection.get_facecolor()) == 1:
            bands = [path.vertices[:-1] for path in collection.get_paths()]
            if collection.get_facecolor()[0, :3] == colour:
                return bands, body
    raise AssertionError("no threads were painted")


def area(polygon):
    x, y = polygon.T
    return abs(x @ np.roll(y, 1) - y @ np.roll(x, 1)) / 2


def test_numbers_of_the_paper(muscle):
    assert numbers(muscle) == [
        ("inner diameter", "20 mm"),
        ("wall thickness", "2 mm"),
        ("length", "300 mm"),
        ("layer diameters", "20.6, 21.8 mm"),
        ("threads per layer", "60"),
        ("lead", "144 mm"),
        ("axial spacing", "2.4 mm"),
        ("braid angle", "24.82°"),
    ]


def test_every_number_is_written(any_muscle):
    written = [text.get_text().strip() for text in texts(draw(any_muscle))]
    for name, value in numbers(any_muscle):
        assert name in written
        assert value in written
    for radius in (any_muscle.inner_radius, *any_muscle.layer_radii, any_muscle.outer_radius):
        assert f"{radius:g} mm" in written


def test_texts_are_apart_and_inside(any_muscle):
    figure = draw(any_muscle)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()  # only now everything is where it will be
    renderer = canvas.get_renderer()
    # of the text alone: an annotation's own extent includes its arrow
    boxes = [(text.get_text(), Text.get_window_extent(text, renderer)) for text in texts(figure)]
    for (one, box), (other, beside) in combinations(boxes, 2):
        assert not box.overlaps(beside), f"{one!r} on {other!r}"
    for text, box in boxes:
        inside = figure.bbox.contains(box.x0, box.y0) and figure.bbox.contains(box.x1, box.y1)
        assert inside, text


@pytest.mark.parametrize(
    "change",
    [
        {"inner_diameter": 20.2},
        {"wall_thickness": 2.2},
        {"length": 290},
        {"cap_length": 12},
        {"braid": Braid(lead=216, threads=60, layer_diameters=(20.6, 21.8))},
        {"braid": Braid(lead=144, threads=48, layer_diameters=(20.6, 21.8))},
        {"braid": Braid(lead=144, threads=60, layer_diameters=(20.8, 21.8))},
        {"braid": None},
    ],
)
def test_a_changed_number_changes_the_picture(muscle, change):
    assert picture(draw(replace(muscle, **change))) != picture(draw(muscle))


def test_same_muscle_same_picture(muscle):
    assert picture(draw(muscle)) == picture(draw(muscle))


@pytest.mark.parametrize("name", ["short", "few threads", "long and slim"])
@pytest.mark.parametrize("layer", [0, 1])
def test_threads_are_painted_where_they_face_the_viewer(name, layer):
    """Threads cover a given part of the cylinder, so of its seen half over whole turns."""
    muscle = MUSCLES[name]
    length = 3 * muscle.braid.lead
    bands, body = painted_threads(muscle, layer, length)
    seen = 2 * body.radius * length * math.cos(TURNED)
    assert sum(map(area, bands)) == pytest.approx(COVER * seen, rel=0.01)
    assert max(abs(band[:, 1]).max() for band in bands) <= body.radius * (1 + 1e-12)


@pytest.mark.parametrize(("layer", "sense"), [(0, -1), (1, 1)])
def test_layers_turn_as_they_are_called(muscle, layer, sense):
    """Clockwise threads go down in front where they go away along the axis, to the right."""
    bands, _ = painted_threads(muscle, layer, 100)
    for band in bands:
        edge = band[: len(band) // 2]
        slope = np.polyfit(*edge.T, 1)[0]
        assert sense * slope > 0
    middle = max(bands, key=lambda band: np.ptp(band[:, 0]))
    edge = middle[: len(middle) // 2]
    nearest = np.argmin(abs(edge[:, 1]))  # in front of the axis, where nothing is foreshortened
    dx, dy = edge[nearest + 1] - edge[nearest - 1]
    angle = math.atan(abs(dy) / (dx / math.cos(TURNED)))
    assert angle == pytest.approx(muscle.braid.layer_angles[layer], rel=2e-3)


def test_the_view_is_orthographic():
    """Seen are the axis, shortened, and circles as ellipses that keep their height."""
    assert project(0, np.zeros(1), 10) == pytest.approx(np.array([[10 * math.cos(TURNED), 0]]))
    circle = project(3, np.linspace(0, 2 * math.pi, 361), 0)
    across, up = circle.T
    ellipse = (across / (3 * math.sin(TURNED))) ** 2 + (up / 3) ** 2
    assert ellipse == pytest.approx(1)


def test_the_wall_is_taken_off_in_steps(muscle):
    steps = laid_open(muscle, 90)
    assert [step.name for step in steps] == [
        "tube",
        "outer layer, counter-clockwise",
        "inner layer, clockwise",
    ]
    assert [step.radius for step in steps] == [12, 10.9, 10.3]
    assert [step.layer for step in steps] == [None, 1, 0]
    assert (steps[0].start, steps[-1].stop) == (-150, -60)
    assert all(one.stop == other.start for one, other in pairwise(steps))


def test_layers_differ_in_grey():
    dark, light = (np.dot(LUMINANCE, to_rgb(colour)) for colour in LAYER_COLOURS)
    assert light - dark > 0.25


@pytest.mark.parametrize(
    ("values", "apart"),
    [
        ([], []),
        ([3.0], [3]),
        ([0.0, 2, 5], [0, 2, 5]),
        ([0.0, 0, 0], [-1, 0, 1]),
        ([0.0, 0.5, 4], [-0.5 / 3, 1 - 0.5 / 3, 4 - 0.5 / 3]),
    ],
)
def test_spread(values, apart):
    assert spread(values, 1) == pytest.approx(apart)
