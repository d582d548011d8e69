"""Cases solved at once, outside a run: the record is taken from the store, or put there."""

import json
import tempfile
from dataclasses import replace
from pathlib import Path

from geometry import attempt
from geometry.make import make
from geometry.seal import write_why_none
from solver import freefem, record
from solver.case import Case
from solver.models import MODELS
from solver.record import NoRecord, Solution, code_digest
from solver.solve import solve
from workflow.data import records
from workflow.study.contents import Study
from workflow.study.errors import StudyError
from workflow.study.folders import LOGS


class Store:
    """Records of a folder, as ``python -m solver`` writes them.

    Attributes
    ----------
    solves : cases that were solved since, by model; what has a record is not solved again
    """

    def __init__(self, study: Study, folder: Path = records.FOLDER) -> None:
        self.folder, self.solves = folder, dict[str, int]()
        self._limits = freefem.Limits(wall_time=study.wall_time, memory=study.memory)

    def solution(self, case: Case) -> Solution:
        """The solution of a case: that of its record, if the sources that made it are those of now.

        Raises
        ------
        StudyError
            If it failed for a reason that says nothing about the case.
        """
        path, code = records.path_of(case.key, self.folder), _code(case)
        try:
            found = record.read(path)[1] if path.exists() else None
        except NoRecord:
            found = None  # damaged, or of another version
        if found is not None and found.code == code:
            return found
        try:
            with tempfile.TemporaryDirectory() as scratch:
                solution = self._solve(case, Path(scratch))
        except (OSError, MemoryError, freefem.Outside, attempt.Failed) as error:
            raise StudyError(f"not solved, to be tried again: {error}") from None
        solution = replace(solution, code=code)
        self.solves[case.model] = self.solves.get(case.model, 0) + 1
        record.write(path, case, solution)
        return solution

    def _solve(self, case: Case, scratch: Path) -> Solution:
        """Solve it on a mesh of its own: one of a run may be of other sources."""
        mesh, spec = None, case.mesh_spec()
        if spec is not None:
            mesh = scratch / f"mesh.{MODELS[case.model].suffix}"
            limits = self._limits.wall_time, self._limits.memory
            why = attempt.why_not(lambda: make(json.loads(spec), mesh), *limits)
            if why:
                write_why_none(mesh, why)
        LOGS.mkdir(parents=True, exist_ok=True)
        return solve(case, mesh, LOGS / f"{case.key}.log", self._limits)[0]


def _code(case: Case) -> str:
    return code_digest(case.model, law=case.rubber.law())
