"""What a figure gets of the table of states: a scene with its curves, and columns with units."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import pandas as pd

from geometry.muscle import Muscle
from solver.case import Case
from solver.load_path import ZERO_FORCE, PathKind
from solver.record import IN_TIME, SLEEVED, VARIABLES, Solution
from solver.status import CaseStatus
from workflow.data import records
from workflow.data.reference import ForceMap
from workflow.data.states import SHOWN, STOP, WITH_ERROR, Table
from workflow.plan.plan import Plan
from workflow.study.contents import StudiedMuscle
from workflow.study.schema import Scene

COLUMN = {name: f"{name} [{unit}]" for name, (unit, _) in (VARIABLES | SLEEVED).items()}
CONTRACTION, PRESSURE, FORCE = COLUMN["contraction"], COLUMN["pressure"], COLUMN["force"]
DIAMETER, WALL = "inner_diameter [mm]", "wall_thickness [mm]"
ANGLE, THREADS = "braid_angle [deg]", "threads [1]"
TIME = f"time [{IN_TIME['time'][0]}]"  # of states along a path in time
CONTROL = {"contraction": CONTRACTION, "pressure": PRESSURE, "load": FORCE}
REFERENCE = "reference"  # status of what was not computed
NUMBER = "state"  # column: number of the state in its record
SUSPECT = "suspect"  # status of a point that is shown but not used
FLAGS = "flags"  # column: what to know of a state beside its status, words of solver/status.py
STRETCH = COLUMN["thread_stretch_max"]
TOLERANCE, TOTAL_BY = "tolerance [1]", "total_error_by"
PROMISED = {"tolerance": TOLERANCE, "total_error": "total_error [1]", TOTAL_BY: TOTAL_BY}
STRENGTH = "thread_strength [N]"  # column: what a thread bears, NaN if that is not known


@dataclass(frozen=True)
class SceneData:
    """A scene and its solved curves.

    Attributes
    ----------
    curves : with the stops of this scene; their cases may have more
    """

    name: str
    plan: Plan
    curves: list[records.Curve]

    @classmethod
    def read(
        cls, plan: Plan, scene: str, folder: Path = records.FOLDER, *, partial: bool = False
    ) -> "SceneData":
        """Read the records of a scene; if ``partial``, those that there are."""
        return cls(scene, plan, records.curves_of_scene(plan, scene, folder, partial=partial))

    @property
    def missing(self) -> int:
        """How many curves have no record."""
        return sum(c.solution.status is CaseStatus.NOT_SOLVED for c in self.curves)

    @property
    def scene(self) -> Scene:
        """What the study file says."""
        return self.plan.study.scenes[self.name]

    @property
    def solutions(self) -> list[tuple[str, str, str, float, Case, Solution]]:
        """Muscle, model, variant, held value, case and solution of every curve, sorted."""
        return [
            (c.place.muscle, c.place.model, c.place.variant, c.place.held, c.case, c.solution)
            for c in self.curves
        ]

    @property
    def muscles(self) -> dict[str, Muscle]:
        """Muscles of the scene by name."""
        return {name: self.plan.study.muscles[name].muscle for name in self.scene.muscles}

    @property
    def studied(self) -> dict[str, StudiedMuscle]:
        """The same with their materials and what is known of them."""
        return {name: self.plan.study.muscles[name] for name in self.scene.muscles}

    @property
    def materials(self) -> dict[str, str]:
        """Names of their rubbers by the muscle's name."""
        return {name: self.plan.study.muscles[name].material for name in self.scene.muscles}

    @cached_property
    def table(self) -> Table:
        """The states of its curves."""
        return Table.of(self.curves, self.studied)


def error_of(column: str) -> str:
    """Column with the discretisation error of another."""
    name, bracket, unit = column.partition(" [")
    return f"{name}_error{bracket}{unit}"


def states(data: SceneData, quantities: Iterable[str]) -> pd.DataFrame:
    """States of a scene at its own stops, a case may have more; in the order of the scene.

    Columns: source (model), muscle, variant, point (stop or zero force), the two prescribed
    controls with the exact numbers of the study, the quantities, the discretisation errors of some
    of them, the largest thread stretch, what was promised of the curve if a scene has a tolerance,
    status, flags, the strength of a thread.
    """
    table = numbered(data.scene, data.table, quantities).drop(columns=NUMBER)
    known = {name: made.limits.thread_strength for name, made in data.studied.items()}
    return table.assign(**{STRENGTH: table["muscle"].map(known).astype(float)})


