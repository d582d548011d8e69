"""The force of a thread against its stretch; the twin of solver/edp/threads_*.idp.

All functions take the thread stretch lf and give shares of EA. A test compares the two languages.
"""

import numpy as np
from numpy.typing import NDArray

from solver.effects import ThreadLaw
from solver.material import Thread

SLACK_WIDTH = 1e-3  # strain over which a thread slackens, at the stiffness below
REFERENCE_STIFFNESS = 315.0  # N


def slack_width(thread: Thread) -> float:
    """Width e of the smoothing [1]: narrower for stiff threads, whose working strains are smaller.

    Otherwise the smoothing itself would carry load.
    """
    return SLACK_WIDTH * min(1.0, REFERENCE_STIFFNESS / thread.stiffness)


def tension(law: ThreadLaw, thread: Thread, stretch: NDArray[np.float64]) -> NDArray[np.float64]:
    """Thread force N / EA."""
    strain = stretch - 1
    if law is ThreadLaw.TWO_WAY:
        return np.asarray(strain)
    e = slack_width(thread)
    root = np.sqrt(strain**2 + e**2)
    return np.asarray(((strain + root) / 2) ** 2 / root + e * strain)


def energy(law: ThreadLaw, thread: Thread, stretch: NDArray[np.float64]) -> NDArray[np.float64]:
    """Energy per reference length / EA."""
    strain = stretch - 1
    if law is ThreadLaw.TWO_WAY:
        return np.asarray(strain**2 / 2)
    e = slack_width(thread)
    positive = (strain + np.sqrt(strain**2 + e**2)) / 2
    return np.asarray((positive**2 + e * strain**2) / 2)
