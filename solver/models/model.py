"""What the rest asks of a model: one descriptor each, in ``solver/models/<name>/model.py``.

Functions of a descriptor get a case (solver/case.py), which itself asks for its model.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parent
SOLVER = FOLDER.parent
PARTS = ("effects", "rubber", "thread", "numerics")  # of a case, beside muscle and path


def _nothing(_case: Any) -> dict[str, str | float]:
    return {}


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
    threshold : whether there can be a pressure above none at which it has no force
    quantities : that a study may ask it for
    fields : columns of fields_<waypoint>.txt by name; none without fields
    flags, composition : what its program is told beside what all are; includes by the effects
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
    threshold: bool = True
    quantities: tuple[str, ...] = ()
    fields: Mapping[str, slice] = field(default_factory=dict)
    flags: Callable[[Any], dict[str, str | float]] = _nothing
    composition: Callable[[Any], list[str]] = _no_files
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
