"""C2, figure 5: principal stress in the wall at 10 % contraction.

The fields of a record are reduced to four numbers per state, which stand in a table beside that of
the states, with the names of their curves.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from workflow.analyses.claims.claim import (
    MUSCLE,
    Array,
    Claims,
    Data,
    Finding,
    Missing,
    graded,
    listed,
    values,
)
from workflow.data.stress import LARGEST, wall

PRESSURES = (0.2, 0.3, 0.4)  # MPa
CONTRACTION = 0.1
SUMMARY = {
    "cylinder": "smallest of the largest principal stress in the middle half of the muscle",
    "arc": "smallest of the largest principal stress within one diameter of the cap",
    "arc_mean": "smallest mean through the wall of the largest principal stress there",
    "compressed": "share of the wall within one diameter of the cap where it is negative",
}
CLAIMS = Claims()


def summary(fields: Mapping[str, NDArray[np.float64]], diameter: float, length: float) -> Array:
    """The numbers of SUMMARY [MPa, MPa, MPa, 1] of a state of a muscle, lengths in mm."""
    corners = wall(dict(fields))
    place, stress = corners["Z [mm]"].to_numpy(), corners[LARGEST].to_numpy()
    radii = corners["R [mm]"].to_numpy()
    (r, z) = (v.reshape(-1, 3).T for v in (radii, place))
    area = np.abs((r[1] - r[0]) * (z[2] - z[0]) - (r[2] - r[0]) * (z[1] - z[0]))
    weight = np.repeat(area, 3)
    arc = (place >= length / 2 - diameter) & (np.repeat(z.mean(axis=0), 3) <= length / 2)
    rows = np.round(np.repeat(z.min(axis=0), 3), 6)  # of triangles between two rows of nodes
    means = [
        np.average(stress[arc & (rows == row)], weights=weight[arc & (rows == row)])
        for row in np.unique(rows[arc])
    ]
    return np.array(
        [
            stress[place <= length / 4].min(),
            stress[arc].min(),
            min(means),
            weight[arc & (stress < 0)].sum() / weight[arc].sum(),
        ]
    )


@CLAIMS.add(
    "C2a",
    "fig05",
    "the principal stress is positive in the cylindrical part",
    paper="positive",
    unit="MPa",
)
def positive_cylinder(data: Data) -> Finding:
    """C2a: the cylindrical part is under tension."""
    found = _at_pressures(data, "cylinder")
    why = f"the largest principal stress is at least {listed(found, '.2f')} MPa in its middle half"
    return graded(float(found.min()), list(found > 0), why)


@CLAIMS.add(
    "C2b",
    "fig05",
    "the principal stress is negative in the arcs near the caps",
    paper="negative",
    unit="MPa",
)
def negative_arcs(data: Data) -> Finding:
    """C2b: the arcs at the caps are compressed, the whole wall or at least some of it."""
    found, mean = _at_pressures(data, "arc"), _at_pressures(data, "arc_mean")
    why = (
        f"the largest principal stress falls to {listed(found, '.2f')} MPa at 0.2, 0.3, 0.4 MPa, "
        f"its mean through the wall to {listed(mean, '.2f')} MPa: it falls towards the cap, "
        "but the hoop stays in tension there and only the innermost rubber at the cap does not"
    )
    if (mean < 0).all():
        why = f"its mean through the wall falls to {listed(mean, '.2f')} MPa"
    return graded(float(found.min()), [*(mean < 0), *(found < 0)], why)


@CLAIMS.add("C2c", "fig05", "those areas grow with pressure", paper="grow")
def growing_areas(data: Data) -> Finding:
    """C2c: the compressed areas grow with pressure."""
    found = _at_pressures(data, "compressed")
    why = (
        f"{listed(100 * found, '.2f')} % of the wall within a diameter of the cap are compressed "
        "at 0.2, 0.3, 0.4 MPa"
    )
    return graded(float(found[-1] - found[0]), list(np.diff(found) > 0), why)


def _at_pressures(data: Data, quantity: str) -> Array:
    if data.stress is None:
        raise Missing("there is no stress of any state")
    rows = data.stress[data.stress["muscle"] == MUSCLE]
    rows = rows[rows["contraction"] == CONTRACTION]
    # of one model and one variant, that of the scene which asks for the stress
    for _, curve in rows.groupby(["model", "variant"]):
        return values(curve.set_index("pressure")[quantity], PRESSURES)
    raise Missing("there is no stress of these states")
