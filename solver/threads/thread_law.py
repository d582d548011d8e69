"""The force of a thread against its stretch; the twin of solver/threads/threads_*.idp.

All functions take the thread stretch lf and the width over which a thread slackens
(solver.numerics.Slack), and give shares of EA. A slack thread in rubber has a little stiffness
left, as otherwise nothing would say where it is; that of a sleeve (``glue`` 0) would hold the
sleeve to the wall, and is left out. A test compares the two languages.
"""

import numpy as np
from numpy.typing import NDArray

from solver.effects import ThreadLaw


def tension(
    law: ThreadLaw,
    width: float,
    stretch: NDArray[np.float64],
    glue: float | NDArray[np.float64] = 1.0,
) -> NDArray[np.float64]:
    """Thread force N / EA."""
    strain = stretch - 1
    if law is ThreadLaw.TWO_WAY:
        return np.asarray(strain)
    e = width
    root = np.sqrt(strain**2 + e**2)
    return np.asarray(((strain + root) / 2) ** 2 / root + glue * e * strain)


def energy(
    law: ThreadLaw,
    width: float,
    stretch: NDArray[np.float64],
    glue: float | NDArray[np.float64] = 1.0,
) -> NDArray[np.float64]:
    """Energy per reference length / EA."""
    strain = stretch - 1
    if law is ThreadLaw.TWO_WAY:
        return np.asarray(strain**2 / 2)
    e = width
    positive = (strain + np.sqrt(strain**2 + e**2)) / 2
    return np.asarray((positive**2 + glue * e * strain**2) / 2)
