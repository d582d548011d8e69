"""Fields of a record for ParaView: VTU files, and PVD files that open all states as one series.

``a.pvd`` names the files ``a/<state>.vtu``, one for every state with fields, with what is swept, or
the time of a path in time, as ParaView's time. Points are deformed places in mm, with the way from
the unloaded muscle as ``displacement [mm]``: (r, z, 0) of one half of a section, from mid-length to
the fitting; or turned about the axis; or the whole muscle (workflow/data/deformed.py). A solid has
Cauchy stress at the corners of each triangle (no two triangles share a point, since stress is
discontinuous). A cell of the braid is a piece of the tube in x, y, z, with the stress of its rubber
and its threads. Field data are the numbers of the state, as in solver/record.py, and ``TimeValue``.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from geometry.files import atomic_write
from solver import record
from solver.case import DYNAMIC, Case
from solver.record import Solution
from workflow.data import deformed
from workflow.data.principal_stress import named, principal_of_six
from workflow.study.errors import StudyError

if TYPE_CHECKING:
    from workflow.plan.plan import Place, Plan

Array = NDArray[np.float64]
CELL_COMPONENTS = ("rr", "tt", "zz", "rt", "tz", "rz")
THREADS = {  # of a cell, unit by name
    "thread_stretch_1": "1",
    "thread_stretch_2": "1",
    "thread_density_1": "mm/mm^3",
    "thread_density_2": "mm/mm^3",
}
HOW = (
    "a scene with `quantities: [deformed_shape]` (models membrane, solid) or `[stress]` (solid) "
    "records them"
)
NONE = f"no state has fields; {HOW}"
GRID = b"<UnstructuredGrid>"  # of a VTU file, after which field data stand
TURNED = {"triangle": "wedge", "line": "quad"}  # what a cell becomes that is turned about the axis


@dataclass(frozen=True)
class View:
    """How fields are shown.

    Attributes
    ----------
    sectors : of a section that is turned about the axis; 0 leaves it a section
    whole : the whole muscle and its threads, in place of a section
    unloaded : points where they are on the unloaded muscle
    """

    sectors: int = 0
    whole: bool = False
    unloaded: bool = False


@dataclass(frozen=True)
class Parts:
    """Points, cells by kind, and what is known of them by name with unit."""

    before: Array
    after: Array
    cells: list[tuple[str, NDArray[np.int64]]]
    values: dict[str, Array]
    of_cells: dict[str, list[Array]]


def files(plan: "Plan") -> dict[str, str]:
    """File name -> case of every series that the scenes of a study ask for."""
    return {
        f"{name_of(place)}.pvd": key
        for places in plan.scenes.values()
        for place, key in places.items()
        if plan.cases[key].case.fields_at
    }


def name_of(place: "Place") -> str:
    """As files are called: ``dmsp20_solid_fine_isobaric_0.3``."""
    names = [place.scene] * bool(place.scene) + [place.muscle, place.model, place.variant]
    names += [place.group, f"{place.held:g}"] + [f"{place.period:g}s"] * bool(place.period)
    return "_".join(names)


def parts_of(series: Path) -> list[Path]:
    """The files that a series names; none if it is not there or damaged."""
    try:
        found = ElementTree.parse(series).iter("DataSet")
    except (OSError, ElementTree.ParseError):
        return []
    return [series.parent / each.attrib.get("file", "") for each in found]


def write(path: Path, state: int, output: Path, view: View | None = None) -> None:
    """Write the fields of one state of a record as VTU, whole or not at all.

    Raises
    ------
    StudyError
        If the record cannot be read, or has no fields of this state.
    """
    case, solution = _read(path)
    if state not in _states(solution):
        raise StudyError(f"{path}: no fields of state {state}; {_there(solution)}")
    _write(case, solution, state, output, view or View())


def write_series(path: Path, output: Path, view: View | None = None) -> int:
    """Write all states of a record that have fields as PVD and VTU; their number.

    A state that was not reached has none, as its case says why.

    Raises
    ------
    StudyError
        If the record cannot be read.
    """
    case, solution = _read(path)
    times = _times(case, solution)
    lines = []
    for state in _states(solution):
        part = output.with_suffix("") / f"{state:04d}.vtu"
        _write(case, solution, state, part, view or View())
        where = _quoted(f"{part.parent.name}/{part.name}")
        lines.append(f'    <DataSet timestep="{times[state]!r}" part="0" file={where}/>\n')
    with atomic_write(output) as beside:
        beside.write_text(
            '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n'
            f"  <!-- time is {_clock(case)} -->\n"
            f"  <Collection>\n{''.join(lines)}  </Collection>\n</VTKFile>\n"
        )
    return len(lines)


def _read(path: Path) -> tuple[Case, Solution]:
    try:
        return record.read(path)
    except record.NoRecord as error:
        raise StudyError(str(error)) from None


def _states(solution: Solution) -> list[int]:
    """Numbers of the states that have fields of the muscle."""
    return [n for n, arrays in sorted(solution.fields.items()) if set(arrays) - {DYNAMIC}]


def _there(solution: Solution) -> str:
    """What states have fields, or how they come to have some."""
    if found := _states(solution):
        return f"there are of {', '.join(map(str, found))}"
    return NONE


def _times(case: Case, solution: Solution) -> list[float]:
    """What is ParaView's time, of every state: time, what is swept, or the number of the state."""
    if "time" in solution.states:
        return [float(value) for value in solution.states["time"]]
    swept = solution.states[case.path.kind.swept.key][: len(case.path.stops)]
    stops = [float(stop) for stop in case.path.stops]
    if len(set(stops)) < len(stops):  # a path that comes to a stop again
        return [float(number) for number in range(len(solution.state_status))]
    return stops + [float(value) for value in swept[len(stops) :]]


