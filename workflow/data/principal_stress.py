"""Principal stresses, and what stresses are called in files."""

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float64]
COMPONENTS = ("rr", "rz", "zz", "tt")  # of the solid, in the columns of its fields


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


def named(stress: Values) -> dict[str, Values]:
    """Stress of the solid and its principal ones, by name with unit."""
    largest, smallest = principal_of_four(stress)
    return {f"stress_{c} [MPa]": stress[:, k] for k, c in enumerate(COMPONENTS)} | {
        "largest_principal_stress [MPa]": largest,
        "smallest_principal_stress [MPa]": smallest,
    }
