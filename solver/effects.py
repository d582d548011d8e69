"""The effects a case may carry, and which model carries which."""

from dataclasses import dataclass, field
from enum import StrEnum

from solver.refusal import UnsolvableCase


class End(StrEnum):
    """How the tube ends at the cap."""

    CLAMP = "clamp"  # held gradually inside the fitting: stays valid
    BUTT = "butt"  # end face bonded: simple, singular at its corners
    SLIDING = "sliding"  # free to widen: a piece of an infinite tube


class ThreadLaw(StrEnum):
    """What a thread does when it is pushed."""

    TENSION_ONLY = "tension_only"  # slackens
    TWO_WAY = "two_way"  # pushes back: the paper's


@dataclass(frozen=True, kw_only=True)
class Effects:
    """Switches of a case; the defaults are the ones that stay valid in hard cases."""

    end: End = field(default=End.CLAMP)
    threads: ThreadLaw = field(default=ThreadLaw.TENSION_ONLY)

    def __post_init__(self) -> None:
        for name, kind in (("end", End), ("threads", ThreadLaw)):
            value = getattr(self, name)
            if value not in list(kind):
                raise UnsolvableCase(name, value, ", ".join(kind))
            object.__setattr__(self, name, kind(value))