def _clock(case: Case) -> str:
    """What ParaView's time is, with its unit."""
    if case.path.history is not None:
        return "that of the path [s]"
    if len(set(case.path.stops)) < len(case.path.stops):
        return "the number of the state"
    key = case.path.kind.swept.key
    return f"{key} [{record.VARIABLES[key][0]}]"


def _write(case: Case, solution: Solution, state: int, output: Path, view: View) -> None:
    """Write one state."""
    import meshio

    fields = {k: v for k, v in solution.fields[state].items() if k != DYNAMIC}
    parts = _whole(case, fields) if view.whole else _section(fields)
    if view.sectors and not view.whole:
        parts = _turned(parts, view.sectors)
    points = parts.before if view.unloaded else parts.after
    values = {"displacement [mm]": parts.after - parts.before} | parts.values
    if view.whole or view.sectors:  # large, and to be looked at: seven digits will do
        points = points.astype(np.float32)
        values = {name: each.astype(np.float32) for name, each in values.items()}
    mesh = meshio.Mesh(points, parts.cells, point_data=values, cell_data=parts.of_cells)
    numbers = {"TimeValue": _times(case, solution)[state]}
    for name, (unit, _) in record.variables(case).items():
        numbers[f"{name} [{unit}]"] = float(solution.states[name][state])
    with atomic_write(output) as beside:
        mesh.write(beside, file_format="vtu")
        beside.write_bytes(_with_numbers(beside.read_bytes(), numbers))


def _quoted(text: str) -> str:
    """An attribute of XML."""
    from xml.sax.saxutils import quoteattr  # late: it takes all of urllib along

    return quoteattr(text)


def _with_numbers(content: bytes, numbers: Mapping[str, float]) -> bytes:
    """A VTU file with numbers as field data, which meshio reads and does not write."""
    arrays = "".join(
        f'<DataArray type="Float64" Name={_quoted(name)} NumberOfTuples="1" format="ascii">'
        f"{value!r}</DataArray>\n"
        for name, value in numbers.items()
        if np.isfinite(value)
    )
    return content.replace(GRID, GRID + f"\n<FieldData>\n{arrays}</FieldData>".encode(), 1)


