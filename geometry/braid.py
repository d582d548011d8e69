"""The braid of a muscle: its layers of helical threads, and which of them cannot be wound.

``Braid`` is that of the paper, two layers in the wall with one lead. ``LayeredBraid`` is any other:
layers in the wall and sleeves around it, each with numbers of its own. Lengths in mm.
"""

import math
from dataclasses import dataclass, field
from enum import StrEnum

from geometry.refusal import Refusal, is_count, is_number

MM, ONE = {"unit": "mm"}, {"unit": "1"}
MOST_LAYERS = 8  # of a braid; more is a slip of the pen
SAME = 1e-9  # two lengths this close, as a share, are one


class UnbuildableMuscle(Refusal):
    """No such muscle can be built."""


class Kind(StrEnum):
    """What carries a layer."""

    EMBEDDED = "embedded"  # the rubber at its depth in the wall
    SLEEVE = "sleeve"  # the outer surface, on which it lies where it is taut


@dataclass(frozen=True, kw_only=True)
class Layer:
    """One family of helical threads, all of one sense.

    Attributes
    ----------
    carrier : radius of the line of the unloaded wall that carries it [mm]
    radius : at which its threads have their free length when the muscle has its first one [mm]
    lead : axial length of one turn there [mm]
    threads : their number
    sense : 1 clockwise, -1 counter-clockwise
    share : of the stiffness EA of the muscle's thread
    crimp : radius of the collar that holds a sleeve; 0 where that is as wide as the tube [mm]
    """

    kind: Kind
    carrier: float
    radius: float
    lead: float
    threads: int
    sense: int
    share: float = 1.0
    crimp: float = 0.0

    @property
    def tangent(self) -> float:
        """Of the angle between thread and axis."""
        return 2 * math.pi * self.radius / self.lead


@dataclass(frozen=True, kw_only=True)
class Braid:
    """Two layers of threads with one lead: the inner clockwise, the outer counter-clockwise.

    The braid angle is that between thread and axis, stated at the mean layer diameter.

    Raises
    ------
    UnbuildableMuscle
        If a number is not positive and finite, or the layers are not inner first.
    """

    lead: float = field(metadata=MM)  # axial length of one turn
    threads: int = field(metadata=ONE)  # in each layer
    layer_diameters: tuple[float, float] = field(metadata=MM)  # inner layer first

    def __post_init__(self) -> None:
        _check_layers(self.layer_diameters)
        if not (is_number(self.lead) and self.lead > 0):
            raise UnbuildableMuscle("lead", self.lead, "a finite number > 0 (mm)")
        if not is_count(self.threads):
            raise UnbuildableMuscle("threads", self.threads, "an integer >= 1 (per layer)")

    @classmethod
    def from_angle(
        cls, *, angle: float, threads: int, layer_diameters: tuple[float, float]
    ) -> "Braid":
        """Braid of a given angle (degrees, between thread and axis) at the mean layer diameter."""
        _check_layers(layer_diameters)
        if not (is_number(angle) and 0 < angle < 90):
            raise UnbuildableMuscle("angle", angle, "more than 0 and less than 90 (degrees)")
        circumference = math.pi * sum(layer_diameters) / 2
        lead = circumference / math.tan(math.radians(angle))
        return cls(lead=lead, threads=threads, layer_diameters=layer_diameters)

    @property
    def mean_diameter(self) -> float:
        """Mean of the two layer diameters [mm]."""
        return sum(self.layer_diameters) / 2

    @property
    def angle(self) -> float:
        """Angle between thread and axis at the mean diameter [rad]."""
        return math.atan(math.pi * self.mean_diameter / self.lead)

    @property
    def layer_angles(self) -> tuple[float, float]:
        """Angle between thread and axis in each layer [rad]."""
        inner, outer = (math.atan(math.pi * d / self.lead) for d in self.layer_diameters)
        return inner, outer

    @property
    def axial_spacing(self) -> float:
        """Distance of neighbouring threads of one layer along the axis [mm]."""
        return self.lead / self.threads

    def layers(self, _outer_radius: float) -> tuple[Layer, ...]:
        """Its families of threads, inner first; ``_outer_radius`` of the tube carries none."""
        return tuple(
            Layer(
                kind=Kind.EMBEDDED,
                carrier=d / 2,
                radius=d / 2,
                lead=self.lead,
                threads=self.threads,
                sense=sense,
            )
            for d, sense in zip(self.layer_diameters, (1, -1), strict=True)
        )

    @property
    def embedded_diameters(self) -> tuple[float, ...]:
        """Of the lines in the wall that carry threads, inner first [mm]."""
        return self.layer_diameters

    @property
    def threads_each(self) -> float:
        """Threads of every layer."""
        return float(self.threads)