def numbered(scene: Scene, table: Table, quantities: Iterable[str]) -> pd.DataFrame:
    """The same of a table of some curves of the scene, and the numbers of the states."""
    found = table.joined()
    if not ZERO_FORCE.keys() & set(scene.quantities):
        found = found[found["point"] == STOP].reset_index(drop=True)
    assert scene.path is not None
    shown = found["status"].isin(SHOWN)
    columns = {"source": found["model"]} | {n: found[n] for n in ("muscle", "variant", "point")}
    kind = PathKind(scene.path)
    for control in (kind.held, kind.swept):
        columns[CONTROL[control.key]] = found[control.key]
    for name in quantities:
        values = found[name] if name in found else pd.Series(np.nan, found.index)
        columns.setdefault(COLUMN[name], values.where(shown))
        if name in WITH_ERROR:
            columns[error_of(COLUMN[name])] = found[f"{name}_error"]
    columns[STRETCH] = found["thread_stretch_max"].where(shown)
    if found["tolerance"].notna().any():
        columns |= {column: found[name] for name, column in PROMISED.items()}
    return pd.DataFrame(columns | {name: found[name] for name in ("status", FLAGS, NUMBER)})


def describe(table: pd.DataFrame, data: SceneData) -> pd.DataFrame:
    """Adds what the muscles are made of."""
    muscles = table["muscle"].map(data.muscles)
    return table.assign(
        **{
            DIAMETER: muscles.map(lambda m: m.inner_diameter),
            WALL: muscles.map(lambda m: m.wall_thickness),
            ANGLE: muscles.map(lambda m: round(np.degrees(m.braid.angle), 10) if m.braid else 0.0),
            THREADS: muscles.map(lambda m: m.braid.threads_each if m.braid else 0),
            "material": table["muscle"].map(data.materials),
        }
    )


def reference_curves(
    maps: Iterable[ForceMap], pressures: Sequence[float], contractions: Sequence[float]
) -> pd.DataFrame:
    """The maps along contraction, one curve per pressure, with their own points among them."""
    low, high = min(contractions), max(contractions)
    frames = [pd.DataFrame()]
    for found in maps:
        for p in pressures:
            own = [e for e in found.contractions(p) if low <= e <= high]
            every = np.union1d(contractions, own)
            frames.append(
                _reference_rows(found, every, np.full(every.shape, p), np.isin(every, own))
            )
        left_out = found.suspect[np.isin(found.suspect[:, 0], pressures)]
        if left_out.size:
            rows = pd.DataFrame(left_out, columns=[PRESSURE, CONTRACTION, FORCE])
            named = {"source": found.name, "point": "tabulated", "status": SUSPECT, FLAGS: ""}
            frames.append(rows.assign(**named))
    return pd.concat(frames, ignore_index=True)


def reference_at(
    maps: Iterable[ForceMap], contraction: float, pressures: Sequence[float]
) -> pd.DataFrame:
    """The maps along pressure at one contraction, with their tabulated pressures among them."""
    low, high = min(pressures), max(pressures)
    frames = [pd.DataFrame()]
    for found in maps:
        own = [p for p in found.pressures if low <= p <= high]
        every = np.union1d(pressures, own)
        frames.append(
            _reference_rows(found, np.full(every.shape, contraction), every, np.isin(every, own))
        )
    return pd.concat(frames, ignore_index=True)


def _reference_rows(
    found: ForceMap, contraction: np.ndarray, pressure: np.ndarray, tabulated: np.ndarray
) -> pd.DataFrame:
    """Rows of one curve of a map, without those outside it."""
    force = np.full(pressure.shape, np.nan)
    for p in np.unique(pressure):
        force[pressure == p] = found.force(contraction[pressure == p], p)
    rows = pd.DataFrame(
        {
            "source": found.name,
            "point": np.where(tabulated, "tabulated", "interpolated"),
            CONTRACTION: contraction,
            PRESSURE: pressure,
            FORCE: force,
            "status": REFERENCE,
            FLAGS: "",
        }
    )
    return rows.dropna(subset=[FORCE])
