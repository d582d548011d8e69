"""The HDF5 record of one solved case: its layout, writing, reading.

Layout, version 5
-----------------
(512 bytes)  one line of text: file type, layout, and the SHA-256 of all that follows these bytes,
             in what HDF5 calls the user block; programs that read HDF5 skip it
/            attrs: filetype "muscle-case", layout, key, case (canonical JSON, solver/case.py),
             code (digest of the sources that solved it), version (of the software, for people),
             status, reason, log (its end, if failed), effects (names of those that are on),
             unknowns (beside contraction and pressure)
/parameters  one scalar dataset per number of the case, in groups as in the JSON;
             attrs: units, and relative_to where it is a multiple of something
/states      datasets of shape (state,) as in VARIABLES, attrs: units, long_name; and of
             texts: status; flags, words of solver/status.py with spaces between; note, a sentence.
             States are in the order of the path's stops, then that of zero force if asked for.
             What was not reached is NaN. Of a path in time there are those of IN_TIME too, of a
             muscle with a sleeve that of SLEEVED.
/fields/<n>  of state n, where asked for. Membrane: meridian (node, 4) = R, Z, r, z [mm].
             Solid: corners (3 triangles, 4) = R, Z, r, z [mm] and stress (3 triangles, 4) =
             Cauchy rr, rz, zz, tt [MPa], three rows per triangle, discontinuous between them.
             Cell: corners (4 tetrahedra, 6) = R, T, Z, r, t, z [mm, rad], stress (.., 6) = Cauchy
             stress of the rubber rr, tt, zz, rt, tz, rz [MPa], threads (.., 4) = thread stretch
             of both layers [1] and their densities [mm/mm^3].
             Of every state where frequencies are asked for: dynamic_stiffness (frequency, 3) =
             frequency [Hz], storage and loss stiffness [N/mm].

A record is complete or absent (geometry/files.py). It holds no time and no date, so that the same
case solved again gives the same bytes.
"""

import hashlib
import io
import json
import re
from collections.abc import Iterable
from dataclasses import dataclass, field, fields
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geometry.braid import Kind
from geometry.files import atomic_write
from solver import sources
from solver.case import Case
from solver.declared import Declared
from solver.plain_hdf5 import put
from solver.status import CaseStatus, Flag, StateStatus

FILETYPE, LAYOUT = "muscle-case", 5
BLOCK = 512  # bytes before the HDF5 data
LARGEST = 2**31  # bytes of a record that is read
PASSPORT = ("filetype", "layout", "key", "case", "code", "status", "reason", "log", "unknowns")

VARIABLES = {
    # name: (unit, long name)
    "contraction": ("1", "contraction, 1 - l/L"),
    "pressure": ("MPa", "pressure"),
    "force": ("N", "force of the muscle, positive where it pulls"),
    "force_cap": ("N", "force from the reaction at the cap"),
    "force_midplane": ("N", "force from the reaction at mid-length"),
    "volume": ("mm^3", "enclosed volume"),
    "inner_diameter_inflated": ("mm", "inner diameter at mid-length"),
    "outer_diameter": ("mm", "largest outer diameter anywhere"),
    "bulge": ("mm", "largest difference of inner radii around the tube"),
    "twist": ("rad/mm", "twist of the muscle per initial length"),
    "torque": ("N*mm", "torque that holds the ends"),
    "equivalent_diameter": ("mm", "equivalent diameter, sign(F) sqrt(4 |F| / (pi p))"),
    "thread_stretch_min": ("1", "smallest thread stretch"),
    "thread_stretch_max": ("1", "largest thread stretch"),
    "rubber_stretch_max": ("1", "largest principal stretch of the rubber at a quadrature point"),
    "min_det_f": ("1", "smallest det F at a quadrature point"),
    "min_det_f_nodes": ("1", "smallest det F at a corner of an element"),
    "margin": ("1", "smallest of what must stay positive (solver/path/state.idp)"),
    "energy": ("N*mm", "strain energy of the muscle"),
    "stiffness": ("N/mm", "dF/dl at fixed pressure"),
    "force_by_pressure": ("N/MPa", "dF/dp at fixed length"),
    "volume_by_pressure": ("mm^3/MPa", "dV/dp at fixed length"),
    "smoothing": ("N", "force that the smoothing of the slack law adds"),
    "smoothing_rate": ("N", "its derivative by the strain over which threads slacken"),
    "unstable_modes": ("1", "unstable modes at fixed contraction and pressure"),
    "residual": ("1", "largest residual, share of the largest nodal force"),
    "iterations": ("1", "Newton iterations since the state before"),
    "cutbacks": ("1", "steps given up since the state before"),
}
SLEEVED = {  # beside them, of a muscle with a sleeve
    "contact_pressure": ("MPa", "pressure of the sleeves on the tube at mid-length"),
}
IN_TIME = {  # beside them, of a path in time
    "time": ("s", "time since the first stop"),
    "work": ("N*mm", "work done on the muscle by its force and pressure since the first stop"),
    "dissipated": ("N*mm", "energy dissipated in the muscle since the first stop"),
}


