"""What the FreeFEM programs are told of a path in time, and what they have written of it."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from solver.case import Case
from solver.history import FIRST_GROWTH, TONNE_PER_KG, Start
from solver.load_path import Waypoint


def way(case: Case) -> list[Waypoint]:
    """The stops of a path in time."""
    path, history = case.path, case.path.history
    assert history is not None
    held = history.held or [path.held] * len(path.stops)
    kinds = path.kind.held, path.kind.swept
    return [
        Waypoint(kinds[0], still, kinds[1], stop, number)
        for number, (still, stop) in enumerate(zip(held, path.stops, strict=True))
    ]


def write(case: Case, work: Path) -> None:
    """Write what solver/path/in_time.idp reads, and the branches of a memory, and friction."""
    (work / "history.txt").write_text(history_text(case))
    if case.remembers:
        assert case.memory is not None
        c10, c01 = case.rubber.branch
        lines = [f"{len(case.memory.times)} {c10!r} {c01!r} {case.memory.long_term!r}"]
        pairs = zip(case.memory.shares, case.memory.times, strict=True)
        lines += [f"{float(share)!r} {float(time)!r}" for share, time in pairs]
        (work / "branches.txt").write_text("\n".join(lines) + "\n")
    if case.rubs:
        assert case.friction is not None
        stiffness = case.friction.stiffness(case.muscle.outer_radius)
        (work / "friction.txt").write_text(f"{case.friction.lever!r} {stiffness!r}\n")


def history_text(case: Case) -> str:
    """The file history.txt of solver/path/in_time.idp."""
    history = case.path.history
    assert history is not None
    valve = history.valve
    gas = [0.0, 0.0, 1.0, 0.0]
    if valve is not None:
        gas = [valve.conductance, valve.critical_ratio, valve.exponent, valve.dead_volume]
    unloaded = int(history.start is Start.UNLOADED)
    to_start = case.path.start.ways()[0]
    holding = history.preload_steps()
    lines = [
        f"{unloaded} {history.first!r} {FIRST_GROWTH!r} {float(history.mass * TONNE_PER_KG)!r}",
        " ".join([str(int(valve is not None)), *(repr(float(value)) for value in gas)]),
        str(len(to_start)),
        *(
            f"{p.first:d} {float(p.first_target)!r} {p.second:d} {float(p.second_target)!r}"
            for p in to_start
        ),
        " ".join([str(len(holding)), *map(repr, holding)]),
        f"{case.path.kind.held:d} {case.path.kind.swept:d} {len(case.path.stops)}",
    ]
    for time, point in zip(history.times, way(case), strict=True):
        wanted = 2 if point.second_target in case.fields_at else 1
        lines.append(
            f"{float(time)!r} {float(point.first_target)!r} {float(point.second_target)!r} {wanted}"
        )
    return "\n".join(lines) + "\n"


def add(states: dict[str, NDArray[np.float64]], rows: list[dict[str, float]]) -> None:
    """Add what the rows of times.csv say to the states."""
    for row in rows:
        stop = row["stop"]
        if not (stop.is_integer() and 0 <= stop < len(states["time"])):
            raise ValueError(f"a time of stop {stop:g}, which does not exist")
        if not np.isfinite(list(row.values())).all():
            raise ValueError("a time whose numbers are not finite")
        for name in ("time", "work", "dissipated"):
            states[name][int(stop)] = row[name]
        states["energy"][int(stop)] += row["branches"]
