"""The one table of states.

Whatever is made of records (dataset, states.parquet, figures) is made of a ``Table``: one row per
state, with names, units and long names from here and from solver/record.py.
"""

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from solver.load_path import PathKind
from solver.record import SLEEVED, VARIABLES
from solver.status import VALID, StateStatus
from workflow.data.records import Curve, SolvedCase
from workflow.plan import mesh_error
from workflow.plan.plan import Kept
from workflow.study.contents import StudiedMuscle

STOP, ZERO = "stop", "zero force"  # kinds of states
GOOD = StateStatus.CONVERGED.value
SHOWN = tuple(status.value for status in VALID)  # statuses whose numbers may be shown
CONTROLS = {  # that a path prescribes; of a state at a stop the decimals of the study file
    "contraction": VARIABLES["contraction"],
    "pressure": VARIABLES["pressure"],
    "load": ("N", "load"),
}
WITH_ERROR = {  # quantities, and what they are called
    "force": "force",
    "inner_diameter_inflated": "inner diameter",
    "volume": "volume",
    "contraction": "contraction",
    "pressure": "pressure, where the force is zero",
}
OF_STATE = {  # columns of a state: unit, long name
    "state": ("1", "number of the state in its record"),
    "point": ("", f"{STOP} of the path, or state of {ZERO}"),
    **CONTROLS,
    **VARIABLES,
    **SLEEVED,  # where there is a muscle with a sleeve
    **{
        f"{name}_error": (VARIABLES[name][0], f"discretisation error of the {called}")
        for name, called in WITH_ERROR.items()
    },
    "error_by": ("", "how the discretisation errors are known"),
    "status": ("", "status of the state"),
    "flags": ("", "flags of the state"),
    "note": ("", "note of the state"),
}
OF_CURVE = {  # columns of a curve
    "muscle": ("", "muscle"),
    "model": ("", "model"),
    "variant": ("", "variant"),
    "path": ("", "kind of the path: what is held and what swept"),
    "held": ("", "value that is held; its unit is that of the control"),
    "case": ("", "case key"),
    "case_status": ("", "case status"),
    "case_reason": ("", "case reason"),
    "tolerance": ("1", "how exact a scene wants it, of the largest value along the curve"),
    "total_error": ("1", "error of model and mesh together that is not expected to be exceeded"),
    "total_error_by": ("", "how the total error is known, and whether that proves the tolerance"),
    "code": ("", "digest of the sources that solved the case"),
}
OF_MUSCLE = {  # columns of a muscle
    "inner_diameter": ("mm", "initial inner diameter"),
    "wall_thickness": ("mm", "initial wall thickness"),
    "length": ("mm", "initial length between the caps"),
    "braid_angle": ("degree", "braid angle at the mean layer diameter"),
    "lead": ("mm", "lead of the threads"),
    "threads": ("1", "threads per layer"),
    "thread_stiffness": ("N", "EA of a thread"),
    "material": ("", "rubber"),
}


def attributes(column: tuple[str, str]) -> dict[str, str]:
    """Unit and long name as attributes; texts have no unit."""
    unit, long_name = column
    return ({"units": unit} if unit else {}) | {"long_name": long_name}


@dataclass(frozen=True)
class Table:
    """All states of some curves.

    Attributes
    ----------
    muscles : one row per muscle, by name; columns as in OF_MUSCLE
    curves : one row per curve; columns as in OF_CURVE
    states : one row per state, those of a curve together and in its order; columns as in OF_STATE,
        and ``curve``, the row of its curve
    """

    muscles: pd.DataFrame
    curves: pd.DataFrame
    states: pd.DataFrame

    @classmethod
    def of(cls, curves: Sequence[Curve], muscles: Mapping[str, StudiedMuscle]) -> "Table":
        """The states of solved curves: at the stops that are wanted, and of zero force.

        Curves in time have groups of their own (workflow/data/in_time.py).
        """
        curves = [curve for curve in curves if not curve.place.scene]
        named = sorted({curve.place.muscle for curve in curves})
        return cls(
            pd.DataFrame([of_muscle(muscles[name]) for name in named], named, list(OF_MUSCLE)),
            pd.DataFrame([_of_curve(curve) for curve in curves], columns=list(OF_CURVE)),
            state_rows(curves),
        )

    def of_muscles(self, names: Collection[str]) -> "Table":
        """The curves and states of some muscles."""
        return self.part(self.curves["muscle"].isin(names))

    def part(self, chosen: "pd.Series[bool]") -> "Table":
        """Some of the curves, with their states and muscles."""
        curves = self.curves[chosen]
        muscles = self.muscles.loc[sorted(set(curves["muscle"]))]
        return Table(muscles, curves, self.states[self.states["curve"].isin(curves.index)])

    def curve(
        self, path: str, muscle: str, model: str, variant: str, held: float
    ) -> pd.DataFrame | None:
        """The states of one curve; None if it is not there."""
        return self._by_names.get((path, muscle, model, variant, held))

    @cached_property
    def _by_names(self) -> Mapping[tuple[str | float, ...], pd.DataFrame]:
        names = ["path", "muscle", "model", "variant", "held"]
        rows = dict(iter(self.states.groupby("curve")))
        return {of[1:]: rows[of[0]] for of in self.curves[names].itertuples() if of[0] in rows}

    def joined(self) -> pd.DataFrame:
        """One row per state, with what its curve and its muscle are."""
        curves = self.curves.join(self.muscles, on="muscle")
        return self.states.join(curves, on="curve").drop(columns="curve")


