"""Records of planned cases, read by name: a missing, foreign or damaged file is never data."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

from solver import record
from solver.case import Case
from solver.record import Solution
from solver.status import CaseStatus, StateStatus
from workflow.data import settled
from workflow.data.strain import judged
from workflow.plan.plan import Kept, Place, Plan
from workflow.plan.promise import Promise
from workflow.study import folders
from workflow.study.errors import StudyError

FOLDER = folders.CASES


class Asked(Protocol):
    """A case that is asked for, or a climb."""

    @property
    def case(self) -> Case:
        """What is solved, first."""

    @property
    def label(self) -> str:
        """What people call it."""

    @property
    def promise(self) -> Promise | None:
        """Of a climb."""


@dataclass(frozen=True)
class SolvedCase:
    """A case with its record, and those of its stops that are wanted.

    ``finer`` is the same on a mesh twice as fine, where a scene asks for measured errors or
    a climb has had it, ``coarser`` that on the next coarser mesh of the ladder, where a climb has.
    """

    case: Case
    solution: Solution
    stops: tuple[float, ...]
    finer: Solution | None = field(default=None, kw_only=True)
    coarser: Solution | None = field(default=None, kw_only=True)


@dataclass(frozen=True)
class Curve(SolvedCase):
    """A solved case at one of its places, and what a climb has promised of it."""

    place: Place
    kept: Kept | None = None

    @property
    def key(self) -> str:
        """Of the case."""
        return self.case.key


def path_of(key: str, folder: Path = FOLDER) -> Path:
    """The file of a case."""
    return folder / f"{key}.h5"


def curves_of_study(plan: Plan, folder: Path = FOLDER, *, partial: bool = False) -> list[Curve]:
    """All curves of a study, with all their stops."""
    solved = read(plan, plan.cases, folder, partial=partial)
    return [
        _curve(plan, place, key, solved, planned.case.path.stops, folder)
        for key, planned in plan.cases.items()
        for place in planned.places
    ]


def curves_of_scene(
    plan: Plan, scene: str, folder: Path = FOLDER, *, partial: bool = False
) -> list[Curve]:
    """The curves of a scene, with the stops that it asks for (its cases may have more)."""
    places = plan.scenes.get(scene, {})
    finer = [plan.finer[key] for key in places.values() if key in plan.finer]
    solved = read(plan, [*places.values(), *finer], folder, partial=partial)
    asked = plan.study.scenes[scene]
    return [
        _curve(
            plan,
            place,
            key,
            solved,
            plan.cases[key].case.path.stops if asked.in_time else asked.swept,
            folder,
        )
        for place, key in places.items()
    ]


def _curve(
    plan: Plan,
    place: Place,
    key: str,
    solved: Mapping[str, tuple[Case, Solution]],
    stops: tuple[float, ...],
    folder: Path,
) -> Curve:
    """A curve, judged by what the materials of its muscle bear."""
    case, solution = solved[key]
    limits = plan.study.muscles[place.muscle].limits
    by, coarser = plan.meshes_by.get(key, ("", ""))
    finer = solved.get(plan.finer.get(key, ""))
    return Curve(
        case,
        judged(case, solution, limits),
        stops,
        place,
        plan.kept.get(place),
        finer=finer[1] if finer else _tried(by, solution, folder),
        coarser=_tried(coarser, solution, folder),
    )


def _tried(key: str, own: Solution, folder: Path) -> Solution | None:
    """What a climb has tried by the model that it took: no rule keeps it, or makes it again."""
    there = found(key, folder) if key else None
    return there[1] if there and there[1].code == own.code else None


def read(
    plan: Plan, keys: Iterable[str], folder: Path = FOLDER, *, partial: bool = False
) -> dict[str, tuple[Case, Solution]]:
    """Case and solution by key; if ``partial``, one that has no record is ``not_solved``.

    Raises
    ------
    StudyError
        If a file is missing, damaged, or the record of another case.
    """
    return {
        key: not_solved(plan.cases[key].case)
        if partial and not path_of(key, folder).exists()
        else read_one(key, plan.cases[key].label, folder)
        for key in dict.fromkeys(keys)
    }


def taken(asked: Asked) -> str:
    """The key of the record of a case, or of the one that a climb has come to.

    Raises
    ------
    StudyError
        If the climb has not ended.
    """
    if asked.promise is None:
        return asked.case.key
    end = settled.outcome(asked.promise.key)
    if end is None:
        raise StudyError(f"{asked.label}: its climb has not ended; run snakemake")
    return str(end["record"])


def not_solved(case: Case) -> tuple[Case, Solution]:
    """In place of a record: a case without any state."""
    count = case.path.states
    return case, Solution(
        status=CaseStatus.NOT_SOLVED,
        reason="there is no record of it yet",
        states=record.unreached(count, record.variables(case)),
        state_status=[StateStatus.NOT_REACHED] * count,
    )


def read_one(key: str, label: str, folder: Path = FOLDER) -> tuple[Case, Solution]:
    """Case and solution of a key; ``label`` is what messages call it. Raises as ``read``."""
    path = path_of(key, folder)
    if not path.exists():
        raise StudyError(f"{path}: there is no record of {label}; run snakemake")
    try:
        case, solution = record.read(path)
    except ValueError as error:
        raise StudyError(
            f"{path}: should hold {label} but is no record\n  {error}\n"
            "  delete the file and run snakemake to solve the case again"
        ) from None
    if case.key != key:
        raise StudyError(f"{path}: should hold {label} ({key}) but holds case {case.key}")
    return case, solution


def found(key: str, folder: Path = FOLDER) -> tuple[Case, Solution] | None:
    """Case and solution of a key; None if there is no record of it that can be read."""
    if not path_of(key, folder).exists():
        return None
    try:
        return read_one(key, key, folder)
    except StudyError:
        return None


def status(key: str, label: str) -> str:
    """Status in the record of a case, or why there is none: ``not solved``, ``damaged``."""
    if not path_of(key).exists():
        return "not solved"
    try:
        return read_one(key, label)[1].status.value
    except StudyError:
        return "damaged"
