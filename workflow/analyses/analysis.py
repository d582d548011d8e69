"""Questions about the models: cases beside those of the scenes, and what becomes of them.

An analysis is a folder here, found by its module ``analysis`` and named nowhere else:

analysis.py   ``ANALYSIS``: its name, what it is about and what it writes. Every run reads this, so
              it imports nothing large
cases.py      ``cases(study) -> list[AnalysisCase]``: what to solve, from the muscles of the study.
              Without this module it solves what it needs by itself
table.py      ``tables(study, solved) -> {name: DataFrame}``
figures.py    ``draw(solved, tables) -> {name: Figure}``, if it has figures
files.py      ``texts(study, tables) -> {name: str}``, if it has files of its own
readers.py    ``for_readers(rows, page) -> DataFrame | None``: what a page of the report shows of
              its own table, if not all of it
caption.rst   what its page in the report says

It runs as ``snakemake --cores 2 <name>``.
"""

import importlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from solver.case import Case, digest
from solver.record import Solution
from workflow.data import paper
from workflow.plan.plan import mesh_file
from workflow.plan.promise import Promise
from workflow.study.contents import Study
from workflow.study.errors import StudyError, choices
from workflow.study.study import load

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

FOLDER = Path(__file__).parent
PACKAGE = "workflow.analyses"
PARTS = ("analysis", "cases", "table", "figures", "files")  # of its results
PAPERS = ("dmsp20", "dmsp20_silicone")  # muscles that most are about; the first is the paper's own


@dataclass(frozen=True)
class AnalysisCase:
    """A case of an analysis: its label for people, and tags, which become columns of its table."""

    case: Case
    label: str
    tags: dict[str, str | float] = field(default_factory=dict)
    promise: Promise | None = None  # of a climb, whose first case it is

    @cached_property
    def key(self) -> str:
        """Of the case, or of the climb."""
        return self.promise.key if self.promise else self.case.key

    @cached_property
    def mesh(self) -> str | None:
        """File name of the mesh, None for a model without and of a climb, which makes its own."""
        return None if self.promise else mesh_file(self.case)


@dataclass(frozen=True)
class Solved:
    """A case of an analysis with its record."""

    asked: AnalysisCase
    solution: Solution

    @cached_property
    def states(self) -> "pd.DataFrame":
        """Its rows of the table of states: of its stops, then that of zero force."""
        from workflow.data.records import SolvedCase  # late, as every run reads this module
        from workflow.data.states import state_rows

        case = self.asked.case
        return state_rows([SolvedCase(case, self.solution, case.path.stops)])

    @property
    def at_stops(self) -> "pd.DataFrame":
        """The same without the state of zero force."""
        return self.states.head(len(self.asked.case.path.stops))


@dataclass(frozen=True, kw_only=True)
class Analysis:
    """What an analysis is called, what it is about, and what it writes.

    Attributes
    ----------
    name : that of its folder
    title, chapter : of its page in the report
    target : what Snakemake calls it, if not by its name
    muscles : of the study, that it is about
    tables : in results/tables, with the format of their numbers (None: all digits); its own first
    figures : in results/figures
    page : which of its tables its page has
    on_figures : whether its own table stands on the pages of the figures too that its rows name
    in_dataset : whether its own table is a group of the dataset as well
    takes_hours : so that it runs where it is asked for by name, and not with ``everything``
    """

    name: str
    title: str
    chapter: str
    target: str = ""
    muscles: tuple[str, ...] = ()
    tables: Mapping[str, str | None]
    figures: tuple[str, ...] = ()
    page: tuple[str, ...] = ()
    on_figures: bool = False
    in_dataset: bool = False
    takes_hours: bool = False

    @property
    def modules(self) -> list[str]:
        """Of its parts; what they import belongs to it as well."""
        return [f"{PACKAGE}.{self.name}.{part}" for part in PARTS if self._has(part)]

    @property
    def caption(self) -> Path:
        """The text of its page."""
        return FOLDER / self.name / "caption.rst"

    @property
    def solves_cases(self) -> bool:
        """Whether its cases are known before it runs."""
        return self._has("cases")

    @property
    def failures(self) -> str:
        """File name of the table of its cases that did not work out."""
        return failures_of(self.name)

    def fits(self, study: Study) -> bool:
        """Whether a study has what it is about."""
        own = PAPERS[0]
        named = all(name in study.muscles for name in self.muscles)
        return named and (own not in self.muscles or paper.is_normal(study.muscles[own]))

    def inputs(self, study: Study) -> list[str]:
        """Files of the user that it reads."""
        return []

    def files(self, study: Study) -> list[str]:
        """What else it writes, in results/<name>."""
        return []

    def reads(self, study: Study) -> object:
        """What of the study its tables depend on, beside its cases."""
        return [study.muscles.get(name) for name in self.muscles]

    def cases(self, study: Study) -> list[AnalysisCase]:
        """What to solve.

        Raises
        ------
        StudyError
            If the study does not have what it is about.
        """
        missing = [name for name in self.muscles if name not in study.muscles]
        if missing:
            raise StudyError(
                f"{study.source.path}: the analysis {self.name} is about the muscle {missing[0]}, "
                "which is not there\n  allowed: a study with the muscles of config/config.yaml"
            )
        return list(self._part("cases").cases(study)) if self.solves_cases else []

    def tabulated(self, study: Study, solved: Sequence[Solved]) -> "dict[str, pd.DataFrame]":
        """Its tables by name."""
        return self._checked(self._part("table").tables(study, solved), self.tables)

    def drawn(
        self, solved: Sequence[Solved], tables: "Mapping[str, pd.DataFrame]"
    ) -> "dict[str, Figure]":
        """Its figures by name."""
        found = self._part("figures").draw(solved, tables) if self.figures else {}
        return self._checked(found, self.figures)

    def texts(self, study: Study, tables: "Mapping[str, pd.DataFrame]") -> dict[str, str]:
        """Its other files by name."""
        names = self.files(study)
        return self._checked(self._part("files").texts(study, tables) if names else {}, names)

    def digest(self, study: Study) -> str:
        """Digest of all that its results depend on but records, inputs and sources."""
        asked = [(c.label, c.tags) for c in self.cases(study)]
        return digest(repr((asked, self.reads(study))))

    def _checked(self, found: dict[str, Any], promised: Iterable[str]) -> dict[str, Any]:
        if set(found) != set(promised):
            raise ValueError(f"{self.name}: {sorted(found)} is not {sorted(promised)}")
        return found

    def _has(self, part: str) -> bool:
        return (FOLDER / self.name / f"{part}.py").exists()

    def _part(self, part: str) -> Any:
        return importlib.import_module(f"{PACKAGE}.{self.name}.{part}")


def failures_of(name: str) -> str:
    """File name of the table of failed cases of an analysis."""
    return f"{name}_failures.csv"


def names() -> list[str]:
    """Of all analyses."""
    return sorted(path.parent.name for path in FOLDER.glob("*/analysis.py"))


def named(name: str) -> Analysis:
    """One by its name; raises StudyError if there is none."""
    if name not in names():
        raise StudyError(f"{name}: there is no such analysis\n  allowed: {choices(name, names())}")
    found = importlib.import_module(f"{PACKAGE}.{name}.analysis").ANALYSIS
    assert isinstance(found, Analysis)
    return found


@cache
def cases(name: str, study_file: str) -> tuple[AnalysisCase, ...]:
    """The cases of an analysis; made once a process, because every job of Snakemake asks."""
    return tuple(named(name).cases(load(Path(study_file))))
