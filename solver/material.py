"""Materials: the rubber of the wall and the threads of the braid."""

from dataclasses import dataclass, field

from geometry.refusal import is_number
from solver.refusal import UnsolvableCase

MPA, NEWTON = {"unit": "MPa"}, {"unit": "N"}


@dataclass(frozen=True, kw_only=True)
class MooneyRivlin:
    """Rubber: W = C10 (I1 - 3) + C01 (I2 - 3), nearly incompressible where a model resolves that.

    Raises
    ------
    UnsolvableCase
        If the initial shear modulus 2 (C10 + C01) is not positive, or a constant negative.
    """

    c10: float = field(metadata=MPA)
    c01: float = field(metadata=MPA)
    kappa: float = field(default=1000.0, metadata=MPA)  # bulk modulus

    def __post_init__(self) -> None:
        if not (is_number(self.c10) and self.c10 > 0):
            raise UnsolvableCase("c10", self.c10, "a finite number > 0 (MPa)")
        if not (is_number(self.c01) and self.c01 >= 0):
            raise UnsolvableCase("c01", self.c01, "a finite number >= 0 (MPa)")
        if not (is_number(self.kappa) and self.kappa >= 50 * self.shear_modulus):
            raise UnsolvableCase(
                "kappa",
                self.kappa,
                f"at least 50 shear moduli, {50 * self.shear_modulus:g} MPa: rubber is nearly "
                "incompressible, and the other models take it as incompressible",
            )

    @property
    def shear_modulus(self) -> float:
        """Of small strains, 2 (C10 + C01) [MPa]."""
        return 2 * (self.c10 + self.c01)


@dataclass(frozen=True, kw_only=True)
class Thread:
    """A thread of the braid. Only its stiffness EA matters to the models.

    The paper gives E = 2100 MPa but not the area A; 315 N is A = 0.15 mm2.
    """

    stiffness: float = field(metadata=NEWTON)  # EA

    def __post_init__(self) -> None:
        if not (is_number(self.stiffness) and self.stiffness > 0):
            raise UnsolvableCase("stiffness", self.stiffness, "a finite number > 0 (N)")