def variables(case: Case) -> dict[str, tuple[str, str]]:
    """Unit and long name of what is recorded of a state of a case."""
    sleeved = any(layer.kind is Kind.SLEEVE for layer in case.muscle.layers)
    timed = case.path.history is not None
    return VARIABLES | (SLEEVED if sleeved else {}) | (IN_TIME if timed else {})


class NoRecord(ValueError):
    """A file that is no record, or not of this layout, or not of the case it should hold."""


@dataclass(frozen=True, kw_only=True)
class Solution:
    """What solving a case has given; it always has a status, whatever happened.

    Attributes
    ----------
    states : arrays of shape (state,), as in ``variables``; NaN where not reached
    flags, notes : of every state, beside its status; left out, there are no flags, and notes are
        the reason where a state was not reached
    fields : state number -> name -> array, as in the layout
    log : end of the solver's output where it failed
    unknowns : what was solved for beside contraction and pressure; 0 if nothing was solved
    code : digest of the sources that solved it; left out, of those that there are
    """

    status: CaseStatus
    reason: str
    states: dict[str, NDArray[np.float64]]
    state_status: list[StateStatus]
    flags: list[frozenset[Flag]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    fields: dict[int, dict[str, NDArray[np.float64]]] = field(default_factory=dict)
    log: str = ""
    unknowns: int = 0
    code: str = ""

    def __post_init__(self) -> None:
        each = self.state_status
        missing = [self.reason if s is StateStatus.NOT_REACHED else "" for s in each]
        object.__setattr__(self, "flags", self.flags or [frozenset()] * len(each))
        object.__setattr__(self, "notes", self.notes or missing)


def unreached(count: int, names: Iterable[str] = VARIABLES) -> dict[str, NDArray[np.float64]]:
    """States of which none was reached."""
    return {name: np.full(count, np.nan) for name in names}


def write(path: Path, case: Case, solution: Solution) -> None:
    """Write the record of a case, whole or not at all."""
    import h5py

    content = io.BytesIO()  # HDF5 crashes where it cannot write to the disk
    with h5py.File(content, "w", userblock_size=BLOCK) as file:
        _write(file, case, solution)
    with atomic_write(path) as beside:
        beside.write_bytes(sealed(content.getvalue()))


def _write(file: Any, case: Case, solution: Solution) -> None:
    file.attrs.update(
        filetype=FILETYPE,
        layout=LAYOUT,
        key=case.key,
        case=case.canonical(),
        code=solution.code or code_digest(case.model, law=case.rubber.law()),
        version=sources.version(),
        status=solution.status.value,
        reason=solution.reason,
        log=solution.log,
        effects=" ".join(case.active_effects),
        unknowns=solution.unknowns,
    )
    _write_parameters(file.create_group("parameters"), case)
    states = file.create_group("states")
    for name, (unit, long_name) in variables(case).items():
        put(states, name, solution.states[name], {"units": unit, "long_name": long_name})
    words: dict[str, list[str]] = {
        "status": [status.value for status in solution.state_status],
        "flags": [" ".join(sorted(flags)) for flags in solution.flags],
        "note": solution.notes,
    }
    for name, texts in words.items():
        put(states, name, np.array([text.encode() for text in texts], "S"), {})
    for number, arrays in sorted(solution.fields.items()):
        group = file.create_group(f"fields/{number}")
        for name, values in arrays.items():
            put(group, name, values, {})


def read(path: Path) -> tuple[Case, Solution]:
    """Read a record.

    Raises
    ------
    NoRecord
        If the file is no record, is damaged, or has another layout.
    """
    import h5py

    try:
        _check_seal(path)
        with h5py.File(path) as file:
            return _read(file, path.stat().st_size)
    except (OSError, KeyError, OverflowError, RuntimeError, TypeError, ValueError) as error:
        raise NoRecord(f"{path}: no readable record ({error})") from error


def code_of(path: Path) -> str:
    """Digest of the sources that solved a record that is there; raises NoRecord as ``read``."""
    import h5py

    try:
        _check_seal(path)
        with h5py.File(path) as file:
            return str(file.attrs["code"])
    except (OSError, KeyError, RuntimeError, ValueError) as error:
        raise NoRecord(f"{path}: no readable record ({error})") from error


def sealed(content: bytes) -> bytes:
    """The content of a record with its checksum in the first bytes."""
    return _head(content[BLOCK:]) + content[BLOCK:]


def _head(data: bytes) -> bytes:
    text = f"{FILETYPE} layout {LAYOUT} sha256 {hashlib.sha256(data).hexdigest()}\n"
    return text.encode().ljust(BLOCK, b"\0")


def _check_seal(path: Path) -> None:
    """Raise ValueError unless the file is as it was written, to the last bit.

    HDF5 itself notices few flipped bytes, and some it does not survive.
    """
    if path.exists() and not path.is_file():
        raise ValueError("it is no file")
    if path.stat().st_size > LARGEST:
        raise ValueError(f"it has {path.stat().st_size} bytes; at most {LARGEST} are read")
    content = path.read_bytes()
    if content != sealed(content):
        kind = f"{FILETYPE} layout {LAYOUT}"
        begin = content[:BLOCK].partition(b" sha256")[0].decode(errors="replace")
        if begin == kind:
            raise ValueError("it has changed since it was written")
        if re.fullmatch(f"{FILETYPE} layout [0-9]+", begin):
            raise ValueError(f"it is a {begin}, of another version of this program, no {kind}")
        raise ValueError(f"it does not begin with {kind!r}")


def _read(file: Any, size: int) -> tuple[Case, Solution]:
    """Case and solution of an open file; raises ValueError and others if it is no record."""
    declared = Declared(file, size)
    declared.attributes(PASSPORT)
    attributes = file.attrs
    found = attributes["filetype"], attributes["layout"]
    if found != (FILETYPE, LAYOUT):
        raise ValueError(f"expected {FILETYPE}, layout {LAYOUT}; found {found}")
    case = Case.from_json(attributes["case"])
    if case.key != attributes["key"]:
        raise ValueError(f"its case is {case.key}, its key {attributes['key']}")
    states, shape = declared.child(file, "states"), (case.path.states,)

    def texts(name: str) -> list[str]:
        return [text.decode() for text in declared.dataset(states, name, "S", shape)]

    return case, Solution(
        status=CaseStatus(attributes["status"]),
        reason=attributes["reason"],
        log=attributes["log"],
        unknowns=int(attributes["unknowns"]),
        code=attributes["code"],
        states={name: declared.dataset(states, name, "f", shape) for name in variables(case)},
        state_status=[StateStatus(text) for text in texts("status")],
        flags=[frozenset(map(Flag, text.split())) for text in texts("flags")],
        notes=texts("note"),
        fields=_read_fields(file, declared),
    )


def _read_fields(file: Any, declared: Declared) -> dict[int, dict[str, NDArray[np.float64]]]:
    """The fields of all states that have some."""
    if "fields" not in file:
        return {}
    fields = declared.child(file, "fields")
    groups = {int(number): declared.child(fields, number) for number in fields}
    return {
        number: {name: declared.dataset(group, name, "f", (None, None)) for name in group}
        for number, group in groups.items()
    }


@cache
def code_digest(*models: str, law: str = "") -> str:
    """Digest of the sources that decide the results of some models with a law of rubber."""
    files = sorted({file for model in models for file in sources.of_solve(model, law)})
    return sources.digest(tuple(files))


def _write_parameters(group: Any, case: Case) -> None:
    """One scalar (or list) dataset per value of the case; numbers with their unit."""
    for name, (value, attributes) in parameters(case).items():
        put(group, name, value, attributes)


def parameters(case: Case) -> dict[str, tuple[Any, dict[str, str]]]:
    """All values of a case and their attributes, by their place in /parameters.

    Units stand where the numbers are declared, in the metadata of the fields; where they go with
    another value, in ``units`` of the part.
    """
    found: dict[str, tuple[Any, dict[str, str]]] = {}

    def walk(part: Any, values: dict[str, Any], place: str) -> None:
        declared = {entry.name: entry.metadata for entry in fields(part)}
        units: dict[str, str] = getattr(part, "units", {})
        for name, value in values.items():
            if isinstance(value, dict):
                walk(getattr(part, name), value, f"{place}{name}/")
            elif _is_numeric(value):
                unit = units.get(name) or declared[name]["unit"]
                said = declared[name].items()
                relative = {k: v for k, v in said if isinstance(v, str) and k != "unit"}
                found[place + name] = value, {"units": unit, **relative}
            elif value is not None:
                found[place + name] = value, {}

    walk(case, json.loads(case.canonical()), "")
    return found


def _is_numeric(value: Any) -> bool:
    """Whether it is a number, or a list of them."""
    first = value[0] if isinstance(value, list) else value
    return isinstance(first, int | float) and not isinstance(first, bool)
