"""Which pages the report has: of figures, of tables, of analyses, each in its chapter."""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from workflow.analyses.registry import ANALYSES
from workflow.plan.plan import Plan

HERE = Path(__file__).parent
PAPER, VERDICT, HARD = "1 The paper's figures", "2 The verdict", "5 Hard cases"
CHAPTERS = {"deviation": VERDICT, "failures": HARD}  # of tables of the scenes; analyses have theirs


@dataclass(frozen=True)
class Page:
    """A page, and what it is made of; ``judged`` are tables that add to it where they are there."""

    name: str
    chapter: str
    title: str
    caption: Path
    pictures: tuple[Path, ...]
    tables: tuple[Path, ...]
    judged: tuple[Path, ...] = ()

    @property
    def is_ready(self) -> bool:
        """Whether all that it must have is there."""
        return all(path.is_file() for path in (*self.pictures, *self.tables))

    @property
    def all_tables(self) -> tuple[Path, ...]:
        """Those that are there, or are to be."""
        return (*self.tables, *(path for path in self.judged if path.is_file()))


def of_study(plan: Plan, results: Path, drawn: Iterable[str], tables: Iterable[str]) -> list[Page]:
    """All pages there may be of a study: of its figures, of ``tables`` of it, of analyses."""
    fitting = [each for each in ANALYSES.values() if each.fits(plan.study)]
    judged = tuple(results / f"tables/{each.name}.csv" for each in fitting if each.on_figures)
    pages = []
    for scene in drawn:
        title = re.sub("^fig0?", "Figure ", scene)
        picture = results / f"figures/{scene}.png"
        pages.append(Page(scene, PAPER, title, caption_of(scene), (picture,), (), judged))
    for table in map(Path, tables):
        name = table.stem
        caption = caption_of(name)
        pages.append(Page(name, CHAPTERS[name], name.capitalize(), caption, (), (table,)))
    for each in fitting:
        if not (each.figures or each.page):
            continue
        pictures = tuple(results / f"figures/{picture}.png" for picture in each.figures)
        own = tuple(results / f"tables/{table}.csv" for table in each.page)
        pages.append(Page(each.name, each.chapter, each.title, each.caption, pictures, own))
    return pages


def caption_of(page: str) -> Path:
    """What a figure or table of the scenes shows; a new figure may have no words yet."""
    own = HERE / f"{page}.rst"
    return own if own.exists() else own.with_name("unnamed.rst")
