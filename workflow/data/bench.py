"""The forces that a muscle is fitted to: one of the reference maps, or a CSV file of one's own."""

import csv
from collections import Counter
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from workflow.data import reference
from workflow.data.reference import CONTRACTIONS, ForceMap
from workflow.study import user_file
from workflow.study.errors import StudyError, choices

COLUMNS = ("pressure_MPa", "force_N")
PLACES = ("contraction", "length_mm")  # one of them
FURTHEST = 0.2  # contraction, as in workflow/deviation.py
FEW = 5  # points of a curve


def read(name: str, length: float) -> ForceMap:
    """A map by the name of a reference, or by the path of a CSV file (it contains a dot or slash).

    A file has the columns ``pressure_MPa``, ``force_N`` and either ``contraction`` (fraction) or
    ``length_mm``, the length under test of a muscle that is ``length`` [mm] long at rest; rows
    whose ``suspect`` is 1 are not used. A force of 0 at a length means slack and is not used.

    Raises
    ------
    StudyError
        If there is no such map or file, or something in it is missing or no number.
    """
    maps = reference.load()
    if name in maps:
        return maps[name]
    path = Path(name)
    if not path.suffix and len(path.parts) == 1:
        raise StudyError(f"{name}: no such reference map; {choices(name, maps)}, or a .csv file")
    try:
        rows = list(csv.DictReader(user_file.text_of(path).splitlines()))
    except csv.Error as error:
        raise StudyError(f"{path}: cannot be read ({error})") from None
    points = [_point(path, number, row, length) for number, row in enumerate(rows, 2)]
    used = [point for point, row in zip(points, rows, strict=True) if _used(point, row)]
    if not used:
        raise StudyError(f"{path}: there is no force in it")
    columns = Counter(f"{p:g} MPa, {e:g}" for p, e, _ in used)
    twice, count = columns.most_common(1)[0]
    if count > 1:
        raise StudyError(f"{path}: there are two forces at {twice}")
    return ForceMap(path.stem, path.stem, np.array(used), np.empty((0, 3)))


def stops(found: ForceMap, pressure: float) -> NDArray[np.float64]:
    """Contractions to fit at a pressure, those of the map or, if these are few, some between."""
    own = found.contractions(pressure)
    if np.sum((own >= 0) & (own <= FURTHEST)) < FEW:
        own = np.union1d(own, CONTRACTIONS)
    own = own[(own >= 0) & (own <= FURTHEST)]
    return own[found.inside(own, pressure)]


def _point(path: Path, number: int, row: dict[str, str], length: float) -> tuple[float, ...]:
    place = next((key for key in PLACES if row.get(key)), PLACES[0])
    try:
        pressure, force, at = (float(row[key]) for key in (*COLUMNS, place))
    except KeyError as error:
        raise StudyError(f"{path}: the column {error.args[0]} is missing") from None
    except (TypeError, ValueError):
        raise StudyError(f"{path}:{number}: not all of it are numbers") from None
    if not np.isfinite([pressure, force, at]).all():
        raise StudyError(f"{path}:{number}: not all of it are finite numbers")
    return pressure, at if place == "contraction" else round(1 - at / length, 12), force


def _used(point: tuple[float, ...], row: dict[str, str]) -> bool:
    slack = bool(row.get("length_mm")) and point[2] == 0
    return not slack and row.get("suspect") not in ("1", "1.0")
