"""Forces of a muscle with other stiffnesses or another shape, computed at once."""

import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from geometry.braid import Braid
from geometry.make import make
from geometry.muscle import Muscle
from solver import freefem
from solver.case import Case, digest
from solver.load_path import LoadPath, PathKind
from solver.material import Thread
from solver.models import MODELS
from solver.numerics import Numerics
from solver.solve import solve
from workflow.data.records import SolvedCase
from workflow.data.states import GOOD, state_rows
from workflow.study.contents import StudiedMuscle, Study
from workflow.study.errors import StudyError
from workflow.study.muscles import CAP_PER_WALL
from workflow.study.schema import SHAPES

# A calibration may name any model, so all of them are sources.
DATA = ("geometry/*.py", "solver/**/*.py", "solver/**/*.[ei]dp")


def changed(muscle: StudiedMuscle, values: Mapping[str, float]) -> StudiedMuscle:
    """The muscle with other values of ``thread_stiffness`` [N], of its rubber and its geometry."""
    shape = {key: value for key, value in values.items() if key in SHAPES}
    thread = values.get("thread_stiffness")
    rubber = {k: v for k, v in values.items() if k not in (*SHAPES, "thread_stiffness")}
    return replace(
        muscle,
        muscle=reshaped(muscle.muscle, shape) if shape else muscle.muscle,
        rubber=replace(muscle.rubber, **rubber),
        thread=Thread(stiffness=thread) if thread else muscle.thread,
    )


def shape_of(muscle: Muscle) -> dict[str, float]:
    """Braid angle [degree], wall and mean radius of both layers [mm]."""
    braid = muscle.braid
    assert isinstance(braid, Braid)  # see workflow/study/checks.py
    angle, radius = math.degrees(braid.angle), braid.mean_diameter / 2
    return dict(zip(SHAPES, (angle, muscle.wall_thickness, radius), strict=True))


def reshaped(muscle: Muscle, values: Mapping[str, float]) -> Muscle:
    """The muscle with some of ``shape_of`` changed, the others as they are.

    Both layers move together; the tube's inner diameter stays, and its length in the fitting is
    that of another wall if it was the usual one.
    """
    braid = muscle.braid
    assert isinstance(braid, Braid)
    shape = {**shape_of(muscle), **values}
    moved = round(2 * shape["layer_radius"] - braid.mean_diameter, 9)
    inner, outer = (d + moved for d in braid.layer_diameters)
    usual = muscle.cap_length == CAP_PER_WALL * muscle.wall_thickness
    return replace(
        muscle,
        wall_thickness=shape["wall_thickness"],
        cap_length=CAP_PER_WALL * shape["wall_thickness"] if usual else muscle.cap_length,
        braid=Braid.from_angle(
            angle=shape["angle"], threads=braid.threads, layer_diameters=(inner, outer)
        ),
    )


class ForwardModel:
    """Curves by a model; each case is solved once, in a folder for scratch files."""

    def __init__(self, study: Study, muscle: StudiedMuscle, folder: Path) -> None:
        self.muscle, self.folder = muscle, folder
        self.variant = study.variants["default"]
        self.limits = freefem.Limits(wall_time=study.wall_time, memory=study.memory)
        self.solved: dict[str, pd.DataFrame] = {}

    def forces(
        self,
        values: Mapping[str, float],
        model: str,
        pressure: float,
        stops: Iterable[float],
    ) -> NDArray[np.float64]:
        """Forces at rising contractions [N]; NaN where there is no valid state."""
        found = self.states(values, model, pressure, stops)
        return np.asarray(found["force"].where(found["status"] == GOOD))

    def states(
        self,
        values: Mapping[str, float],
        model: str,
        pressure: float,
        stops: Iterable[float],
    ) -> pd.DataFrame:
        """Rows of the table of states, at rising contractions."""
        path = LoadPath(kind=PathKind.ISOBARIC, held=pressure, stops=tuple(stops))
        return self.along(values, model, path)

    def along(
        self,
        values: Mapping[str, float],
        model: str,
        path: LoadPath,
        numerics: Numerics | None = None,
    ) -> pd.DataFrame:
        """Rows of the table of states along a path."""
        settings = {**vars(self.variant), **({"numerics": numerics} if numerics else {})}
        case = changed(self.muscle, values).case(path, model, **settings)
        if case.key not in self.solved:
            try:
                found, _ = solve(case, self._mesh(case), self.folder / "log", self.limits)
            except freefem.Outside as error:
                raise StudyError(f"not solved: {error}") from None
            self.solved[case.key] = state_rows([SolvedCase(case, found, case.path.stops)])
        return self.solved[case.key]

    def _mesh(self, case: Case) -> Path | None:
        spec = case.mesh_spec()
        if spec is None:
            return None
        path = self.folder / f"{digest(spec)}.{MODELS[case.model].suffix}"
        if not path.exists():
            make(json.loads(spec), path)
        return path
