"""The pneumatic muscle: its dimensions, and what cannot be built.

A straight rubber tube between two caps, reinforced by layers of helical threads
(geometry/braid.py). Lengths in mm. The muscle of the paper (DMSP-20-300, section 2.2) is::

    Muscle(
        inner_diameter=20,
        wall_thickness=2,
        length=300,
        braid=Braid(lead=144, threads=60, layer_diameters=(20.6, 21.8)),
    )
"""

from dataclasses import dataclass, field
from typing import Any

from geometry.braid import MM, ONE, AnyBraid, Braid, Layer, LayeredBraid, UnbuildableMuscle
from geometry.plain import plain
from geometry.refusal import build, is_number

__all__ = ["MM", "ONE", "AnyBraid", "Braid", "LayeredBraid", "Muscle", "UnbuildableMuscle"]


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
    braid: AnyBraid | None
    cap_length: float = field(default=8.0, metadata=MM)  # how far the tube runs on into a clamp

    def __post_init__(self) -> None:
        for name in ("inner_diameter", "wall_thickness", "length"):
            value = getattr(self, name)
            if not (is_number(value) and value > 0):
                raise UnbuildableMuscle(name, value, "a finite number > 0 (mm)")
        if not (is_number(self.cap_length) and self.cap_length >= 0):
            raise UnbuildableMuscle("cap_length", self.cap_length, "a finite number >= 0 (mm)")
        if self.braid is not None:
            lines = self.braid.embedded_diameters
            if lines and not self.inner_diameter < lines[0] <= lines[-1] < self.outer_diameter:
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
        """Radii of the lines in the wall that carry threads, inner first [mm]."""
        return tuple(d / 2 for d in self.braid.embedded_diameters) if self.braid else ()

    @property
    def layers(self) -> tuple[Layer, ...]:
        """Its families of threads; none of a bare tube."""
        return self.braid.layers(self.outer_radius) if self.braid else ()

    def as_dict(self) -> dict[str, Any]:
        """Plain values that JSON can hold; ``from_dict`` reads them back."""
        values = plain(self)
        if self.braid is not None:
            lists = {k: list(v) for k, v in values["braid"].items() if isinstance(v, tuple)}
            values["braid"] |= lists
            if values["braid"].get("crimp_radii") == []:
                del values["braid"]["crimp_radii"]
        return values

    @classmethod
    def from_dict(cls, values: object) -> "Muscle":
        """The muscle of a plain mapping; unknown and missing keys are refused."""
        if isinstance(values, dict) and values.get("braid") is not None:
            given = values["braid"]
            kind = LayeredBraid if isinstance(given, dict) and "kinds" in given else Braid
            braid = build(kind, given, UnbuildableMuscle, "muscle.braid")
            values = values | {"braid": braid}
        return build(cls, values, UnbuildableMuscle, "muscle")
