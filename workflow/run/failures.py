"""What did not work out, case by case: ``results/tables/failures.csv``.

The cases of the scenes come first. Those of an analysis follow, where it was asked for: it writes a
table of its own, ``<name>_failures.csv``, which gathering takes over, and adds its rows to a table
that is there. A case of both has one row. Only cases of scenes make a run fail.

Cases that were solved, to limits that the user should know of, stand there too: as ``converged``.
"""

import csv
from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path

from geometry.files import atomic_write
from solver.record import Solution
from solver.status import CaseStatus, StateStatus
from workflow.plan.plan import Plan
from workflow.study.folders import LOGS

TABLE = Path("tables", "failures.csv")  # in the folder of a study
COLUMNS = ("case", "label", "status", "states_missing", "reason", "scenes", "log", "analyses")
ANSWERS = {CaseStatus.CONVERGED, CaseStatus.LIMIT_POINT}  # no equilibrium is an answer
Row = dict[str, str]


def write(
    plan: Plan,
    solved: Mapping[str, Solution],
    path: Path,
    strained: Mapping[str, str] | None = None,
    others: Iterable[Path] = (),
) -> None:
    """Write the table of all cases of which there is something to say; often it has a header only.

    ``strained`` says by key which states are beyond a limit of the material, or may be; ``others``
    are the tables of analyses.
    """
    strained = strained or {}
    rows = [
        _row(key, plan.cases[key].label, solution, strained.get(key, ""))
        | {"scenes": " ".join(plan.cases[key].scenes)}
        for key, solution in solved.items()
        if solution.status is not CaseStatus.CONVERGED or key in strained
    ]
    _write(path, _merged(rows, others))


def write_analysis(
    name: str, labels: Mapping[str, str], solved: Mapping[str, Solution], path: Path
) -> None:
    """Write the table of an analysis; label and solution of its cases by key."""
    _write(
        path,
        [
            _row(key, labels[key], solution) | {"analyses": name}
            for key, solution in solved.items()
            if solution.status is not CaseStatus.CONVERGED
        ],
    )


def add(path: Path, others: Iterable[Path]) -> None:
    """Put the rows of analyses, as they are now, into the table of a study."""
    own = [row | {"analyses": ""} for row in read(path) if row["scenes"]]
    _write(path, _merged(own, others))


def read(path: Path) -> list[Row]:
    """The rows of a table."""
    with path.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def _merged(rows: list[Row], others: Iterable[Path]) -> list[Row]:
    """Rows of scenes, with those of the tables of analyses."""
    found = {row["case"]: row for row in rows}
    for path in others:
        for row in read(path):
            known = found.setdefault(row["case"], row | {"analyses": ""})
            names = [*known["analyses"].split(), row["analyses"]]
            found[row["case"]] = known | {"analyses": " ".join(names)}
    return list(found.values())


def _write(path: Path, rows: Iterable[Row]) -> None:
    with atomic_write(path) as beside, beside.open("w", newline="", encoding="utf-8") as stream:
        table = csv.DictWriter(stream, COLUMNS)
        table.writeheader()
        table.writerows(rows)


def _row(key: str, label: str, solution: Solution, strain: str = "") -> Row:
    bad = (StateStatus.NOT_REACHED, StateStatus.INVALID_STATE)
    return {
        "case": key,
        "label": label,
        "status": solution.status.value,
        "states_missing": str(sum(status in bad for status in solution.state_status)),
        "reason": "; ".join(filter(None, (" ".join(t.split()) for t in (solution.reason, strain)))),
        "scenes": "",
        "log": f"{LOGS}/{key}.log",
        "analyses": "",
    }


def report(path: Path) -> tuple[str, bool]:
    """What to tell the user of a table, and whether a case of a scene failed that should not.

    Analyses go where models end, so of their cases it says only how many there are.
    """
    rows = read(path)
    own = [row for row in rows if row["scenes"]]
    lines = [f"{row['label']}: {_said(row['status'])} {row['reason']}" for row in own]
    failed = sum(row["status"] not in ANSWERS for row in own)
    if failed:
        lines.append(f"{failed} case{'s' if failed > 1 else ''} failed; see {path}")
    statuses: dict[str, Counter[str]] = {}
    for row in rows:
        for name in row["analyses"].split():
            statuses.setdefault(name, Counter())[row["status"]] += 1
    for name, counts in sorted(statuses.items()):
        said = ", ".join(f"{count} {status}" for status, count in sorted(counts.items()))
        lines.append(f"analysis {name}: {said}; see {path}")
    return "\n".join(lines), failed > 0


def _said(status: str) -> str:
    return "solved;" if status == CaseStatus.CONVERGED else f"{status},"
