"""Values that look as if they were given in another unit, and the guess in which."""

import re
from dataclasses import dataclass, field

from solver.rubber import LAWS
from workflow.study.values import is_possible

WRITTEN = re.compile(r"([-+]?\d+(?:[.,]\d+)?) ?([^\W\d]*|%|°)")  # a number and perhaps a unit
LENGTHS = {"m": 1e3, "um": 1e-3}  # in mm
CM = {"cm": 10.0}  # of what is written with its unit; nobody means 0.3 cm by 0.3
DEGREES = ("°", "deg", "degree")
STRESSES = {"kPa": 1e-3, "Pa": 1e-6}  # in MPa


@dataclass(frozen=True)
class Usual:
    """Where the values of a key lie in practice, widely; and what else they may have been given in.

    Attributes
    ----------
    others : unit: its size in the unit of the study file
    """

    unit: str
    low: float
    high: float
    others: dict[str, float] = field(hash=False)

    def guess(self, value: float) -> str:
        """``300 kPa, that is 0.3 MPa`` where an unusual value is a usual one in another unit."""
        if self.low <= abs(value) <= self.high or not value:
            return ""
        return " or ".join(
            f"{value:g} {unit}, that is {value * size:.6g} {self.unit}".rstrip()
            for unit, size in self.others.items()
            if self.low <= abs(value * size) <= self.high
        )


PRESSURE = Usual("MPa", 0.05, 1.2, STRESSES | {"bar": 0.1, "psi": 0.00689476})
OF_RUBBER = {
    parameter.name: Usual("MPa", *parameter.usual, STRESSES | {"GPa": 1e3})
    for law in LAWS.values()
    for parameter in law.parameters()
    if parameter.unit == "MPa"
}
USUAL = OF_RUBBER | {
    "kappa": Usual("MPa", 10, 1e5, STRESSES | {"GPa": 1e3}),
    "inner_diameter": Usual("mm", 0.1, 500, LENGTHS),
    "wall_thickness": Usual("mm", 0.005, 100, LENGTHS),
    "length": Usual("mm", 1, 20_000, LENGTHS),
    "cap_length": Usual("mm", 0.005, 1000, LENGTHS),
    "layer_depths": Usual("mm", 0.002, 100, LENGTHS),
    "depth": Usual("mm", 0.002, 100, LENGTHS),
    "gap": Usual("mm", 0.002, 100, LENGTHS),
    "free_radius": Usual("mm", 0.05, 500, LENGTHS),
    "crimp_radius": Usual("mm", 0.05, 500, LENGTHS),
    "free_length": Usual("mm", 1, 20_000, LENGTHS),
    "thread_modulus": Usual("MPa", 10, 1e6, {"GPa": 1e3, "Pa": 1e-6}),
    "thread_diameter": Usual("mm", 0.002, 20, LENGTHS),
    "lead": Usual("mm", 0.5, 20_000, LENGTHS),
    "angle": Usual("degrees", 2, 90, {"rad": 57.29578}),
    "thread_stiffness": Usual("N", 0.01, 1e6, {"kN": 1e3, "mN": 1e-3}),
    "pressure": PRESSURE,
    "fit_pressure": PRESSURE,
    "report_pressure": PRESSURE,
    "contraction": Usual("", 0.01, 0.6, {"%": 0.01}),
    "tolerance": Usual("", 1e-6, 0.999, {"%": 0.01}),
    "density": Usual("g/cm3", 0.5, 10, {"kg/m3": 1e-3}),
    "thread_density": Usual("g/cm3", 0.5, 10, {"kg/m3": 1e-3}),
    "fitting_length": Usual("mm", 1, 1000, LENGTHS),
    "fitting_mass": Usual("g", 0.01, 10_000, {"kg": 1e3}),
    "dead_volume": Usual("mm3", 1, 1e7, {"ml": 1e3, "l": 1e6}),
    "ambient_pressure": Usual("MPa", 0.03, 0.5, STRESSES | {"bar": 0.1}),
    "memory": Usual("MB", 100, 1e6, {"GB": 1e3, "kB": 1e-3}),
    "modulus": Usual("MPa", 10, 1e6, {"GPa": 1e3, "Pa": 1e-6}),
}


def guess(key: object, value: object) -> str:
    """What a value of a key, or the first such value of a list, may have meant; else empty."""
    usual = USUAL.get(str(key))
    values = value if isinstance(value, list | tuple) else [value]
    numbers = [v for v in values if is_possible(v)]
    found = [usual.guess(v) for v in numbers] if usual else []
    found += [_written(usual, v) for v in values if isinstance(v, str)] if usual else []
    return next((said for said in found if said), "")


def _written(usual: Usual, text: str) -> str:
    """What a text was meant to be: a number with a decimal comma, or one with its unit."""
    parts = WRITTEN.fullmatch(text.strip())
    if parts is None:
        return ""
    number, unit = parts[1].replace(",", "."), parts[2]
    others = usual.others | (CM if usual.unit == "mm" else {})
    if unit in others:
        size = float(number) * others[unit]
        return f"{number} {unit}, that is {size:.6g} {usual.unit}".rstrip()
    own = {"", usual.unit, *(DEGREES if usual.unit == "degrees" else ())}
    return f"{number}, with a decimal point and without a unit" if unit in own else ""
