"""Effects: what a case may contain, what each adds to the energy, and its switch.

One list, ``EFFECTS``. A model says which it carries and which switches it reads. What
is off is absent from the solve: no unknowns, no terms. In FreeFEM each alternative is an include
of its own, and a program is composed of those that are on (solver/program.py).
"""

from dataclasses import dataclass, field
from enum import StrEnum

from solver.models import MODELS
from solver.refusal import UnsolvableCase


class End(StrEnum):
    """How the tube is held at the cap in the solid model."""

    CLAMP = "clamp"  # runs on into the fitting and is held there gradually
    BUTT = "butt"  # end face fixed: the paper's, singular at its corners
    SLIDING = "sliding"  # plane, free to widen: a piece of an infinite tube


class ThreadLaw(StrEnum):
    """Whether threads push back when shortened."""

    TENSION_ONLY = "tension_only"  # slackens instead, as yarns do
    TWO_WAY = "two_way"  # pushes back: the paper's


class Layers(StrEnum):
    """What a layer of threads is in the model ``cell``."""

    DISCRETE = "discrete"  # single threads, each spread over a tube
    SMEARED = "smeared"  # the same stiffness, spread over the same depth all around
    WIRE = "wire"  # single threads of zero thickness: the paper's, singular


class Twist(StrEnum):
    """Whether the ends of a muscle may turn against each other."""

    HELD = "held"  # no twist; its torque is an output
    FREE = "free"  # no torque; its twist is an output


class Wall(StrEnum):
    """Where through the wall rubber, threads and pressure lie."""

    INTEGRATED = "integrated"  # each at its own radius
    ONE_RADIUS = "one_radius"  # all at the mean radius of the layers, or mid-wall of a bare tube


class Stretch(StrEnum):
    """Whether threads become longer under load."""

    ELASTIC = "elastic"  # by EA
    RIGID = "rigid"  # not at all; they bear tension only, and the net gives the radius


class Volume(StrEnum):
    """Whether the rubber keeps its volume."""

    COMPRESSIBLE = "compressible"  # by its bulk modulus
    INCOMPRESSIBLE = "incompressible"


class Rubber(StrEnum):
    """Whether the wall resists."""

    ELASTIC = "elastic"
    NONE = "none"  # pressure on the braid alone


@dataclass(frozen=True, kw_only=True)
class Effects:
    """Switches of a case; the defaults are the ones that stay valid in hard cases."""

    end: End = field(default=End.CLAMP)
    threads: ThreadLaw = field(default=ThreadLaw.TENSION_ONLY)
    layers: Layers = field(default=Layers.DISCRETE)
    twist: Twist = field(default=Twist.HELD)
    wall: Wall = field(default=Wall.INTEGRATED)
    stretch: Stretch = field(default=Stretch.ELASTIC)
    volume: Volume = field(default=Volume.COMPRESSIBLE)
    rubber: Rubber = field(default=Rubber.ELASTIC)

    def __post_init__(self) -> None:
        for name, kind in KINDS.items():
            value = getattr(self, name)
            if type(value) is kind:
                continue
            if value not in list(kind):
                raise UnsolvableCase(name, value, ", ".join(kind))
            object.__setattr__(self, name, kind(value))
        if self.stretch is Stretch.RIGID:
            if self.threads is ThreadLaw.TWO_WAY:
                allowed = "elastic with two_way threads: two rigid layers that push lock the wall"
                raise UnsolvableCase("stretch", self.stretch, allowed)
            if self.twist is Twist.FREE:
                raise UnsolvableCase("stretch", self.stretch, "elastic where twist is free")


KINDS: dict[str, type[StrEnum]] = {
    "end": End,
    "threads": ThreadLaw,
    "layers": Layers,
    "twist": Twist,
    "wall": Wall,
    "stretch": Stretch,
    "volume": Volume,
    "rubber": Rubber,
}
OF_BRAID = ("threads", "layers", "stretch")  # switches that a bare tube does not read
# Choices among ways to have an effect: a variant may make them for all models, and those that do
# not resolve the effect go without. Any other switch is refused where it would change nothing.
CHOICES = ("end", "threads", "layers")


@dataclass(frozen=True, kw_only=True)
class Effect:
    """One effect of the vocabulary.

    Attributes
    ----------
    switch : field of Effects by which models that read it leave the effect out
    off : values of the switch that leave it out
    """

    switch: str
    off: tuple[str, ...]
    braid: bool = False  # only muscles with a braid have it


EFFECTS = {  # with what each adds to the energy
    "rubber": Effect(  # that of its law in the wall
        switch="rubber",
        off=(Rubber.NONE,),
    ),
    "wall_thickness": Effect(  # rubber, threads and pressure at their own radii, not all at one
        switch="wall",
        off=(Wall.ONE_RADIUS,),
    ),
    "thread_stretch": Effect(  # EA (lf - 1)^2 / 2 of the threads, in place of lf <= 1
        switch="stretch",
        off=(Stretch.RIGID,),
        braid=True,
    ),
    "slackening": Effect(  # no energy of threads that are shortened
        switch="threads",
        off=(ThreadLaw.TWO_WAY,),
        braid=True,
    ),
    "end_caps": Effect(  # the same energy of a wall that is held to its first radius at the caps
        switch="end",
        off=(End.SLIDING,),
    ),
    "cap_geometry": Effect(  # bending and shear of the wall, and the springs of the fitting
        switch="end",
        off=(End.SLIDING,),
    ),
    "twist": Effect(  # shear r tau of the wall, and threads turned by R tau
        switch="twist",
        off=(Twist.HELD,),
    ),
    "compressibility": Effect(  # - P^2 / (2 kappa)
        switch="volume",
        off=(Volume.INCOMPRESSIBLE,),
    ),
    "discrete_threads": Effect(  # that of the threads on single lines, not spread over their layer
        switch="layers",
        off=(Layers.SMEARED,),
        braid=True,
    ),
}


def switches(model: str, *, braided: bool) -> list[str]:
    """The switches that a model reads."""
    read = MODELS[model].switches
    return [s for s in KINDS if s in read and (braided or s not in OF_BRAID)]


def active(model: str, effects: Effects, *, braided: bool) -> list[str]:
    """Names of the effects that are on."""
    carried = MODELS[model]
    return [
        name
        for name, effect in EFFECTS.items()
        if name in carried.effects
        and (braided or not effect.braid)
        and not (
            effect.switch in carried.switches and getattr(effects, effect.switch) in effect.off
        )
    ]


DEFAULT = Effects()


def check_carried(model: str, effects: Effects) -> None:
    """Refuse a switch that was moved and that the model does not read.

    Raises
    ------
    UnsolvableCase
        Naming the models that carry it.
    """
    for name in KINDS.keys() - CHOICES:
        value, default = getattr(effects, name), getattr(DEFAULT, name)
        if value is not default and name not in MODELS[model].switches:
            able = ", ".join(other for other in MODELS if name in MODELS[other].switches)
            allowed = f"{default} with {model}; {value} with {able}"
            raise UnsolvableCase(name, value, allowed)
