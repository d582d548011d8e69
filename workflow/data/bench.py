"""The forces that a muscle is fitted to: one of the reference maps, or a CSV file of one's own."""

import csv
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from workflow.data import reference
from workflow.data.reference import CONTRACTIONS, ForceMap
from workflow.study import user_file
from workflow.study.contents import Study
from workflow.study.errors import StudyError, choices, shown

COLUMNS = ("pressure_MPa", "force_N")
PLACES = ("contraction", "length_mm")  # one of them
FURTHEST = 0.2  # contraction, as in workflow/data/deviation.py
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


def refused(study: Study) -> Iterator[StudyError]:
    """Calibrations whose forces are not there, or not where they are asked for."""
    for name in study.calibration:
        yield from _refused(study, name)


def _refused(study: Study, name: str) -> Iterator[StudyError]:
    source, entry, keys = study.source, study.calibration[name], ("calibration", name)
    place, named = (*keys, "reference"), entry.reference
    if entry.muscle not in study.muscles or named is None:
        return  # which the study itself refuses
    if set("{}").intersection(named):
        allowed = "a path without { and }, in which Snakemake sees a pattern"
        yield source.refuse(place, named, allowed)
        return
    try:
        found = read(named, study.muscles[entry.muscle].muscle.length)
    except StudyError as error:
        given = f"{source.place(place)} = {shown(named)} is refused"
        yield StudyError(f"{given}\n  {error}", source.line(place) or 0, place)
        return
    count = 0
    pressures = ", ".join(f"{p:g}" for p in found.pressures[:12])
    for key in ("fit_pressure", "report_pressure"):
        if key == "report_pressure" and not source.has((*keys, key)):
            continue  # those that stand where none are given are reported as far as there are any
        for pressure in getattr(entry, key):
            here = len(stops(found, pressure))
            count += here if key == "fit_pressure" else 0
            if not here:
                allowed = (
                    f"pressures within {pressures} MPa; the reference has no force at "
                    f"{pressure:g} MPa between 0 and {100 * FURTHEST:g} %"
                )
                at = (*keys, key) if source.has((*keys, key)) else place
                yield source.refuse(at, pressure if at[-1] == key else named, allowed)
    if 0 < count <= len(entry.fit):
        at = (*keys, "fit") if source.has((*keys, "fit")) else place
        allowed = f"fewer values than there are forces; {named} has {count} of them here"
        yield source.refuse(at, list(entry.fit), allowed)


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
