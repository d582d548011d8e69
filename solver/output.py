"""What a run of FreeFEM has left; if it makes no sense, one of ``RUBBISH`` is raised."""

import csv
import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from solver import files
from solver.case import Case
from solver.continuity import check_state
from solver.effects import Volume
from solver.load_path import LoadPath, Waypoint
from solver.models import MODELS
from solver.record import variables

RUBBISH = (ValueError, TypeError, LookupError, ArithmeticError, csv.Error)
LARGEST_TEXT, LARGEST_ROW = 2**14, 2**12  # bytes
LARGEST_COUNT = 10**9


def collect(
    case: Case,
    way: list[Waypoint],
    work: Path,
    largest_fields: int,
    states: dict[str, NDArray[np.float64]],
    fields: dict[int, dict[str, NDArray[np.float64]]],
) -> None:
    """Add the states of a way and their fields to those that are known."""
    found = rows(work / "states.csv", len(way) + 1)
    numbers = [_waypoint(row, way, case.path) for row in found]
    if len(set(numbers)) < len(numbers):
        raise ValueError("two states at one waypoint")
    for number, row in zip(numbers, found, strict=True):
        zero = number == len(way)
        stop = len(case.path.stops) if zero else way[number].stop
        assert stop is not None
        check_state(case, stop, row)
        table = files.read(work / f"fields_{number}.txt", largest_fields)
        if table is not None:
            fields[stop] = _fields(case.model, table)
        for name in variables(case).keys() & row.keys():
            states[name][stop] = row[name]
    if len({len(table) for tables in fields.values() for table in tables.values()}) > 1:
        raise ValueError("fields of different sizes")
    if case.muscle.braid is None:
        for name in ("thread_stretch_min", "thread_stretch_max"):
            states[name][:] = np.nan
    if case.effects.volume is Volume.INCOMPRESSIBLE:
        states["unstable_modes"][:] = np.nan  # solid_incompressible.idp counts none


def starts(case: Case, way: list[Waypoint], work: Path, largest: int) -> dict[float, bytes]:
    """The whole states that it has left, by their swept control."""
    found: dict[float, bytes] = {}
    for number, point in enumerate(way):
        if point.stop is not None:
            text = files.read(work / f"start_{number}.txt", largest)
            if text is not None:
                found[case.path.stops[point.stop]] = text
    return found


def number(path: Path) -> int:
    """The number in a file; 0 if FreeFEM did not come to write it."""
    text = (files.read(path, LARGEST_TEXT) or b"").decode().strip()
    found = int(text) if text else 0
    if not 0 <= found <= LARGEST_COUNT:
        raise ValueError(f"{found} in {path.name}")
    return found


def rows(path: Path, most: int = 1000) -> list[dict[str, float]]:
    """Rows of a table of numbers, ``most`` of them; a last line that was cut off is dropped."""
    text = (files.read(path, LARGEST_ROW * (most + 1)) or b"").decode()
    lines = [line for line in text.splitlines(keepends=True) if line.endswith("\n")]
    found = [{n: float(value) for n, value in row.items()} for row in csv.DictReader(lines)]
    for row in found:
        for name, value in row.items():
            if math.isinf(value):
                raise ValueError(f"{name} is {value}")
    return found


def _waypoint(row: dict[str, float], way: list[Waypoint], path: LoadPath) -> int:
    """The waypoint that a row is of; that of zero force stands behind the last."""
    number = row["waypoint"]
    if not (number.is_integer() and 0 <= number < len(way) + path.zero_force):
        raise ValueError(f"a state at waypoint {number:g}, which does not exist")
    if number < len(way) and way[int(number)].stop is None:
        raise ValueError(f"a state at waypoint {number:g}, which has no stop")
    if not math.isfinite(row["force"]):
        raise ValueError(f"a state whose force is {row['force']}")
    return int(number)


def _fields(model: str, text: bytes) -> dict[str, NDArray[np.float64]]:
    """The fields of a state, by name."""
    parts = MODELS[model].fields
    width = max(part.stop for part in parts.values())
    table = np.loadtxt(text.decode().splitlines(), ndmin=2)
    if not text.endswith(b"\n") or table.shape[1] != width or not np.isfinite(table).all():
        raise ValueError(f"fields of shape {table.shape}, cut off or not finite")
    return {name: table[:, part] for name, part in parts.items()}


def searched(path: Path) -> tuple[float, float] | None:
    """The ends in zero.txt of solver/path/output.idp."""
    text = files.read(path, LARGEST_TEXT)
    if text is None:
        return None
    low, high = map(float, text.decode().split())
    return low, high
