"""The internal tensors of a wall with a memory, in its principal directions.

C = diag(A, B, 1/(AB)) at every point. In a step the tensors are

    U1 = e U0 + w0 C0^-1 + w1 C1^-1,  L1 = e L0 + w0 C0 + w1 C1

and what w1 adds is a pressure. So a step is one of a hyperelastic wall. Its energy has beside that
of the law fa A + fb B + fc/(AB) + ga/A + gb/B + gc AB, with f = sum g C10 (e U0 + w0 C0^-1) and
g = sum g C01 (e L0 + w0 C0), which ``freeze`` finds.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from solver.memory import Memory, weights

Array = NDArray[np.float64]


def principal(a: Array, b: Array | float) -> Array:
    """C as (direction, point) of the squared stretches."""
    b = np.broadcast_to(b, np.shape(a))
    return np.array([a, b, 1 / (a * b)])


class WallMemory:
    """The branches at some points of a wall.

    Parameters
    ----------
    constants : C10 and C01 of all branches together, before their shares
    measure : what each point stands for, an area or a volume
    """

    def __init__(self, memory: Memory, constants: Sequence[float], measure: Array) -> None:
        self.times = np.array(memory.times)[:, None, None]
        shares = memory.of_law()[:, None, None]
        self.c10, self.c01 = shares * constants[0], shares * constants[1]
        self.measure = measure
        self.step = -1.0  # length of the last one [s], of which the weights are
        self.rest(np.ones((3, len(measure))))

    def rest(self, c: Array) -> None:
        """Has been at C for long."""
        self.c = c
        self.u, self.v = (np.repeat(x[None], len(self.times), axis=0) for x in (1 / c, c))
        self.freeze(0.0)

    def freeze(self, step: float) -> None:
        """Begin a step of some length [s] from what is remembered."""
        if step != self.step:
            self.step, self.weights = step, weights(step / self.times)
        e, w0, _ = self.weights
        self.old = e * self.u + w0 / self.c, e * self.v + w0 * self.c  # all but what the end adds
        self.f = np.sum(self.c10 * self.old[0], axis=0)
        self.g = np.sum(self.c01 * self.old[1], axis=0)

    def slopes(self, a: Array, b: Array | float) -> tuple[Array, Array]:
        """What the energy of the step adds to the derivatives of the law's, by A and B [MPa]."""
        f, g = self.f, self.g
        by_a = f[0] - f[2] / (a**2 * b) - g[0] / a**2 + g[2] * b
        by_b = f[1] - f[2] / (a * b**2) - g[1] / b**2 + g[2] * a
        return by_a, by_b

    def hessian(self, a: Array, b: Array | float) -> tuple[Array, Array, Array]:
        """Second derivatives by A and B [MPa]."""
        f, g = self.f, self.g
        by_aa = 2 * (f[2] / (a**3 * b) + g[0] / a**3)
        by_bb = 2 * (f[2] / (a * b**3) + g[1] / b**3)
        return by_aa, f[2] / (a * b) ** 2 + g[2], by_bb

    def advance(self, c: Array) -> None:
        """End the step that was begun, at C."""
        w1 = self.weights[2]
        self.u, self.v = self.old[0] + w1 / c, self.old[1] + w1 * c
        self.c = c

    @property
    def stored(self) -> float:
        """Energy in the branches."""
        x, y = self.c * self.u, self.v / self.c
        density = self.c10 * (x - 1 - np.log(x)) + self.c01 * (y - 1 - np.log(y))
        return float(np.sum(density * self.measure))

    @property
    def dissipation(self) -> float:
        """Energy that is lost, per second; never negative."""
        x, y = self.c * self.u, self.v / self.c
        density = (self.c10 * (x - 1) ** 2 / x + self.c01 * (y - 1) ** 2 / y) / self.times
        return float(np.sum(density * self.measure))