def _section(fields: dict[str, Array]) -> Parts:
    if "meridian" in fields:
        return _line(fields)
    return _cell(fields) if "threads" in fields else _wall(fields)


def _line(fields: dict[str, Array]) -> Parts:
    before, after = _places(fields["meridian"])
    nodes = np.arange(len(before))
    return Parts(before, after, [("line", np.column_stack([nodes[:-1], nodes[1:]]))], {}, {})


def _wall(fields: dict[str, Array]) -> Parts:
    before, after = _places(fields["corners"])
    cells = [("triangle", np.arange(len(before)).reshape(-1, 3))]
    return Parts(before, after, cells, named(fields["stress"]), {})


def _cell(fields: dict[str, Array]) -> Parts:
    before, after = (_cartesian(fields["corners"][:, k : k + 3]) for k in (0, 3))
    principal = principal_of_six(fields["stress"])
    data = {f"stress_{c} [MPa]": fields["stress"][:, k] for k, c in enumerate(CELL_COMPONENTS)}
    data |= {"largest_principal_stress [MPa]": principal[:, 2]}
    data |= {"smallest_principal_stress [MPa]": principal[:, 0]}
    data |= {
        f"{n} [{unit}]": fields["threads"][:, k] for k, (n, unit) in enumerate(THREADS.items())
    }
    cells = [("tetra", np.arange(len(before)).reshape(-1, 4))]
    return Parts(before, after, cells, data, {})


def _whole(case: Case, fields: dict[str, Array]) -> Parts:
    """All pieces of the whole muscle; what a piece has no values of is NaN there."""
    pieces = deformed.pieces(case, fields)
    sizes = [len(piece.after) for piece in pieces]
    names = dict.fromkeys(name for piece in pieces for name in piece.values)
    starts = np.cumsum([0, *sizes])
    return Parts(
        np.vstack([piece.before for piece in pieces]),
        np.vstack([piece.after for piece in pieces]),
        [(p.kind, p.cells + start) for p, start in zip(pieces, starts, strict=False)],
        {
            name: np.concatenate(
                [
                    piece.values.get(name, np.full(size, np.nan))
                    for piece, size in zip(pieces, sizes, strict=True)
                ]
            )
            for name in names
        },
        {deformed.PART: [np.full(len(piece.cells), float(piece.part)) for piece in pieces]},
    )


def _turned(section: Parts, sectors: int) -> Parts:
    """A section turned about the axis: triangles become wedges, lines quadrilaterals.

    Raises
    ------
    StudyError
        If it is no section.
    """
    ((kind, cells),) = section.cells
    if kind not in TURNED:
        raise StudyError("a cell of the braid is no section that could be turned about the axis")
    count = len(section.before)
    turns = np.repeat(2 * np.pi * np.arange(sectors) / sectors, count)

    def around(points: Array) -> Array:
        r, z = (np.tile(points[:, k], sectors) for k in (0, 1))
        return np.column_stack([r * np.cos(turns), r * np.sin(turns), z])

    here = cells + count * np.arange(sectors)[:, None, None]
    beside = cells + count * ((np.arange(sectors) + 1) % sectors)[:, None, None]
    if kind == "line":
        beside = beside[:, :, ::-1]
    joined = np.concatenate([here, beside], axis=2).reshape(-1, 2 * cells.shape[1])
    values = {name: np.tile(each, sectors) for name, each in section.values.items()}
    found = [(TURNED[kind], joined)]
    return Parts(around(section.before), around(section.after), found, values, {})


def _cartesian(rows: Array) -> Array:
    """x, y, z of rows radius, angle, height."""
    r, t, z = rows.T
    return np.column_stack([r * np.cos(t), r * np.sin(t), z])


def _places(rows: Array) -> tuple[Array, Array]:
    """Points of rows R, Z, r, z on the unloaded and the deformed muscle, with a zero at the end."""
    zero: Any = np.zeros((len(rows), 1))
    return np.hstack([rows[:, :2], zero]), np.hstack([rows[:, 2:], zero])
