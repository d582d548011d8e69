"""What single threads do nearby: stress of the rubber and tension along a thread, from fields."""

from itertools import product

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from geometry.cell import Box
from solver.case import Case
from solver.threads import thread_law
from workflow.analyses.analysis import Solved
from workflow.data.principal_stress import principal_of_six

Array = NDArray[np.float64]
BINS = 12  # along a thread, within one cell
TOGETHER = 1e-3  # mm, or share of a side: closer corners are one node
POINTS = 7  # of a lattice along each edge of a tetrahedron


def nodes(fields: dict[str, Array], box: Box) -> tuple[Array, Array]:
    """Nodes (R, R_m T, Z) of a cell and its neighbours [mm], and what they have: see below.

    Columns r [mm], t - T, and the largest principal stress [MPa] of the mean of all tetrahedra that
    meet at a node or at one that is the same by periodicity.
    """
    corners, stress = fields["corners"], fields["stress"]
    sides = np.array([1, 2 * np.pi / box.sectors, box.spacing])
    places = corners[:, :3] / sides % [np.inf, 1, 1]  # periodic images fall on each other
    # FreeFEM has the corners of P1dc a few millionths inside of their tetrahedron.
    pairs = cKDTree(places, boxsize=[0, 1, 1]).query_pairs(TOGETHER, output_type="ndarray")
    links = coo_array((np.ones(len(pairs)), pairs.T), shape=(len(places), len(places)))
    same = connected_components(links, directed=False)[1]
    first = np.unique(same, return_index=True)[1]
    places = np.round(places[first], 4)
    count = np.bincount(same)
    mean = np.stack([np.bincount(same, part) / count for part in stress.T], axis=1)
    r, turn = corners[first, 3], corners[first, 4] - corners[first, 1]
    values = np.column_stack([r, turn, principal_of_six(mean)[:, 2]])
    shifts = [np.array([0, k, m]) for k, m in product((-1, 0, 1), repeat=2)]
    images = [(places + shift) * sides * [1, box.mean_radius, 1] for shift in shifts]
    return np.concatenate(images), np.tile(values, (len(shifts), 1))


def largest_stress(fields: dict[str, Array]) -> float:
    """Largest principal stress of the rubber [MPa], each tetrahedron by its mean."""
    return float(principal_of_six(fields["stress"])[:, 2].reshape(-1, 4).mean(axis=1).max())


def tension(one: Solved) -> pd.DataFrame:
    """Tension of one thread of each layer along the cell: mean over the tube it is spread over."""
    case = one.asked.case
    (fields,) = one.solution.fields.values()
    box, lattice = Box(case.muscle), _lattice()
    corners = fields["corners"].reshape(-1, 4, 6)
    threads = fields["threads"].reshape(-1, 4, 4)
    x = corners[:, :, :3] * [1, box.mean_radius, 1]
    size = np.abs(np.linalg.det(x[:, 1:] - x[:, :1]))[:, None]
    radius, z = (corners[:, :, k] @ lattice.T for k in (0, 2))
    place = np.floor(z / box.spacing * BINS).astype(int).clip(0, BINS - 1).ravel()
    rows = []
    for layer in range(2):
        force = _force(case, threads[:, :, layer] @ lattice.T)
        share = size * radius * (threads[:, :, 2 + layer] @ lattice.T).clip(0)
        mean = np.bincount(place, (share * force).ravel(), BINS) / np.bincount(
            place, share.ravel(), BINS
        )
        along = (np.arange(BINS) + 0.5) / BINS
        rows.append(
            pd.DataFrame(
                {"layer": layer + 1, "along the cell [1]": along, "thread tension [N]": mean}
            )
        )
    return pd.concat(rows, ignore_index=True)


def _lattice() -> Array:
    """Points of a tetrahedron in barycentric coordinates, none of them on a face."""
    inside = [p for p in product(range(1, POINTS), repeat=4) if sum(p) == POINTS + 1]
    return np.array(inside) / (POINTS + 1)


def _force(case: Case, stretch: Array) -> Array:
    """Tension of a thread [N]."""
    assert case.thread is not None
    width = case.numerics.slack.width_of(case.thread)
    return case.thread.stiffness * thread_law.tension(case.effects.threads, width, stretch)
