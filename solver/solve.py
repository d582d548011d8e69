"""Solve a case by the model it names; whatever happens, the result has a status."""

import tempfile
import time
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from geometry.seal import is_sealed, why_none
from solver import continuity, files, freefem, in_time, output, program, vibrations
from solver.case import Case
from solver.continuity import Solved, States
from solver.judge import judged
from solver.load_path import PathKind, Waypoint
from solver.models import MODELS
from solver.record import Solution, unreached, variables
from solver.smoothing import marked
from solver.status import CaseStatus, StateStatus, state_status
from solver.zero_force import limit_pressure

LARGEST_FIELDS = 400  # bytes per byte of the mesh
ABOVE = (2.0, 4.0)  # times the limit pressure of the rubber


def solve(
    case: Case, mesh: Path | None, log: Path, limits: freefem.Limits
) -> tuple[Solution, freefem.Usage | None]:
    """Solve a case; the usage is None for models without FreeFEM.

    The limit of wall time is that of all runs of FreeFEM together.

    Raises
    ------
    OSError, freefem.Outside
        If it failed for a reason outside the case: a full disk, a signal, a damaged mesh, no
        FreeFEM. That is no result of the case.
    """
    in_python = MODELS[case.model].solve
    if in_python is not None:
        return marked(case, _with_diameter(case, in_python(case))), None
    if mesh is None or not mesh.exists():
        return failure(case, CaseStatus.MESH_FAILED, f"no mesh at {mesh}"), None
    if reason := why_none(mesh):
        return failure(case, CaseStatus.MESH_FAILED, reason), None
    _check_mesh(mesh)
    until = time.monotonic() + limits.wall_time
    solver = _Solver(mesh, log, limits, until)
    solved, end, lost = solver.curve(case)
    if end.status is None:
        cuts = continuity.snaps(case, solved, solver.again, solver.onwards)
        lost |= continuity.behind(case, cuts)
    states, fields = solved
    solution = judged(
        case,
        states,
        ended=end.status,
        reason=end.reason,
        searched=end.searched,
        lost=lost,
        unknowns=end.unknowns,
    )
    solution = replace(solution, fields=fields, log=freefem.tail(log) if end.status else "")
    return marked(case, _with_diameter(case, solution)), solver.usage


class _Solver:
    """Curves by FreeFEM on one mesh within one limit of time; ``usage`` is that of all runs."""

    def __init__(self, mesh: Path, log: Path, limits: freefem.Limits, until: float) -> None:
        self._given = mesh, log, limits, until
        self._starts: dict[float, bytes] = {}  # by swept control: the whole state before a gap
        self.usage: freefem.Usage | None = None

    def curve(self, case: Case) -> tuple[Solved, "_End", set[int]]:
        """States and fields, how the last way ended, and stops reached through lost states only.

        What lies behind an invalid state on its way is taken from another way, if that leads there.
        """
        names = variables(case)
        states, fields = solved = unreached(case.path.states, names), dict[int, States]()
        count, lost, searched = len(case.path.stops), set[int](), None
        timed = case.path.history is not None
        for way in [in_time.way(case)] if timed else case.path.ways():
            end = self._add(case, way, solved, lost)
            searched = end.searched or searched
            if end.status is not None:
                break
            if np.isfinite(states["force"][:count]).all() and not lost:
                break
        if lost and case.path.kind is PathKind.ISOBARIC and end.status is None:
            self._add(case, case.path.way_back(), solved, lost)
        for way in _from_above(case, states) if end.status is None else []:
            searched = self._add(case, way, solved, lost).searched or searched
            if np.isfinite(states["force"][-1]):
                break
        return (states, fields), replace(end, searched=searched), lost

    def again(self, case: Case) -> Solved:
        """A curve of more stops."""
        return self.curve(case)[0]

    def onwards(self, case: Case, near: float) -> States | None:
        """States of a curve that goes on from one before a gap; None if it does not get there."""
        start, found = self._starts.get(near), unreached(case.path.states, variables(case))
        if start is None:
            return None
        end = self._walk(case, case.path.way_from(near), found, {}, start)
        return found if end.status is None else None

    def _walk(
        self,
        case: Case,
        way: list[Waypoint],
        states: States,
        fields: dict[int, States],
        start: bytes = b"",
    ) -> "_End":
        """Follow a way, and keep what it leaves for others."""
        end = _follow(case, way, *self._given, states, fields, start)
        if end.usage is not None:
            self.usage = end.usage if self.usage is None else self.usage + end.usage
        self._starts |= end.starts
        return end

    def _add(self, case: Case, way: list[Waypoint], solved: Solved, lost: set[int]) -> "_End":
        """Follow a way, and add what it reaches for the first time or better to what is known."""
        found, its_fields = unreached(case.path.states, variables(case)), dict[int, States]()
        end = self._walk(case, way, found, its_fields)
        states, fields = solved
        name, zero = case.path.kind.swept.variable, len(case.path.stops)
        behind = lost_on(case, way, found)
        for k in np.flatnonzero(np.isfinite(found["force"])):
            new = np.isnan(states["force"][k])
            better = k in lost and k not in behind
            lower = k == zero and found[name][k] < states[name][k]
            if not (new or better or lower):
                continue
            for variable, values in states.items():
                values[k] = found[variable][k]
            if k in its_fields:
                fields[int(k)] = its_fields[int(k)]
            lost -= {int(k)}
            lost |= behind & {int(k)}
        return end


def lost_on(case: Case, way: list[Waypoint], states: States) -> set[int]:
    """Stops that a way reaches behind an invalid state, until it begins anew without load."""
    status = state_status(case.path.kind, states)
    lost, bad = set(), False
    for point in way:
        if point.stop is None:
            bad = False
        elif bad:
            lost.add(point.stop)
        else:
            bad = status[point.stop] is StateStatus.INVALID_STATE
    return lost