@dataclass(frozen=True, kw_only=True)
class LayeredBraid:
    """Layers in the wall and sleeves around it, each with numbers of its own, one list a number.

    Attributes
    ----------
    kinds : embedded or sleeve
    layer_diameters : at which threads have their free length when the muscle has its first one; of
        an embedded layer it is where it lies, of a sleeve less or more than the outer diameter
    leads : axial length of one turn there
    threads : in each family of a layer
    senses : 1 clockwise, -1 counter-clockwise, 0 a family of each
    stiffness_shares : EA of a thread, as a share of that of the muscle's thread
    crimp_radii : of the collar that holds a sleeve, 0 of others, which are held as wide as the tube
        or lie in the wall; none where all are so

    Raises
    ------
    UnbuildableMuscle
        Naming the field, its value and what is allowed.
    """

    kinds: tuple[str, ...] = field()
    layer_diameters: tuple[float, ...] = field(metadata=MM)
    leads: tuple[float, ...] = field(metadata=MM)
    threads: tuple[int, ...] = field(metadata=ONE)
    senses: tuple[int, ...] = field(metadata=ONE)
    stiffness_shares: tuple[float, ...] = field(metadata=ONE)
    crimp_radii: tuple[float, ...] = field(default=(), metadata=MM)

    def __post_init__(self) -> None:
        rules = {
            "kinds": (lambda v: v in list(Kind), f"each of {', '.join(Kind)}"),
            "layer_diameters": (_is_positive, "each a finite number > 0 (mm)"),
            "leads": (_is_positive, "each a finite number > 0 (mm)"),
            "threads": (is_count, "each an integer >= 1 (per family)"),
            "senses": (lambda v: is_number(v) and v in (1, -1, 0), "each 1, -1 or 0 (both)"),
            "stiffness_shares": (_is_positive, "each a finite number > 0"),
        }
        count = len(self.kinds) if isinstance(self.kinds, tuple) else 0
        for name, (is_right, allowed) in rules.items():
            values = getattr(self, name)
            if not (isinstance(values, tuple) and 1 <= len(values) == count <= MOST_LAYERS):
                raise UnbuildableMuscle(name, values, f"one value a layer, of 1 to {MOST_LAYERS}")
            if not all(map(is_right, values)):
                raise UnbuildableMuscle(name, values, allowed)
        self._check_crimps()

    def _check_crimps(self) -> None:
        """Refuse collars that hold no sleeve, or one that is narrower."""
        crimps = self.crimp_radii
        if crimps == ():
            return
        allowed = "none, or one value a layer, 0 or of one sleeve at most its radius (mm)"
        right = isinstance(crimps, tuple) and len(crimps) == len(self.kinds)
        right = right and all(is_number(value) and value >= 0 for value in crimps)
        held = [k for k, value in enumerate(crimps) if value > 0] if right else []
        if len(held) != 1 or self.kinds[held[0]] != Kind.SLEEVE:
            raise UnbuildableMuscle("crimp_radii", crimps, allowed)
        if crimps[held[0]] > self.layer_diameters[held[0]] / 2 * (1 + SAME):
            raise UnbuildableMuscle("crimp_radii", crimps, allowed)

    @property
    def layer_angles(self) -> tuple[float, ...]:
        """Angle between thread and axis in each layer [rad]."""
        pairs = zip(self.layer_diameters, self.leads, strict=True)
        return tuple(math.atan(math.pi * d / lead) for d, lead in pairs)

    @property
    def angle(self) -> float:
        """Mean of the layers' angles [rad]."""
        return sum(self.layer_angles) / len(self.layer_angles)

    @property
    def mean_diameter(self) -> float:
        """Mean of the layer diameters [mm]."""
        return sum(self.layer_diameters) / len(self.layer_diameters)

    @property
    def lead(self) -> float:
        """Axial length of one turn, if all layers have the same; else NaN [mm]."""
        return self.leads[0] if _are_same(self.leads) else math.nan

    @property
    def threads_each(self) -> float:
        """Threads of every family, if all have as many; else NaN."""
        return float(self.threads[0]) if len(set(self.threads)) == 1 else math.nan

    @property
    def embedded_diameters(self) -> tuple[float, ...]:
        """Of the lines in the wall that carry threads, inner first [mm]."""
        pairs = zip(self.kinds, self.layer_diameters, strict=True)
        return tuple(sorted({d for kind, d in pairs if kind == Kind.EMBEDDED}))

    @classmethod
    def of_lines(cls, diameters: tuple[float, ...]) -> "LayeredBraid":
        """Any braid with these lines in the wall."""
        count = len(diameters)
        return cls(
            kinds=(str(Kind.EMBEDDED),) * count,
            layer_diameters=diameters,
            leads=(1.0,) * count,
            threads=(1,) * count,
            senses=(0,) * count,
            stiffness_shares=(1.0,) * count,
        )

    @property
    def has_one_angle(self) -> bool:
        """Whether all layers have the same angle, or the same lead."""
        return _are_same(self.layer_angles) or _are_same(self.leads)

    def layers(self, outer_radius: float) -> tuple[Layer, ...]:
        """Its families of threads on a tube of an outer radius [mm]."""
        return tuple(
            Layer(
                kind=Kind(kind),
                carrier=outer_radius if kind == Kind.SLEEVE else diameter / 2,
                radius=diameter / 2,
                lead=lead,
                threads=threads,
                sense=each,
                share=share,
                crimp=crimp,
            )
            for kind, diameter, lead, threads, sense, share, crimp in zip(
                self.kinds,
                self.layer_diameters,
                self.leads,
                self.threads,
                self.senses,
                self.stiffness_shares,
                self.crimp_radii or (0.0,) * len(self.kinds),
                strict=True,
            )
            for each in ((sense,) if sense else (1, -1))
        )

    @property
    def is_mirrored(self) -> bool:
        """Whether to every family there is one that winds the other way: then nothing twists.

        Partners have the same number of threads and stiffness, and lie both in the wall with one
        lead or one angle, or are both sleeves of one shape.
        """
        left = [layer for layer in self.layers(1.0) if layer.sense < 0]
        for layer in (each for each in self.layers(1.0) if each.sense > 0):
            partner = next((each for each in left if _are_partners(layer, each)), None)
            if partner is None:
                return False
            left.remove(partner)
        return not left


AnyBraid = Braid | LayeredBraid


def _are_partners(one: Layer, other: Layer) -> bool:
    if one.kind != other.kind or one.threads != other.threads:
        return False
    same_lead = _are_same((one.lead, other.lead))
    same_angle = _are_same((one.tangent, other.tangent))
    if one.crimp != other.crimp:
        return False
    alike = same_lead and same_angle if one.kind is Kind.SLEEVE else same_lead or same_angle
    return alike and _are_same((one.share, other.share))


def _are_same(values: tuple[float, ...]) -> bool:
    return all(math.isclose(value, values[0], rel_tol=SAME) for value in values)


def _is_positive(value: object) -> bool:
    return is_number(value) and value > 0  # type: ignore[operator]


def _check_layers(diameters: object) -> None:
    """Two positive numbers, the inner layer first."""
    if not (
        isinstance(diameters, tuple)
        and len(diameters) == 2
        and all(is_number(d) for d in diameters)
        and 0 < diameters[0] < diameters[1]
    ):
        raise UnbuildableMuscle(
            "layer_diameters", diameters, "two positive numbers, the inner layer first (mm)"
        )