def of_muscle(studied: StudiedMuscle) -> list[Any]:
    """What a muscle is, in the order of OF_MUSCLE."""
    muscle, braid, thread = studied.muscle, studied.muscle.braid, studied.thread
    angle = round(math.degrees(braid.angle), 12) if braid else np.nan  # a file says no 17 digits
    return [
        muscle.inner_diameter,
        muscle.wall_thickness,
        muscle.length,
        angle,
        braid.lead if braid else np.nan,
        braid.threads_each if braid else np.nan,
        thread.stiffness if thread else np.nan,
        studied.material,
    ]


def _of_curve(curve: Curve) -> list[Any]:
    place, solution = curve.place, curve.solution
    names = [place.muscle, place.model, place.variant, place.group, place.held]
    kept = curve.kept or Kept(np.nan, np.nan, "")
    promised = [kept.tolerance, kept.error, kept.by]
    return [*names, curve.key, solution.status.value, solution.reason, *promised, solution.code]


def state_rows(curves: Sequence[SolvedCase]) -> pd.DataFrame:
    """The rows of the table of states that are of some solved cases."""
    wanted = [_wanted(curve) for curve in curves]
    counts = [len(numbers) for numbers in wanted]

    def joined(of_curves: Iterable[Any], kind: type = float) -> NDArray[Any]:
        """Those states of every curve that are wanted, of arrays of all states of each."""
        pairs = zip(of_curves, wanted, strict=True)
        parts: list[NDArray[Any]] = [np.asarray(v, kind)[numbers] for v, numbers in pairs]
        return np.concatenate(parts) if parts else np.empty(0, kind)

    solutions = [curve.solution for curve in curves]
    paths = [curve.case.path for curve in curves]
    columns: dict[str, NDArray[Any]] = {
        "curve": np.repeat(np.arange(len(curves)), counts),
        "state": joined((range(path.states) for path in paths), int),
        "point": joined(([STOP] * len(p.stops) + [ZERO] * p.zero_force for p in paths), object),
        "load": np.full(sum(counts), np.nan),
    }
    here = {name for solution in solutions for name in SLEEVED if name in solution.states}
    for name in (*VARIABLES, *here):
        columns[name] = joined(
            solution.states.get(name, np.full(path.states, np.nan))
            for solution, path in zip(solutions, paths, strict=True)
        )
    exact = joined([*path.stops, np.nan][: path.states] for path in paths)
    kinds = np.repeat(np.array([path.kind.value for path in paths], object), counts)
    held = np.repeat(np.array([path.held for path in paths], float), counts)
    for kind in PathKind:
        here = kinds == kind.value
        for control, prescribed in ((kind.held.key, held), (kind.swept.key, exact)):
            known = here & np.isfinite(prescribed)
            columns[control] = np.where(known, prescribed, columns[control])
    for name in WITH_ERROR:
        columns[f"{name}_error"] = joined(
            mesh_error.error(of.case, of.solution, name, of.finer, of.coarser) for of in curves
        )
    by = (mesh_error.known_by(of.case, of.solution, of.finer, of.coarser) for of in curves)
    columns["error_by"] = joined(by, object)
    columns["status"] = joined(
        ([s.value for s in found.state_status] for found in solutions), object
    )
    columns["flags"] = joined(([" ".join(sorted(f)) for f in s.flags] for s in solutions), object)
    columns["note"] = joined((solution.notes for solution in solutions), object)
    return pd.DataFrame({name: columns[name] for name in ("curve", *OF_STATE) if name in columns})


def _wanted(curve: SolvedCase) -> list[int]:
    """Numbers of the states of a curve: of its stops, then that of zero force."""
    path, wanted = curve.case.path, set(curve.stops)
    numbers = [number for number, stop in enumerate(path.stops) if stop in wanted]
    return numbers + [len(path.stops)] * path.zero_force
