"""From a case and its mesh to its record: what ``python -m solver`` does, and a batch for each."""

import json
import sys
import time
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from geometry.files import atomic_write
from solver import record
from solver.case import Case
from solver.follow import DamagedMesh
from solver.freefem import Limits, Outside, Usage
from solver.solve import solve


@dataclass(frozen=True, kw_only=True)
class Job:
    """A case and its files.

    Attributes
    ----------
    mesh : made by geometry; None of models without
    cost : JSON file, of seconds and memory
    log : what FreeFEM prints
    code : digest of the sources, as in Solution
    """

    case: Case
    mesh: Path | None
    record: Path
    cost: Path
    log: Path
    limits: Limits
    code: str = ""

    def run(self, start: float, used: float = 0.0) -> str:
        """Solve the case; write record and cost.

        ``start`` [s] is when that began, ``used`` what this process had used of the processor then.

        Says why there is no record, if it failed for a reason outside the case; else nothing,
        however the solve went.
        """
        try:
            self.log.parent.mkdir(parents=True, exist_ok=True)
            self.log.write_text("")
            began = time.process_time()
            solution, usage = solve(self.case, self.mesh, self.log, self.limits)
            solving = time.process_time() - began
            record.write(self.record, self.case, replace(solution, code=self.code))
            python = time.process_time() - used - solving
            self._write_cost(start, python, solving, solution.status, usage)
        except DamagedMesh as error:
            assert self.mesh is not None
            self.mesh.unlink(missing_ok=True)  # else it would be so for ever
            return f"{error}, and deleted"
        except (OSError, MemoryError, Outside) as error:
            return str(error) or type(error).__name__
        return ""

    def _write_cost(
        self, start: float, python: float, solving: float, status: str, usage: Usage | None
    ) -> None:
        cost = {
            "total_seconds": time.monotonic() - start,
            "python_cpu_seconds": python,
            "solve_cpu_seconds": solving,  # of Python alone
            "status": status,
        }
        if usage is not None:
            values = asdict(usage)
            values |= values.pop("parts")
            cost |= {f"freefem_{name}": value for name, value in values.items()}
        with atomic_write(self.cost, sealed=False) as beside:
            beside.write_text(json.dumps(cost, sort_keys=True) + "\n")


def say(why: str) -> None:
    """Tell the user why a case has no record; in one piece, beside other processes that do."""
    sys.stderr.write(f"not solved, to be tried again: {why}\n")
