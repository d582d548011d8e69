"""All figures that the default study and its analyses make, with what makes each.

Pictures are those of results, as far as they have been made; of a figure without one the command is
all that is shown. Each is drawn again by a run, so none stands in the repository but that of the
README.
"""

import base64
import html
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from solver.sources import ROOT
from workflow.analyses.registry import ANALYSES
from workflow.plan.plan import read
from workflow.report import pages
from workflow.study.folders import DEFAULT

RESULTS = ROOT / "results"


def figures() -> str:
    """The gallery as HTML in Markdown: picture, caption, command."""
    return f'<div class="gallery">\n{"".join(_entries(RESULTS))}\n</div>\n'


def _entries(results: Path) -> Iterator[str]:
    study = ROOT / DEFAULT
    for scene in read(study).study.scenes:
        yield _entry(results, scene, ".venv/bin/snakemake --cores 2", pages.caption_of(scene))
    for each in ANALYSES.values():
        for picture in each.figures:
            command = f".venv/bin/snakemake --cores 2 {each.target or each.name}"
            yield _entry(results, picture, command, each.caption)


def _entry(results: Path, name: str, command: str, caption: Path) -> str:
    words = html.escape(" ".join(caption.read_text(encoding="utf-8").split()).replace("``", ""))
    path = results / f"figures/{name}.png"
    shown = '<p class="none">not drawn in this copy</p>'
    if path.is_file():
        data = base64.b64encode(path.read_bytes()).decode()
        shown = f'<img alt="{name}" src="data:image/png;base64,{data}" loading="lazy">'
    return (
        f'<figure id="{name}">{shown}<figcaption><b>{name}</b> {words}'
        f"<br><code>{command}</code></figcaption></figure>\n"
    )


PARTS: Mapping[str, Callable[[], str]] = {"figures": figures}
