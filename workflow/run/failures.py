"""What did not work out, case by case: ``results/tables/failures.csv``."""

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path

from geometry.files import atomic_write
from solver.record import Solution
from solver.status import CaseStatus, StateStatus
from workflow.plan.plan import Plan

COLUMNS = ("case", "label", "status", "states_missing", "reason", "scenes", "log")
ANSWERS = {CaseStatus.CONVERGED, CaseStatus.LIMIT_POINT}  # no equilibrium is an answer


def write(
    plan: Plan,
    solved: dict[str, Solution],
    path: Path,
    strained: Mapping[str, str] | None = None,
) -> None:
    """Write the table of all cases that are not wholly converged; often it has a header only.

    ``strained`` says by key which states are beyond a limit of the material, or may be.
    """
    strained = strained or {}
    with atomic_write(path) as beside, beside.open("w", newline="", encoding="utf-8") as stream:
        table = csv.DictWriter(stream, COLUMNS)
        table.writeheader()
        for key, solution in solved.items():
            if solution.status is not CaseStatus.CONVERGED or key in strained:
                table.writerow(_row(plan, key, solution, strained.get(key, "")))


def _row(plan: Plan, key: str, solution: Solution, strain: str) -> dict[str, str | int]:
    bad = (StateStatus.NOT_REACHED, StateStatus.INVALID_STATE)
    return {
        "case": key,
        "label": plan.cases[key].label,
        "status": solution.status.value,
        "states_missing": sum(status in bad for status in solution.state_status),
        "reason": " ".join([*solution.reason.split(), *strain.split()]),
        "scenes": " ".join(plan.cases[key].scenes),
        "log": f"results/logs/cases/{key}.log",
    }


def report(path: Path) -> tuple[str, bool]:
    """What to tell the user of a table, and whether a case failed that should not have."""
    with path.open(newline="", encoding="utf-8") as stream:
        rows: Sequence[dict[str, str]] = list(csv.DictReader(stream))
    lines = [f"{row['label']}: {row['status']}, {row['reason']}" for row in rows]
    failed = sum(row["status"] not in ANSWERS for row in rows)
    if failed:
        lines.append(f"{failed} case{'s' if failed > 1 else ''} failed; see {path}")
    return "\n".join(lines), failed > 0
