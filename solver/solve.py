"""Solve a case by the model it names; whatever happens, the result has a status."""

import csv
import math
import tempfile
import time
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from geometry.braid import Kind, Layer, LayeredBraid
from geometry.labels import Boundary
from geometry.muscle import Muscle
from geometry.seal import is_sealed, why_none
from solver import continuity, files, freefem, in_time
from solver.case import Case
from solver.continuity import Solved, States, check_state
from solver.effects import Volume
from solver.judge import judged
from solver.load_path import LoadPath, PathKind, Waypoint
from solver.material import Thread
from solver.models import MODELS
from solver.record import Solution, unreached, variables
from solver.smoothing import marked
from solver.status import CaseStatus, StateStatus, state_status
from solver.zero_force import Search, limit_pressure

RUBBISH = (ValueError, TypeError, LookupError, ArithmeticError, csv.Error)  # unreadable output
LARGEST_TEXT, LARGEST_ROW = 2**14, 2**12  # bytes
LARGEST_FIELDS = 400  # bytes per byte of the mesh
LARGEST_COUNT = 10**9
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
        names = variables(case.path)
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
        start, found = self._starts.get(near), unreached(case.path.states)
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
        found, its_fields = unreached(case.path.states, variables(case.path)), dict[int, States]()
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
        (work / "composition.idp").write_text(composition(case))
        if case.path.history is None:
            (work / "waypoints.txt").write_text(waypoint_text(case, way, started=bool(start)))
        else:
            in_time.write(case, work)
        if start:
            (work / "start.txt").write_bytes(start)
        given = flags(case, mesh.resolve())
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
            ended = files.read(work / "reason.txt", LARGEST_TEXT) or b""
            if status is None:
                reason = freefem.readable(ended.decode(errors="replace").strip())
            unknowns = _number(work / "unknowns.txt")
            largest = LARGEST_FIELDS * mesh.stat().st_size
            _collect(case, way, work, largest, states, fields)
            if case.path.history is not None:
                in_time.add(states, _rows(work / "times.csv", len(way)))
            starts = _starts(case, way, work, largest)
            searched = _searched(work / "zero.txt")
        except RUBBISH as error:
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
        return freefem.run(program(case), given, work, log, left, includes(case))

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
        states=unreached(count, variables(case.path)),
        state_status=[StateStatus.NOT_REACHED] * count,
        log=log,
    )


def includes(case: Case) -> list[Path]:
    """Folders in which the program of a case finds its includes."""
    return [*MODELS[case.model].includes, *case.rubber.includes()]


def program(case: Case) -> Path:
    """The FreeFEM program of a case."""
    own = MODELS[case.model].program
    return own if case.path.history is None else own.with_name(f"{own.stem}_in_time.edp")


def composition(case: Case) -> str:
    """The includes of a program: one per active effect."""
    threads = case.effects.threads if case.muscle.braid else "none"
    files = [f"threads_{threads}.idp", *MODELS[case.model].composition(case)]
    remembers = "macro remembers() // EOM\n" if case.remembers else ""
    return remembers + "".join(f'include "{name}"\n' for name in files)


def waypoint_text(case: Case, way: list[Waypoint], *, started: bool = False) -> str:
    """The file that solver/path/output.idp reads; ``started`` where the way begins at a state."""
    wanted_fields = {k for k, stop in enumerate(case.path.stops) if stop in case.fields_at}
    lines = [f"{len(way)} {started:d} {continuity.SHARE!r}", "0 0 0 0 0 0 0"]
    if case.path.zero_force:
        search = Search.of(case)
        lines[1] = (
            f"1 {search.held:d} {float(search.still)!r} {search.swept:d} "
            f"{search.low!r} {float(search.high)!r} {search.step!r}"
        )
    for point in way:
        wanted = 0 if point.stop is None else 2 if point.stop in wanted_fields else 1
        lines.append(
            f"{point.first:d} {float(point.first_target)!r} "
            f"{point.second:d} {float(point.second_target)!r} {wanted}"
        )
    return "\n".join(lines) + "\n"


