"""Forces of a muscle with other values of its stiffnesses, computed at once."""

import json
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from geometry.make import make
from solver import freefem
from solver.case import Case, digest
from solver.load_path import LoadPath, PathKind
from solver.material import Thread
from solver.models import MODELS
from solver.solve import solve
from workflow.data.records import SolvedCase
from workflow.data.states import GOOD, state_rows
from workflow.study.contents import StudiedMuscle, Study
from workflow.study.errors import StudyError

# A calibration may name any model, so all of them are sources.
DATA = ("geometry/*.py", "solver/**/*.py", "solver/**/*.[ei]dp")


def changed(muscle: StudiedMuscle, values: Mapping[str, float]) -> StudiedMuscle:
    """The muscle with other values of ``thread_stiffness`` [N] and parameters of its rubber."""
    rubber = {key: value for key, value in values.items() if key != "thread_stiffness"}
    thread = values.get("thread_stiffness")
    return replace(
        muscle,
        rubber=replace(muscle.rubber, **rubber),
        thread=Thread(stiffness=thread) if thread else muscle.thread,
    )


class ForwardModel:
    """Isobaric curves by a model; each case is solved once, in a folder for scratch files."""

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
        case = changed(self.muscle, values).case(path, model, **vars(self.variant))
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
