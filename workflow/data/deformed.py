"""The whole muscle as it is deformed, in three dimensions: the wall between its caps, its threads.

The fields of a record are those of one half of a section. Between their nodes a line of the wall,
r(Z) and z(Z) at a reference radius, is a monotone cubic, symmetric to mid-length. A thread stays at
the angle about the axis that it has on the unloaded muscle, as nothing twists in these models:

    lf^2 = [(2 pi r / lead)^2 + r'^2 + z'^2] / [1 + tan^2 a]

with the lead and the angle a of its layer (geometry/braid.py). A slack thread of a sleeve is drawn
where it would lie on the tube; where it hangs no model says.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geometry.braid import Kind, Layer
from solver.case import Case
from solver.threads import thread_law
from workflow.data.principal_stress import named
from workflow.study.errors import StudyError

Array = NDArray[np.float64]
SECTORS = 72  # of the wall around the axis
THREAD_STEP = math.radians(6)  # of a thread about the axis; a chord is then 5e-4 shorter at most
ALONG = 16  # stations of the wall on the length of an outer radius
MOST_POINTS = 2_000_000  # of all threads; more is a slip of the pen, not a braid
OUTSIDE, BORE, ENDS, FIRST_LAYER = 0, 1, 2, 3  # numbers of the parts
PART = "part [1]"


@dataclass(frozen=True)
class Piece:
    """Some cells of one kind with points of their own.

    Attributes
    ----------
    part : 0 outside of the wall, 1 bore, 2 its ends, from 3 on families of threads, inner first
    before, after : places of the points on the unloaded and the deformed muscle [mm]
    values : of the points, by name
    """

    part: int
    before: Array
    after: Array
    kind: str
    cells: NDArray[np.int64]
    values: dict[str, Array]


class Line:
    """A line of the wall, at one reference radius, as it is deformed.

    ``Z, r, z`` are its nodes from mid-length on, in any order and as often as elements have them.
    """

    def __init__(self, radius: float, Z: Array, r: Array, z: Array) -> None:
        from scipy.interpolate import PchipInterpolator

        self.radius = radius
        _, first = np.unique(Z.round(9), return_index=True)
        half = np.column_stack([Z, r, z])[first]
        half[0] = half[0] * [0, 1, 0]  # mid-length stays where it is
        mirrored = half[:0:-1] * [-1, 1, -1]
        nodes = np.vstack([mirrored, half])
        self._at = PchipInterpolator(nodes[:, 0], nodes[:, 1:])
        self.nodes = nodes[:, 0]

    def places(self, Z: Array, derivative: int = 0) -> tuple[Array, Array]:
        """R and z at reference heights, or their derivatives by those [mm]."""
        r, z = self._at(Z, derivative).T
        return r, z


def lines(case: Case, fields: dict[str, Array], radii: list[float]) -> list[Line]:
    """Lines of the wall at some reference radii.

    Raises
    ------
    StudyError
        If the record has no fields of which a whole muscle can be made.
    """
    if "meridian" in fields:
        return [_of_membrane(fields["meridian"], radius) for radius in radii]
    corners = fields.get("corners")
    if corners is None or corners.shape[1] != 4:
        raise StudyError(f"{case.model}: its fields are not those of a whole muscle")
    found = []
    for radius in radii:
        on = corners[np.isclose(corners[:, 0], radius, rtol=1e-9)]
        found.append(Line(radius, on[:, 1], on[:, 2], on[:, 3]))
    return found


def _of_membrane(rows: Array, radius: float) -> Line:
    """What its one line (three nodes an element) carries at a radius, by incompressibility."""
    own, Z, r, z = rows.T
    stretch = np.hypot(_slopes(Z, r), _slopes(Z, z))
    radius = max(radius, own[0])  # a line at one radius for all carries all there
    carried = np.sqrt(r**2 + (radius**2 - own[0] ** 2) / stretch)
    return Line(radius, Z, carried, z)


def _slopes(Z: Array, y: Array) -> Array:
    """Derivatives at the nodes of quadratic elements; where two meet, their mean."""
    a, m, b = y[:-2:2], y[1:-1:2], y[2::2]
    length = Z[2::2] - Z[:-2:2]
    sums, count = np.zeros(len(Z)), np.zeros(len(Z))
    ends = (-3 * a + 4 * m - b, b - a, a - 4 * m + 3 * b)
    for first, values in enumerate(ends):
        at = slice(first, first + 2 * len(a) - 1, 2)
        sums[at] += values / length
        count[at] += 1
    return sums / count


def pieces(case: Case, fields: dict[str, Array]) -> list[Piece]:
    """Wall and threads of a state."""
    muscle = case.muscle
    inner, outer = lines(case, fields, [muscle.inner_radius, muscle.outer_radius])
    step = muscle.outer_radius / ALONG
    even = np.linspace(-muscle.length / 2, muscle.length / 2, math.ceil(muscle.length / step) + 1)
    own = outer.nodes[np.abs(outer.nodes) <= muscle.length / 2]
    heights = np.unique(np.concatenate([even, own]).round(9))
    found = [
        _surface(OUTSIDE, outer, heights, fields, outward=True),
        _surface(BORE, inner, heights, fields, outward=False),
        _ends(inner, outer, muscle.length / 2),
    ]
    return [*found, *_threads(case, fields)]


def _surface(
    part: int, line: Line, heights: Array, fields: dict[str, Array], *, outward: bool
) -> Piece:
    """A surface of revolution, its normals away from the rubber."""
    turns = 2 * math.pi * np.arange(SECTORS) / SECTORS
    r, z = line.places(heights)
    before = _around(np.full_like(heights, line.radius), heights, turns)
    values = {
        name: np.repeat(along, SECTORS) for name, along in _stress(line, heights, fields).items()
    }
    k, t = np.meshgrid(np.arange(len(heights) - 1), np.arange(SECTORS), indexing="ij")
    here, beside = k * SECTORS + t, k * SECTORS + (t + 1) % SECTORS
    corners = [here, beside, beside + SECTORS, here + SECTORS]
    cells = np.stack(corners if outward else corners[::-1], axis=-1).reshape(-1, 4)
    return Piece(part, before, _around(r, z, turns), "quad", cells, values)


def _ends(inner: Line, outer: Line, half: float) -> Piece:
    """The rings of rubber at both caps."""
    turns = 2 * math.pi * np.arange(SECTORS) / SECTORS
    heights = np.array([-half, half])
    before, after = [], []
    for line in (inner, outer):
        r, z = line.places(heights)
        before.append(_around(np.full(2, line.radius), heights, turns))
        after.append(_around(r, z, turns))
    t = np.arange(SECTORS)
    beside, out = (t + 1) % SECTORS, 2 * SECTORS
    ring = np.stack([t, beside, beside + out, t + out], axis=-1)
    cells = np.vstack([ring, ring[:, ::-1] + SECTORS])
    return Piece(ENDS, np.vstack(before), np.vstack(after), "quad", cells, {})


def _threads(case: Case, fields: dict[str, Array]) -> Iterator[Piece]:
    """Every thread as a line of short pieces, with its stretch and its force."""
    muscle, thread = case.muscle, case.thread
    if thread is None:
        return
    counts = [
        math.ceil(2 * math.pi * muscle.length / wound.lead / THREAD_STEP) + 1
        for wound in muscle.layers
    ]
    total = sum(n * layer.threads for n, layer in zip(counts, muscle.layers, strict=True))
    if total > MOST_POINTS:
        raise StudyError(f"its threads take {total} points; at most {MOST_POINTS} are drawn")
    carriers = lines(case, fields, [layer.carrier for layer in muscle.layers])
    for number, (wound, line) in enumerate(zip(muscle.layers, carriers, strict=True)):
        heights = np.linspace(-muscle.length / 2, muscle.length / 2, counts[number])
        stretch = thread_stretch(wound, line, heights)
        width = case.numerics.slack.width_of(thread)
        glue = float(wound.kind is Kind.EMBEDDED)
        law = case.effects.threads
        force = thread.stiffness * wound.share * thread_law.tension(law, width, stretch, glue)
        turns = wound.sense * 2 * math.pi * heights / wound.lead
        r, z = line.places(heights)
        before = np.full_like(heights, max(wound.radius, wound.carrier))
        starts = 2 * math.pi * np.arange(wound.threads) / wound.threads
        first = np.arange(len(heights) - 1)
        each = np.column_stack([first, first + 1])
        cells = (each + len(heights) * np.arange(wound.threads)[:, None, None]).reshape(-1, 2)
        yield Piece(
            FIRST_LAYER + number,
            np.vstack([_on_axis(before, heights, turns + start) for start in starts]),
            np.vstack([_on_axis(r, z, turns + start) for start in starts]),
            "line",
            cells,
            {
                "thread_stretch [1]": np.tile(stretch, wound.threads),
                "thread_force [N]": np.tile(force, wound.threads),
            },
        )


def thread_stretch(wound: Layer, line: Line, heights: Array) -> Array:
    """Of the threads of a layer that a line carries."""
    r, _ = line.places(heights)
    dr, dz = line.places(heights, 1)
    squared = (2 * math.pi * r / wound.lead) ** 2 + dr**2 + dz**2
    return np.asarray(np.sqrt(squared / (1 + wound.tangent**2)))


def _stress(line: Line, heights: Array, fields: dict[str, Array]) -> dict[str, Array]:
    """Stress on a surface of the solid: at a node the mean of the triangles around it."""
    if "stress" not in fields:
        return {}
    on = np.isclose(fields["corners"][:, 0], line.radius, rtol=1e-9)
    nodes, where = np.unique(fields["corners"][on, 1].round(9), return_inverse=True)
    count = np.bincount(where)
    return {
        name: np.interp(np.abs(heights), nodes, np.bincount(where, values[on]) / count)
        for name, values in named(fields["stress"]).items()
    }


def _around(r: Array, z: Array, turns: Array) -> Array:
    """Points of rings, one after the other, shape (rings turns, 3)."""
    r, z = np.repeat(r, len(turns)), np.repeat(z, len(turns))
    return _on_axis(r, z, np.tile(turns, len(z) // len(turns)))


def _on_axis(r: Array, z: Array, turns: Array) -> Array:
    """x, y, z of points by radius, height and angle."""
    return np.column_stack([r * np.cos(turns), r * np.sin(turns), z])
