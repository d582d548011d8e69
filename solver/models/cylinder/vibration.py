"""The answer of a cylinder to small vibrations of its length at a constant pressure.

One complex condensation per frequency, without any step of time: the Hessian of the energy less p V
by radius and axial stretch, and beside it that of the branches, which remember the state, times
sum g i w tau / (1 + i w tau); theory, section 11.
"""

import copy

import numpy as np
from numpy.typing import NDArray

from solver.memory import Memory
from solver.models.cylinder.mechanics import Cylinder
from solver.models.cylinder.observe import derivatives
from solver.models.cylinder.wall_memory import WallMemory, principal

Array = NDArray[np.float64]
ALL = Memory(shares=(1.0,), times=(1.0,))  # the branches together, as they meet a sudden strain


def dynamic_stiffness(cylinder: Cylinder, at: Array) -> Array:
    """Rows of frequency [Hz], storage and loss stiffness [N/mm] at a state."""
    case = cylinder.case
    assert case.memory is not None
    state, inner = cylinder.state(at), cylinder.inner
    branches = copy.copy(cylinder)
    branches.memory = WallMemory(ALL, case.rubber.branch, cylinder.measure)
    branches.memory.rest(principal(cylinder.hoop(state.r, state.lz) ** 2, state.lz**2))
    branches.measure = 0 * cylinder.measure

    def static(x: Array) -> Array:
        by_r, by_lz = cylinder.by_shape(x[0] * inner, x[1], threads=True)
        push = np.pi * state.pressure * x[0] * inner
        return np.array([(by_r - 2 * push * x[1]) * inner, by_lz - push * x[0] * inner])

    def sudden(x: Array) -> Array:
        by_r, by_lz = branches.by_shape(x[0] * inner, x[1], threads=False)
        return np.array([by_r * inner, by_lz])

    here = np.array([state.r / inner, state.lz])
    still, moved = derivatives(static, here), derivatives(sudden, here)
    rows = []
    for frequency in case.frequencies:
        hessian = still + case.memory.modulus(frequency) * moved
        stiffness = hessian[1, 1] - hessian[1, 0] * hessian[0, 1] / hessian[0, 0]
        stiffness = stiffness / case.muscle.length
        rows.append([frequency, stiffness.real, stiffness.imag])
    return np.array(rows)
