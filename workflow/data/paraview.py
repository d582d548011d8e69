"""Fields of a record as a VTU file, which ParaView opens.

Points are reference positions (R, Z, 0) in mm with the displacement as a vector, so "Warp By
Vector" shows the deformed wall; a solid has Cauchy stress and principal stresses in MPa at the
corners of each triangle (no two triangles share a point, since stress is discontinuous). A cell of
the braid is a piece of the tube in x, y, z, with the stress of its rubber and its threads.
"""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from geometry.files import atomic_write
from solver import record
from workflow.data.principal_stress import principal_of_four, principal_of_six
from workflow.study.errors import StudyError

if TYPE_CHECKING:
    from workflow.plan.plan import Plan

COMPONENTS = ("rr", "rz", "zz", "tt")
CELL_COMPONENTS = ("rr", "tt", "zz", "rt", "tz", "rz")
THREADS = ("thread_stretch_1", "thread_stretch_2", "thread_density_1", "thread_density_2")


def files(plan: "Plan") -> dict[str, tuple[str, int]]:
    """File name -> case and state, for all fields that the scenes of a study ask for.

    Of a stop that a path comes to more than once the name has the number of the state as well.
    """
    found = {}
    for places in plan.scenes.values():
        for place, key in places.items():
            case = plan.cases[key].case
            stops = case.path.stops
            for state, stop in enumerate(stops):
                if stop in case.fields_at:
                    names = [place.muscle, place.model, place.variant, place.group]
                    names += [f"{place.held:g}", f"{stop:g}"]
                    names += [f"{state}"] * (stops.count(stop) > 1)
                    found["_".join(names) + ".vtu"] = (key, state)
    return found


def write(path: Path, state: int, output: Path) -> None:
    """Write the fields of one state of a record, whole or not at all.

    A state that was not reached becomes an empty file, as its case says why.

    Raises
    ------
    StudyError
        If the record cannot be read.
    """
    import meshio

    try:
        solution = record.read(path)[1]
    except record.NoRecord as error:
        raise StudyError(str(error)) from None
    fields = {k: v for k, v in solution.fields.get(state, {}).items() if k != record.DYNAMIC}
    with atomic_write(output) as beside:
        if not fields:
            beside.touch()
            return
        points, cells, data = _parts(fields)
        meshio.Mesh(points, cells, point_data=data).write(beside, file_format="vtu")


Parts = tuple[NDArray[np.float64], dict[str, NDArray[np.int64]], dict[str, NDArray[np.float64]]]


def _parts(fields: dict[str, NDArray[np.float64]]) -> Parts:
    if "meridian" in fields:
        return _line(fields)
    return _cell(fields) if "threads" in fields else _wall(fields)


def _line(fields: dict[str, NDArray[np.float64]]) -> Parts:
    points, displacement = _places(fields["meridian"])
    nodes = np.arange(len(points))
    return (
        points,
        {"line": np.column_stack([nodes[:-1], nodes[1:]])},
        {"displacement": displacement},
    )


def _wall(fields: dict[str, NDArray[np.float64]]) -> Parts:
    points, displacement = _places(fields["corners"])
    largest, smallest = principal_of_four(fields["stress"])
    data = {"displacement": displacement}
    data |= {f"stress_{c}": fields["stress"][:, k] for k, c in enumerate(COMPONENTS)}
    data |= {"largest_principal_stress": largest, "smallest_principal_stress": smallest}
    return points, {"triangle": np.arange(len(points)).reshape(-1, 3)}, data


def _cell(fields: dict[str, NDArray[np.float64]]) -> Parts:
    before, after = (_cartesian(fields["corners"][:, k : k + 3]) for k in (0, 3))
    stresses = principal_of_six(fields["stress"])
    data = {"displacement": after - before}
    data |= {f"stress_{c}": fields["stress"][:, k] for k, c in enumerate(CELL_COMPONENTS)}
    data |= {"largest_principal_stress": stresses[:, 2]}
    data |= {"smallest_principal_stress": stresses[:, 0]}
    data |= {name: fields["threads"][:, k] for k, name in enumerate(THREADS)}
    return before, {"tetra": np.arange(len(before)).reshape(-1, 4)}, data


def _cartesian(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """x, y, z of rows radius, angle, height."""
    r, t, z = rows.T
    return np.column_stack([r * np.cos(t), r * np.sin(t), z])


def _places(rows: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Points and displacements of rows R, Z, r, z, with a third component of zero."""
    zero = np.zeros((len(rows), 1))
    return np.hstack([rows[:, :2], zero]), np.hstack([rows[:, 2:] - rows[:, :2], zero])
