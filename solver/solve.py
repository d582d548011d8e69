"""Solve a case by the model it names; whatever happens, the result has a status."""

import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from geometry.seal import why_none
from solver import continuity, freefem, in_time
from solver.case import Case
from solver.continuity import Solved, States
from solver.follow import End, Means, check_mesh, follow
from solver.judge import judged
from solver.load_path import PathKind, Waypoint
from solver.models import MODELS
from solver.record import Solution, unreached, variables
from solver.smoothing import marked
from solver.status import CaseStatus, StateStatus, state_status
from solver.zero_force import limit_pressure

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
    check_mesh(mesh)
    solver = _Solver(Means(mesh, log, limits, until=time.monotonic() + limits.wall_time))
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

    def __init__(self, means: Means) -> None:
        self._means = means
        self._starts: dict[float, bytes] = {}  # by swept control: the whole state before a gap
        self.usage: freefem.Usage | None = None

    def curve(self, case: Case) -> tuple[Solved, End, set[int]]:
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
    ) -> End:
        """Follow a way, and keep what it leaves for others."""
        end = follow(case, way, self._means, states, fields, start)
        if end.usage is not None:
            self.usage = end.usage if self.usage is None else self.usage + end.usage
        self._starts |= end.starts
        return end

    def _add(self, case: Case, way: list[Waypoint], solved: Solved, lost: set[int]) -> End:
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
