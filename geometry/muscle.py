"""The pneumatic muscle: its dimensions, and what cannot be built.

A straight rubber tube between two caps, reinforced by two layers of helical threads. Lengths in
mm. The muscle of the paper (DMSP-20-300, section 2.2) is::

    Muscle(
        inner_diameter=20,
        wall_thickness=2,
        length=300,
        braid=Braid(lead=144, threads=60, layer_diameters=(20.6, 21.8)),
    )
"""

import math
from dataclasses import asdict, dataclass, field
from typing import Any

from geometry.refusal import Refusal, build, is_count, is_number

MM, ONE = {"unit": "mm"}, {"unit": "1"}


class UnbuildableMuscle(Refusal):
    """No such muscle can be built."""


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


@dataclass(frozen=True, kw_only=True)
class Muscle:
    """A tube of ``length`` between its caps, with a braid or without (bare tube).

    Raises
    ------
    UnbuildableMuscle
        Naming the field, its value and what is allowed.
    """

    inner_diameter: float = field(metadata=MM)
    wall_thickness: float = field(metadata=MM)
    length: float = field(metadata=MM)  # between the caps
    braid: Braid | None
    cap_length: float = field(default=8.0, metadata=MM)  # how far the tube runs on into a clamp

    def __post_init__(self) -> None:
        for name in ("inner_diameter", "wall_thickness", "length"):
            value = getattr(self, name)
            if not (is_number(value) and value > 0):
                raise UnbuildableMuscle(name, value, "a finite number > 0 (mm)")
        if not (is_number(self.cap_length) and self.cap_length >= 0):
            raise UnbuildableMuscle("cap_length", self.cap_length, "a finite number >= 0 (mm)")
        if self.braid is not None:
            inner, outer = self.braid.layer_diameters
            if not self.inner_diameter < inner < outer < self.outer_diameter:
                raise UnbuildableMuscle(
                    "layer_diameters",
                    self.braid.layer_diameters,
                    "inside the wall, more than the inner diameter "
                    f"{self.inner_diameter} and less than the outer {self.outer_diameter} (mm)",
                )

    @property
    def outer_diameter(self) -> float:
        """Of the tube [mm]."""
        return self.inner_diameter + 2 * self.wall_thickness

    @property
    def inner_radius(self) -> float:
        """Of the tube [mm]."""
        return self.inner_diameter / 2

    @property
    def outer_radius(self) -> float:
        """Of the tube [mm]."""
        return self.outer_diameter / 2

    @property
    def layer_radii(self) -> tuple[float, ...]:
        """Radii of the thread layers, inner first; empty for a bare tube [mm]."""
        return tuple(d / 2 for d in self.braid.layer_diameters) if self.braid else ()

    def as_dict(self) -> dict[str, Any]:
        """Plain values that JSON can hold; ``from_dict`` reads them back."""
        values = asdict(self)
        if self.braid is not None:
            values["braid"]["layer_diameters"] = list(self.braid.layer_diameters)
        return values

    @classmethod
    def from_dict(cls, values: object) -> "Muscle":
        """The muscle of a plain mapping; unknown and missing keys are refused."""
        if isinstance(values, dict) and values.get("braid") is not None:
            braid = build(Braid, values["braid"], UnbuildableMuscle, "muscle.braid")
            values = values | {"braid": braid}
        return build(cls, values, UnbuildableMuscle, "muscle")


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
