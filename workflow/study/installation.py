"""What a muscle is built into and weighs. No part of a case: nothing is solved again for it."""

from dataclasses import dataclass, field

from geometry.refusal import Refusal, is_number

AIR = 0.101325  # MPa, at sea level


class UnusableInstallation(Refusal):
    """No muscle is built in so."""


@dataclass(frozen=True, kw_only=True)
class Installation:
    """Densities, fittings and air of a muscle; None where they are not known.

    Attributes
    ----------
    fitting_length : of each fitting, beyond the length between the caps
    fitting_mass : of both fittings together
    dead_volume : of fittings and hose up to the valve
    ambient_pressure : of the air around, to which pressures are added

    Raises
    ------
    UnusableInstallation
        Naming the field, its value and what is allowed.
    """

    density: float | None = field(default=None, metadata={"unit": "g/cm^3"})  # of the rubber
    thread_density: float | None = field(default=None, metadata={"unit": "g/cm^3"})
    thread_diameter: float | None = field(default=None, metadata={"unit": "mm"})
    fitting_length: float | None = field(default=None, metadata={"unit": "mm"})
    fitting_mass: float | None = field(default=None, metadata={"unit": "g"})
    dead_volume: float = field(default=0.0, metadata={"unit": "mm^3"})
    ambient_pressure: float = field(default=AIR, metadata={"unit": "MPa"})

    def __post_init__(self) -> None:
        for name in ("density", "thread_density", "ambient_pressure"):
            value = getattr(self, name)
            if value is not None and not (is_number(value) and value > 0):
                unit = "MPa" if name == "ambient_pressure" else "g/cm3"
                raise UnusableInstallation(name, value, f"a finite number > 0 ({unit})")
        for name, unit in (("fitting_length", "mm"), ("fitting_mass", "g"), ("dead_volume", "mm3")):
            value = getattr(self, name)
            if value is not None and not (is_number(value) and value >= 0):
                raise UnusableInstallation(name, value, f"a finite number >= 0 ({unit})")
