"""Studies of the models themselves: cases beside those of the scenes, and what becomes of them.

A study is a folder here whose module ``cases`` has

- ``cases(study) -> list[StudyCase]``  what to solve, from the muscles of the study file
- ``table(solved) -> DataFrame``       all that its figures draw, and more
- ``draw(solved, table)``             figures by name, those of FIGURES
- ``notes(table) -> DataFrame``       of those in NOTED: the rows that a reader must know

and runs as ``snakemake --cores 2 <name>``.
"""

import importlib
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cache, cached_property
from pathlib import Path
from types import ModuleType

from solver.case import Case
from solver.record import Solution
from workflow.plan.plan import mesh_file
from workflow.study.errors import StudyError, choices
from workflow.study.study import load

FIGURES = {
    "robustness": ("robustness", "robustness_worst"),
    "claims": (),
    "accuracy": ("accuracy", "accuracy_orders"),
    "effects": ("effects",),
    "threads": ("threads", "threads_correction"),
    "sensitivity": ("sensitivity",),
}
NOTED = ("robustness",)  # write <name>_notes.csv beside their table
IN_DATASET = ("robustness", "threads")  # tables that are groups of the dataset as well


@dataclass(frozen=True)
class StudyCase:
    """A case of a study: its label for people and its tags, which become columns of the table."""

    case: Case
    label: str
    tags: dict[str, str | float] = field(default_factory=dict)

    @cached_property
    def mesh(self) -> str | None:
        """File name of the mesh, None for a model without."""
        return mesh_file(self.case)


@dataclass(frozen=True)
class Solved:
    """A case of a study with its solution."""

    asked: StudyCase
    solution: Solution


def module(name: str) -> ModuleType:
    """The module of a study; raises StudyError if there is none."""
    if name not in FIGURES:
        raise StudyError(f"{name}: there is no such study\n  allowed: {choices(name, FIGURES)}")
    return importlib.import_module(f"workflow.analyses.{name}.cases")


@cache
def cases(name: str, study_file: str) -> tuple[StudyCase, ...]:
    """The cases of a study; made once a process, because every job of Snakemake asks."""
    asked: Iterable[StudyCase] = module(name).cases(load(Path(study_file)))
    return tuple(asked)
