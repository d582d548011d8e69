"""Principal stresses of the deformed wall, from the fields of solved states."""

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from workflow.data.principal_stress import principal_of_four

SECTION = ["R [mm]", "Z [mm]", "r [mm]", "z [mm]"]
LARGEST, SMALLEST = "largest principal stress [MPa]", "smallest principal stress [MPa]"


def wall(fields: dict[str, NDArray[np.float64]]) -> pd.DataFrame:
    """The corners of all triangles, three rows each, with their principal stresses."""
    table = pd.DataFrame(fields["corners"], columns=SECTION)
    table[LARGEST], table[SMALLEST] = principal_of_four(fields["stress"])
    return table.assign(where="wall")


def along_meridian(corners: pd.DataFrame) -> pd.DataFrame:
    """Stress on both surfaces at their nodes, and its mean through the wall, along Z.

    At a node the triangles around it are averaged. The mean is over a row of triangles, exact for
    a stress that is linear in each.
    """
    radii = corners["R [mm]"]
    frames = [_mean_of_rows(corners).assign(where="mean")]
    for where, radius in (("inner surface", radii.min()), ("outer surface", radii.max())):
        there = corners[np.isclose(radii, radius)]
        nodes = there.groupby(there["Z [mm]"].round(6)).mean(numeric_only=True)
        frames.append(nodes.reset_index(drop=True).assign(where=where))
    return pd.concat(frames, ignore_index=True)


def _mean_of_rows(corners: pd.DataFrame) -> pd.DataFrame:
    """Mean over each row of triangles between two rows of nodes."""
    columns = [*SECTION, LARGEST, SMALLEST]
    values = corners[columns].to_numpy().reshape(-1, 3, len(columns))
    (r0, r1, r2), (z0, z1, z2) = values[:, :, 0].T, values[:, :, 1].T
    area = abs((r1 - r0) * (z2 - z0) - (r2 - r0) * (z1 - z0)) / 2
    row = values[:, :, 1].min(axis=1).round(6)
    weighted = pd.DataFrame(values.mean(axis=1) * area[:, None], columns=columns)
    total = weighted.assign(area=area).groupby(row).sum()
    return total[columns].div(total["area"], axis=0).reset_index(drop=True)
