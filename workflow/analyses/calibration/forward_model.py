"""Forces of a muscle with other values of its stiffnesses, computed at once."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from geometry import meridian, section
from solver import freefem
from solver.case import MESHED, Case
from solver.load_path import LoadPath, PathKind
from solver.material import Thread
from solver.solve import solve
from solver.status import StateStatus
from workflow.study.contents import StudiedMuscle, Study
from workflow.study.errors import StudyError

DATA = ("solver/**/*.[ei]dp",)  # whichever model a calibration names


def changed(muscle: StudiedMuscle, values: Mapping[str, float]) -> StudiedMuscle:
    """The muscle with other values of ``thread_stiffness`` [N], ``c10``, ``c01`` [MPa]."""
    rubber = {key: value for key, value in values.items() if key != "thread_stiffness"}
    thread = values.get("thread_stiffness")
    return replace(
        muscle,
        rubber=replace(muscle.rubber, **rubber),
        thread=Thread(stiffness=thread) if thread else muscle.thread,
    )


class ForwardModel:
    """Isobaric forces by a model; each case is solved once, in a folder for scratch files."""

    def __init__(self, study: Study, muscle: StudiedMuscle, folder: Path) -> None:
        self.muscle, self.folder = muscle, folder
        self.variant = study.variants["default"]
        self.limits = freefem.Limits(wall_time=study.wall_time, memory=study.memory)
        self.solved: dict[str, NDArray[np.float64]] = {}

    def forces(
        self,
        values: Mapping[str, float],
        model: str,
        pressure: float,
        stops: Iterable[float],
    ) -> NDArray[np.float64]:
        """Forces at rising contractions [N]; NaN where there is no valid state."""
        muscle = changed(self.muscle, values)
        case = Case(
            muscle=muscle.muscle,
            rubber=muscle.rubber,
            thread=muscle.thread,
            path=LoadPath(kind=PathKind.ISOBARIC, held=pressure, stops=tuple(stops)),
            model=model,
            effects=self.variant.effects,
            numerics=self.variant.numerics,
        )
        if case.key not in self.solved:
            try:
                found, _ = solve(case, self._mesh(case), self.folder / "log", self.limits)
            except freefem.Outside as error:
                raise StudyError(f"not solved: {error}") from None
            good = np.array([status is StateStatus.CONVERGED for status in found.state_status])
            self.solved[case.key] = np.where(good, found.states["force"], np.nan)
        return self.solved[case.key]

    def _mesh(self, case: Case) -> Path | None:
        kind = MESHED.get(case.model)
        path = self.folder / f"{kind}.{'msh' if kind == 'section' else 'mesh'}"
        if kind == "meridian" and not path.exists():
            meridian.write(case.muscle, case.numerics.meridian, path)
        if kind == "section" and not path.exists():
            section.write(case.muscle, case.numerics.section, case.effects.end, path)
        return path if kind else None
