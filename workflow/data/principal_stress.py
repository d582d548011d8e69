"""Principal stresses."""

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float64]


def principal_of_four(
    stress: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Largest and smallest of the three principal stresses of rows rr, rz, zz, tt (hoop)."""
    rr, rz, zz, tt = stress.T
    mean, radius = (rr + zz) / 2, np.hypot((rr - zz) / 2, rz)
    return np.maximum(mean + radius, tt), np.minimum(mean - radius, tt)


def principal_of_six(stress: Values) -> Values:
    """All three principal stresses, rising, of rows rr, tt, zz, rt, tz, rz; one row each."""
    rr, tt, zz, rt, tz, rz = stress.T
    rows = [np.stack(row, axis=-1) for row in ((rr, rt, rz), (rt, tt, tz), (rz, tz, zz))]
    return np.asarray(np.linalg.eigvalsh(np.stack(rows, axis=-1)))
