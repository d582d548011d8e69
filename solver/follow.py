"""One run of FreeFEM along a way: what it is told, how it ends, and what it has left."""

import tempfile
import time
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from geometry.seal import is_sealed
from solver import files, freefem, in_time, output, program, vibrations
from solver.case import Case
from solver.continuity import States
from solver.load_path import Waypoint
from solver.status import CaseStatus

LARGEST_FIELDS = 400  # bytes per byte of the mesh


class DamagedMesh(OSError):
    """A mesh that is not as it was written."""


@dataclass(frozen=True)
class Means:
    """What all runs for one case share.

    Attributes
    ----------
    mesh, log : files
    limits : of each run; that of time is of all together
    until : when the time of all is over, as time.monotonic() [s]
    """

    mesh: Path
    log: Path
    limits: freefem.Limits
    until: float


@dataclass
class End:
    """How a run has ended, and what it has said of itself.

    Attributes
    ----------
    status : None if it came to its end by itself
    reason : why its way ended early; empty if it did not
    unknowns : what was solved for beside contraction and pressure
    searched : between which ends a state of zero force was looked for
    starts : whole states that it has left, by the control that is swept
    """

    status: CaseStatus | None
    reason: str
    usage: freefem.Usage | None
    unknowns: int = 0
    searched: tuple[float, float] | None = None
    starts: dict[float, bytes] = field(default_factory=dict)


def follow(
    case: Case,
    way: list[Waypoint],
    means: Means,
    states: States,
    fields: dict[int, States],
    start: bytes = b"",
) -> End:
    """Run FreeFEM along a way and add what it reaches to ``states`` and ``fields``.

    ``start`` is what another run has left of the state where the way begins, else without load.

    Raises
    ------
    OSError, freefem.Outside
        If it failed for a reason outside the case.
    """
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as scratch:
        work = Path(scratch)
        _write(case, way, work, start)
        end = _run(case, means, work)
        try:
            _read(end, case, way, means.mesh, work, states, fields)
        except output.RUBBISH as error:
            end.status = end.status or CaseStatus.SOLVER_ERROR
            end.reason = end.reason or f"what FreeFEM has written cannot be read ({error})"
        stops = [point.stop for point in way if point.stop is not None]
        if not (end.status or end.reason) and np.isnan(states["force"][stops]).any():
            end.status = CaseStatus.SOLVER_ERROR
            end.reason = "FreeFEM ended early and did not say why"
        if end.status is CaseStatus.SOLVER_ERROR:
            _check_disk(work.parent)
            check_mesh(means.mesh)
    return end


def _write(case: Case, way: list[Waypoint], work: Path, start: bytes) -> None:
    """Write the files that the program of a case reads beside the mesh."""
    (work / "composition.idp").write_text(program.composition(case))
    if case.path.history is None:
        text = program.waypoint_text(case, way, started=bool(start))
        (work / "waypoints.txt").write_text(text)
    else:
        in_time.write(case, work)
    if case.vibrates:
        vibrations.write(case, work)
    if start:
        (work / "start.txt").write_bytes(start)


def _run(case: Case, means: Means, work: Path) -> End:
    """Run the program of a case; raises what says nothing about it."""
    try:
        return End(None, "", _within(means, case, work))
    except freefem.OutOfTime:
        reason = f"stopped after {means.limits.wall_time:g} s, the limit"
        return End(CaseStatus.TIMEOUT, reason, None)
    except freefem.Outside:
        raise
    except freefem.FreeFemError as error:
        return End(CaseStatus.SOLVER_ERROR, str(error), None)


def _within(means: Means, case: Case, work: Path) -> freefem.Usage:
    """Run FreeFEM, and once more if a signal from outside stopped it; raises as freefem.run."""
    flags, log = program.flags(case, means.mesh.resolve()), means.log.resolve()

    def run() -> freefem.Usage:
        left = replace(means.limits, wall_time=max(means.until - time.monotonic(), 0))
        return freefem.run(program.file(case), flags, work, log, left, program.includes(case))

    try:
        return run()
    except freefem.Interrupted:
        return run()  # whoever stops it again means it


def _read(
    end: End,
    case: Case,
    way: list[Waypoint],
    mesh: Path,
    work: Path,
    states: States,
    fields: dict[int, States],
) -> None:
    """Add what a run has left to its end, to ``states`` and ``fields``, as far as that is right.

    Raises
    ------
    output.RUBBISH
        Where it makes no sense; what was read before stays.
    """
    said = files.read(work / "reason.txt", output.LARGEST_TEXT) or b""
    if end.status is None:
        end.reason = freefem.readable(said.decode(errors="replace").strip())
    end.unknowns = output.number(work / "unknowns.txt")
    largest = LARGEST_FIELDS * mesh.stat().st_size
    output.collect(case, way, work, largest, states, fields)
    if case.path.history is not None:
        in_time.add(states, output.rows(work / "times.csv", len(way)))
    if case.vibrates:
        vibrations.collect(case, way, work, fields)
    end.starts = output.starts(case, way, work, largest)
    end.searched = output.searched(work / "zero.txt")


def _check_disk(folder: Path) -> None:
    """Raise OSError if nothing can be written: then what failed says nothing about the case."""
    with tempfile.TemporaryFile(dir=folder) as probe:
        probe.write(bytes(2**16))
        probe.flush()


def check_mesh(mesh: Path) -> None:
    """Raise OSError if a mesh is not as it was written, or cannot be read."""
    if not is_sealed(mesh):
        raise DamagedMesh(f"{mesh} is damaged")
