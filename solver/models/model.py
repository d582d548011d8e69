"""What the rest asks of a model: one descriptor each, in ``solver/models/<name>/model.py``.

Functions of a descriptor get a case (solver/case.py), which itself asks for its model.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from geometry.braid import AnyBraid, LayeredBraid

FOLDER = Path(__file__).parent
SOLVER = FOLDER.parent
PARTS = ("effects", "rubber", "thread", "numerics")  # of a case, beside muscle and path
LINES = 2  # of threads in the wall that a section has labels for


def _twists(braid: AnyBraid) -> str:
    if isinstance(braid, LayeredBraid) and not braid.is_mirrored:
        return (
            "cylinder, with the twist held or free: without a family that winds the other way at "
            "the same angle, number and stiffness a muscle twists, and no plane of symmetry is left"
        )
    return ""


def _many(braid: AnyBraid) -> str:
    if len(braid.embedded_diameters) > LINES:
        return f"cylinder, membrane: {LINES} embedded layers at most"
    return ""


def _many_angles(braid: AnyBraid) -> str:
    if isinstance(braid, LayeredBraid) and not braid.has_one_angle:
        return "cylinder: Eq. (1) has one braid angle, and the layers have several"
    return ""


def _many_leads(braid: AnyBraid) -> str:
    if isinstance(braid, LayeredBraid):
        return (
            "cylinder, membrane, solid: a cell of the braid repeats only where two embedded layers "
            "have one lead, number and stiffness"
        )
    return ""


# What is allowed in place of a model of some kind, by the braid; empty if the braid is of it.
BRAIDS: dict[str, Callable[[AnyBraid], str]] = {
    "any": lambda _: "",
    "mirrored": _twists,
    "mirrored, two lines": lambda braid: _twists(braid) or _many(braid),
    "one angle": lambda braid: _many_angles(braid) or _twists(braid),
    "one lead": _many_leads,
}


def _nothing(_case: Any) -> dict[str, str | float]:
    return {}


def _no_remarks(_case: Any, _states: Any) -> list[str]:
    return []


def _no_files(_case: Any) -> list[str]:
    return []


@dataclass(frozen=True, kw_only=True)
class Model:
    """A model of the muscle.

    Attributes
    ----------
    name : of its folder, and in study files
    rank : its place where models are listed, cheapest first; and its line in figures
    label : in figures
    mesh, suffix : kind of its mesh (geometry/<kind>.py) and ending of the file; None without
    parts : what it reads of a case
    unread : fields of the muscle that it does not read
    switches, effects : of solver/effects.py; the switches that it reads, the effects it carries
    numerics : groups of settings that it reads, beside those of its switches
    frame : in which its program asks for the law of the rubber (an include of it); none without
    compressible : whether it reads the bulk modulus
    needs_braid : whether it is of no bare tube
    braids : of which braids it is; the words are keys of BRAIDS
    threshold : whether there can be a pressure above none at which it has no force
    quantities : that a study may ask it for
    fields : columns of fields_<waypoint>.txt by name; none without fields
    flags, composition : what its program is told beside what all are; includes by the effects
    remarks : from a case and its states, what to say of each beside its status, or nothing
    solve : of a model in Python, from a case to its solution; imports late
    fuller, lacks : model of which it is a simplification, and the effect (or step of
        workflow/plan/effect_costs.csv) that it leaves out; without either it is not weighed
    in_time : whether it follows a history: a rubber with a memory, a mass, a valve
    crumples : whether it has no state of a shortened muscle without pressure
    only_for : effect without which it is not weighed, as it is dear
    """

    name: str
    rank: int
    label: str
    mesh: str | None = None
    suffix: str = "mesh"
    parts: tuple[str, ...] = PARTS
    unread: tuple[str, ...] = ()
    switches: tuple[str, ...] = ()
    effects: tuple[str, ...] = ()
    numerics: tuple[str, ...] = ()
    frame: str = ""
    compressible: bool = False
    needs_braid: bool = False
    braids: str = "any"
    threshold: bool = True
    quantities: tuple[str, ...] = ()
    fields: Mapping[str, slice] = field(default_factory=dict)
    flags: Callable[[Any], dict[str, str | float]] = _nothing
    composition: Callable[[Any], list[str]] = _no_files
    remarks: Callable[[Any, Any], list[str]] = _no_remarks
    solve: Callable[[Any], Any] | None = None
    fuller: str = ""
    lacks: str = ""
    in_time: bool = False
    crumples: bool = False
    only_for: str = ""

    @property
    def program(self) -> Path:
        """Its FreeFEM program."""
        return FOLDER / self.name / f"{self.name}.edp"

    @property
    def includes(self) -> list[Path]:
        """Folders in which its program finds its includes, but those of the rubber's law."""
        shared = ("models", "path", "threads")
        return [FOLDER / self.name, *(SOLVER / name for name in shared)]
