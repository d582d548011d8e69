"""Friction where the threads of a sleeve cross: they are pressed on each other, and turn.

A crossing of two families is a small disc of contact that bears a moment about the normal of the
wall, of all crossings of a length at most

    2/3 mu r_c N,  N the force with which the threads of the sleeve press on the wall,

as of a disc with an even pressure. Below it the crossing turns elastically, at it it slips. The
angle between the families is 2 atan(tan a0 sqrt(A/B)). No rate enters, so that neither does time;
what is lost, the moment times the angle of slip, is never negative (theory, section 11).
"""

import math
from dataclasses import dataclass, field

from geometry.braid import AnyBraid, Kind, LayeredBraid
from geometry.refusal import is_number
from solver.refusal import UnsolvableCase

NO_CROSSINGS = "none without a sleeve of two families that are mirrored, which cross"
AT = 0.1  # MPa: the pressure of a sleeve on its wall at which ``slip`` is reached


@dataclass(frozen=True, kw_only=True)
class Friction:
    """Of the crossings of a sleeve.

    Attributes
    ----------
    coefficient : mu of Coulomb
    contact : radius of the disc of a crossing, r_c
    slip : angle by which a crossing turns before it slips, under 0.1 MPa

    Raises
    ------
    UnsolvableCase
        If a value is none that it can have.
    """

    coefficient: float = field(metadata={"unit": "1"})
    contact: float = field(metadata={"unit": "mm"})
    slip: float = field(default=0.005, metadata={"unit": "rad"})

    def __post_init__(self) -> None:
        for name, most, unit in (("coefficient", 2, ""), ("contact", 10, " (mm)")):
            value = getattr(self, name)
            if not (is_number(value) and 0 < value <= most):
                raise UnsolvableCase(name, value, f"more than 0, at most {most}{unit}")
        if not (is_number(self.slip) and 1e-4 <= self.slip <= 0.1):
            raise UnsolvableCase("slip", self.slip, "from 0.0001 to 0.1 (rad)")

    @property
    def lever(self) -> float:
        """Largest moment by the force that presses [mm]."""
        return 2 / 3 * self.coefficient * self.contact

    def stiffness(self, radius: float) -> float:
        """Moment of the crossings of a length by their elastic angle, of a radius [N/rad]."""
        return self.lever * 2 * math.pi * radius * AT / self.slip


def no_crossings(braid: AnyBraid | None) -> str:
    """What is allowed in place of friction, of a braid that has no crossings; else empty."""
    if isinstance(braid, LayeredBraid) and Kind.SLEEVE in braid.kinds and braid.is_mirrored:
        return ""
    return NO_CROSSINGS