def _from_above(case: Case, states: dict[str, NDArray[np.float64]]) -> list[list[Waypoint]]:
    """Ways to where a muscle pulls that, at the pressures of its stops, has no state to push in.

    From there its state of zero force may be found nonetheless.
    """
    path = case.path
    if not (path.zero_force and path.kind is PathKind.ISOMETRIC):
        return []
    if not np.isnan(states["force"]).all():
        return []
    limit = limit_pressure(case)
    return [path.way_from_above(max(factor * limit, path.stops[-1])) for factor in ABOVE]


class DamagedMesh(OSError):
    """A mesh that is not as it was written."""


@dataclass(frozen=True)
class _End:
    """How one run of FreeFEM ended; ``status`` is None if by itself."""

    status: CaseStatus | None
    reason: str
    usage: freefem.Usage | None
    unknowns: int
    searched: tuple[float, float] | None = None  # where a state of zero force was looked for
    starts: dict[float, bytes] = field(default_factory=dict)  # start_<waypoint>.txt


def _follow(
    case: Case,
    way: list[Waypoint],
    mesh: Path,
    log: Path,
    limits: freefem.Limits,
    until: float,
    states: dict[str, NDArray[np.float64]],
    fields: dict[int, dict[str, NDArray[np.float64]]],
    start: bytes = b"",
) -> _End:
    """Run FreeFEM along a way and add what it reaches to ``states`` and ``fields``.

    ``start`` is what another run has left of the state where the way begins, else without load.
    """
    status, reason, usage, unknowns = None, "", None, 0
    starts: dict[float, bytes] = {}
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as scratch:
        work = Path(scratch)
        (work / "composition.idp").write_text(program.composition(case))
        if case.path.history is None:
            (work / "waypoints.txt").write_text(
                program.waypoint_text(case, way, started=bool(start))
            )
        else:
            in_time.write(case, work)
        if case.vibrates:
            vibrations.write(case, work)
        if start:
            (work / "start.txt").write_bytes(start)
        given = program.flags(case, mesh.resolve())
        try:
            usage = _run_until(until, limits, case, given, work, log.resolve())
        except freefem.OutOfTime:
            status, reason = CaseStatus.TIMEOUT, f"stopped after {limits.wall_time:g} s, the limit"
        except freefem.Outside:
            raise
        except freefem.FreeFemError as error:
            status, reason = CaseStatus.SOLVER_ERROR, str(error)
        searched = None
        try:
            ended = files.read(work / "reason.txt", output.LARGEST_TEXT) or b""
            if status is None:
                reason = freefem.readable(ended.decode(errors="replace").strip())
            unknowns = output.number(work / "unknowns.txt")
            largest = LARGEST_FIELDS * mesh.stat().st_size
            output.collect(case, way, work, largest, states, fields)
            if case.path.history is not None:
                in_time.add(states, output.rows(work / "times.csv", len(way)))
            if case.vibrates:
                vibrations.collect(case, way, work, fields)
            starts = output.starts(case, way, work, largest)
            searched = output.searched(work / "zero.txt")
        except output.RUBBISH as error:
            status = status or CaseStatus.SOLVER_ERROR
            reason = reason or f"what FreeFEM has written cannot be read ({error})"
        stops = [point.stop for point in way if point.stop is not None]
        if not (status or reason) and np.isnan(states["force"][stops]).any():
            status, reason = CaseStatus.SOLVER_ERROR, "FreeFEM ended early and did not say why"
        if status is CaseStatus.SOLVER_ERROR:
            _check_disk(work.parent)
            _check_mesh(mesh)
    return _End(status, reason, usage, unknowns, searched, starts)


def _run_until(
    until: float,
    limits: freefem.Limits,
    case: Case,
    given: dict[str, str | float],
    work: Path,
    log: Path,
) -> freefem.Usage:
    """Run FreeFEM, and once more if a signal from outside stopped it; raises as freefem.run."""

    def run() -> freefem.Usage:
        left = replace(limits, wall_time=max(until - time.monotonic(), 0))
        return freefem.run(program.file(case), given, work, log, left, program.includes(case))

    try:
        return run()
    except freefem.Interrupted:
        return run()  # whoever stops it again means it


def _check_disk(folder: Path) -> None:
    """Raise OSError if nothing can be written: then what failed says nothing about the case."""
    with tempfile.TemporaryFile(dir=folder) as probe:
        probe.write(bytes(2**16))
        probe.flush()


def _check_mesh(mesh: Path) -> None:
    """Raise OSError if a mesh is not as it was written, or cannot be read."""
    if not is_sealed(mesh):
        raise DamagedMesh(f"{mesh} is damaged")


def failure(case: Case, status: CaseStatus, reason: str, log: str = "") -> Solution:
    """A solution without any state."""
    count = case.path.states
    return Solution(
        status=status,
        reason=reason,
        states=unreached(count, variables(case)),
        state_status=[StateStatus.NOT_REACHED] * count,
        log=log,
    )


def _with_diameter(case: Case, solution: Solution) -> Solution:
    """Adds the equivalent diameter, sign(F) sqrt(4 |F| / (pi p)) [mm]; NaN without pressure."""
    states = solution.states
    rounding = 1e-9 * case.rubber.shear_modulus  # a pressure of 0 comes out as 1e-17
    pressure = np.where(states["pressure"] > rounding, states["pressure"], np.nan)
    size = np.sqrt(4 * np.abs(states["force"]) / (np.pi * pressure))
    states["equivalent_diameter"] = np.sign(states["force"]) * size
    return solution
