"""Material of the braid: its threads. Rubbers stand in solver/rubber."""

from dataclasses import dataclass, field

from geometry.refusal import is_number
from solver.refusal import UnsolvableCase

MPA, NEWTON = {"unit": "MPa"}, {"unit": "N"}


@dataclass(frozen=True, kw_only=True)
class Thread:
    """A thread of the braid. Only its stiffness EA matters to the models.

    The paper gives E = 2100 MPa but not the area A; 315 N is A = 0.15 mm2.
    """

    stiffness: float = field(metadata=NEWTON)  # EA

    def __post_init__(self) -> None:
        if not (is_number(self.stiffness) and self.stiffness > 0):
            raise UnsolvableCase("stiffness", self.stiffness, "a finite number > 0 (N)")