def flags(case: Case, mesh: Path) -> dict[str, str | float]:
    """Flags of solver/path/parameters.idp and of the includes that are composed in."""
    muscle, newton = case.muscle, case.numerics.newton
    values: dict[str, str | float] = {
        "mesh": str(mesh),
        "waypoints": "waypoints.txt",
        "inner_radius": muscle.inner_radius,
        "outer_radius": muscle.outer_radius,
        "half_length": muscle.length / 2,
        **case.rubber.flags(),
        "newton_tolerance": newton.tolerance,
        "newton_limit": newton.iterations,
        "smallest_step": newton.smallest_step,
        "thread_layers": 0,
        "layers": "none",
        "slack_width": 1.0,  # read by no bare tube
    }
    if case.thread is not None:
        layers = _layers(muscle, case.thread)
        values |= {
            "thread_layers": len(layers),
            "layers": ",".join(repr(number) for layer in layers for number in layer),
            "slack_width": case.numerics.slack.width_of(case.thread),
        }
    values |= MODELS[case.model].flags(case)
    return {k: v if isinstance(v, str | int) else float(v) for k, v in values.items()}


def _layers(muscle: Muscle, thread: Thread) -> list[tuple[float, ...]]:
    """Of every layer what solver/path/parameters.idp reads; families of one shape are one layer."""
    found: dict[Layer, int] = {}
    for layer in muscle.layers:
        alike = layer
        if isinstance(muscle.braid, LayeredBraid):
            alike = replace(layer, threads=1, sense=1)
        found[alike] = found.get(alike, 0) + layer.threads
    return [
        (
            layer.radius,
            layer.carrier,
            math.tan(math.atan(layer.tangent)),
            count * thread.stiffness * layer.share,
            float(layer.kind is Kind.EMBEDDED),
            Boundary.OUTER.value
            if layer.kind is Kind.SLEEVE
            else Boundary.LAYER_1.value + muscle.layer_radii.index(layer.radius),
        )
        for layer, count in found.items()
    ]


def _collect(
    case: Case,
    way: list[Waypoint],
    work: Path,
    largest_fields: int,
    states: dict[str, NDArray[np.float64]],
    fields: dict[int, dict[str, NDArray[np.float64]]],
) -> None:
    """Read what FreeFEM has left in its folder, if it makes sense."""
    found = _rows(work / "states.csv", len(way) + 1)
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
        for name in variables(case.path).keys() & row.keys():
            states[name][stop] = row[name]
    if len({len(table) for tables in fields.values() for table in tables.values()}) > 1:
        raise ValueError("fields of different sizes")
    if case.muscle.braid is None:
        for name in ("thread_stretch_min", "thread_stretch_max"):
            states[name][:] = np.nan
    if case.effects.volume is Volume.INCOMPRESSIBLE:
        states["unstable_modes"][:] = np.nan  # solid_incompressible.idp counts none


def _starts(case: Case, way: list[Waypoint], work: Path, largest: int) -> dict[float, bytes]:
    """The whole states that it has left, by their swept control."""
    found: dict[float, bytes] = {}
    for number, point in enumerate(way):
        if point.stop is not None:
            text = files.read(work / f"start_{number}.txt", largest)
            if text is not None:
                found[case.path.stops[point.stop]] = text
    return found


def _number(path: Path) -> int:
    """The number in a file; 0 if FreeFEM did not come to write it."""
    text = (files.read(path, LARGEST_TEXT) or b"").decode().strip()
    number = int(text) if text else 0
    if not 0 <= number <= LARGEST_COUNT:
        raise ValueError(f"{number} in {path.name}")
    return number


def _rows(path: Path, most: int = 1000) -> list[dict[str, float]]:
    """Rows of a table of numbers, ``most`` of them; a last line that was cut off is dropped."""
    text = (files.read(path, LARGEST_ROW * (most + 1)) or b"").decode()
    lines = [line for line in text.splitlines(keepends=True) if line.endswith("\n")]
    rows = [{n: float(value) for n, value in row.items()} for row in csv.DictReader(lines)]
    for row in rows:
        for name, value in row.items():
            if math.isinf(value):
                raise ValueError(f"{name} is {value}")
    return rows


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


def _searched(path: Path) -> tuple[float, float] | None:
    """The ends in zero.txt of solver/path/output.idp."""
    text = files.read(path, LARGEST_TEXT)
    if text is None:
        return None
    low, high = map(float, text.decode().split())
    return low, high


def _with_diameter(case: Case, solution: Solution) -> Solution:
    """Adds the equivalent diameter, sign(F) sqrt(4 |F| / (pi p)) [mm]; NaN without pressure."""
    states = solution.states
    rounding = 1e-9 * case.rubber.shear_modulus  # a pressure of 0 comes out as 1e-17
    pressure = np.where(states["pressure"] > rounding, states["pressure"], np.nan)
    size = np.sqrt(4 * np.abs(states["force"]) / (np.pi * pressure))
    states["equivalent_diameter"] = np.sign(states["force"]) * size
    return solution
