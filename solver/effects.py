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


class Layers(StrEnum):
    """What a layer of threads is in the model ``cell``."""

    DISCRETE = "discrete"  # single threads, each spread over a tube
    SMEARED = "smeared"  # the same stiffness, spread over the same depth all around
    WIRE = "wire"  # single threads of zero thickness: the paper's, singular


class Twist(StrEnum):
    """Whether the ends of a muscle may turn against each other, in the model ``cell``."""

    HELD = "held"  # no twist
    FREE = "free"  # no torque


@dataclass(frozen=True, kw_only=True)
class Effects:
    """Switches of a case; the defaults are the ones that stay valid in hard cases."""

    end: End = field(default=End.CLAMP)
    threads: ThreadLaw = field(default=ThreadLaw.TENSION_ONLY)
    layers: Layers = field(default=Layers.DISCRETE)
    twist: Twist = field(default=Twist.HELD)

    def __post_init__(self) -> None:
        for name, kind in (
            ("end", End),
            ("threads", ThreadLaw),
            ("layers", Layers),
            ("twist", Twist),
        ):
            value = getattr(self, name)
            if value not in list(kind):
                raise UnsolvableCase(name, value, ", ".join(kind))
            object.__setattr__(self, name, kind(value))
