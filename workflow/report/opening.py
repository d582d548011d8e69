"""What the report opens with: the verdict on the paper, what accuracy costs, what is open.

All of it is read from the tables of results. An analysis that has not been run is named with the
command that runs it.
"""

import html
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import pandas as pd

from geometry.files import atomic_write
from solver.models import MODELS
from workflow.analyses.accuracy import costs
from workflow.analyses.analysis import Analysis
from workflow.analyses.claims import readers
from workflow.analyses.claims.claim import Verdict
from workflow.analyses.registry import ANALYSES
from workflow.data import deviation
from workflow.plan.plan import Plan
from workflow.report import html_page, tables
from workflow.report.pages import Page

DEFAULT_MESH = "1/1"  # as the analysis of accuracy calls it
FILE = "report/opening.rst"  # in the folder of a study
WORDS = Path(__file__).with_name("workflow.rst")
MAP = "festo_musclesim"  # the manufacturer's, to which the paper's mean deviation refers
PAPERS_MEAN = "-9.9 %"  # Fig. 4
# Snakemake's page centres what it opens with, so the top of a long text is out of reach.
STYLE = """
.h-screen:has(.opening) { align-items: flex-start }
.prose:has(.opening) { max-width: none }
.opening { font: 14px/1.5 system-ui, sans-serif; max-width: 64em; text-align: left }
.opening h2 { font-size: 1.25em; font-weight: bold; margin: 1.2em 0 .4em }
.opening p, .opening ul { margin: .5em 0 }
.opening ul { list-style: disc; padding-left: 1.4em }
.opening table { border-collapse: collapse; margin: .6em 0; display: block; overflow-x: auto }
.opening caption { text-align: left; padding: .3em 0 }
.opening th, .opening td { border-bottom: 1px solid #9996; padding: .2em .6em; text-align: left }
.opening td.number { text-align: right; white-space: nowrap }
.opening tr.reproduced td:last-child { background: #2a92; }
.opening tr.partly td:last-child { background: #ea02; }
.opening tr.not-reproduced td:last-child { background: #d422; }
.opening code { font-size: .92em }
.opening code::before, .opening code::after { content: none }
"""


def prepare(plan: Plan, results: Path, ready: Iterable[Page]) -> Path:
    """Write the opening, which is returned, and the pages that are ready.

    A report runs no job, so its pages are written here: those of figures and tables after a usual
    run, those of an analysis after that.
    """
    for page in ready:
        output = results / f"report/{page.name}.html"
        html_page.write(output, page.title, page.caption, page.pictures, page.all_tables)
    fitting = [each for each in ANALYSES.values() if each.fits(plan.study)]
    with atomic_write(results / FILE) as beside:
        beside.write_text(text(results, fitting), encoding="utf-8")
    return results / FILE


def text(results: Path, fitting: Sequence[Analysis]) -> str:
    """The opening as reStructuredText, which Snakemake reads as a template of Jinja."""
    parts = [*_verdict(results, fitting), *_accuracy(results, fitting), *_open(results, fitting)]
    body = "\n".join(parts)
    inside = f'<div class="opening"><style>{STYLE}</style>\n{body}\n</div>'
    lines = "\n".join(f"   {line}" for line in inside.splitlines())
    words = WORDS.read_text(encoding="utf-8").strip()
    return f"{{% raw %}}\n.. raw:: html\n\n{lines}\n\n{words}\n{{% endraw %}}\n"


def _verdict(results: Path, fitting: Sequence[Analysis]) -> Iterator[str]:
    if not _named("claims", fitting):
        return
    yield "<h2>Does the paper hold?</h2>"
    rows = _table(results, "claims")
    mean = _mean_deviation(results)
    if mean is not None:
        yield (
            f"<p>Mean deviation of the force from the manufacturer's map: <b>{100 * mean:.1f} %</b>"
            f" (the paper: {PAPERS_MEAN}), with a thread stiffness chosen for it.</p>"
        )
    if rows is None:
        yield f"<p>The claims have not been judged: {_command('claims', fitting)}</p>"
        return
    counts = rows["verdict"].value_counts()
    said = ", ".join(f"{counts[v]} {v.value}" for v in Verdict if v in counts)
    yield f"<p>Of {len(rows)} claims: {said}. Reasons stand on the page “The paper's claims”.</p>"
    shown = readers.for_readers(rows, readers.NAME)
    assert shown is not None  # the page of all of them
    yield html_page.table(shown[["claim", "paper", "ours", "verdict"]], "claims")


def _accuracy(results: Path, fitting: Sequence[Analysis]) -> Iterator[str]:
    if not _named("accuracy", fitting):
        return
    yield "<h2>What accuracy costs</h2>"
    rows = _table(results, "accuracy")
    if rows is None:
        yield f"<p>Not measured yet: {_command('accuracy', fitting)}</p>"
        return
    yield (
        "<p>One curve of the normal condition (0.3 MPa, 0 to 20 %), every model on its default "
        "mesh: largest error of the force against what the solid converges to, as a share of its "
        "largest, and the processor time and memory of its solve on this machine.</p>"
    )
    yield html_page.table(by_model(rows), "accuracy")


def by_model(rows: pd.DataFrame) -> pd.DataFrame:
    """Error and cost of every model on its default mesh, from the table of the analysis."""
    chosen = rows[(rows["set"] == "mesh") & (rows["mesh"].isna() | (rows["mesh"] == DEFAULT_MESH))]
    spent = costs.of_cases(chosen["case"])
    lines = []
    for row in chosen.to_dict("records"):
        cost = spent.loc[row["case"]] if row["case"] in spent.index else {}
        lines.append(
            {
                "model": MODELS[row["model"]].label,
                "error [%]": float(f"{100 * row['total_error [1]']:.2g}"),
                **{name: cost.get(name, float("nan")) for name in (costs.SOLVE, costs.MEMORY)},
            }
        )
    return pd.DataFrame(lines)


def _open(results: Path, fitting: Sequence[Analysis]) -> Iterator[str]:
    yield "<h2>What is open</h2>\n<ul>"
    rows = _table(results, "claims")
    if rows is not None:
        for row in rows[rows["verdict"] == Verdict.NOT_REPRODUCED.value].to_dict("records"):
            what, why = _plain(row["claim"]), _plain(row["why"])
            yield f"<li>{row['id']}, {what}: not reproduced, {why}.</li>"
    failures = _table(results, "failures")
    if failures is not None:
        said = "every case reached all its states" if failures.empty else "see the page “Failures”"
        yield f"<li>Cases that ended early or are marked: {len(failures)}; {said}.</li>"
    missing = [each for each in fitting if _table(results, next(iter(each.tables))) is None]
    for each in missing:
        yield f"<li>Not run: {_plain(each.title)}. {_command(each.name, fitting)}</li>"
    if not missing:
        yield "<li>All analyses have been run.</li>"
    yield "</ul>"


def _mean_deviation(results: Path) -> float | None:
    """Of the fullest model from the manufacturer's map, by the rule; None if that is not known."""
    rows = _table(results, "deviation")
    if rows is None:
        return None
    chosen = rows[
        (rows["reference"] == MAP)
        & (rows["interpolation"] == deviation.RULE)
        & (rows["pressure [MPa]"] == deviation.ALL)
        & (rows["variant"] == "default")
    ]
    ranked = sorted(chosen.to_dict("records"), key=lambda row: -MODELS[row["model"]].rank)
    return float(ranked[0]["mean_relative [1]"]) if ranked else None


def _table(results: Path, name: str) -> pd.DataFrame | None:
    path = results / f"tables/{name}.csv"
    if not path.is_file():
        return None
    return tables.read(path)


def _named(name: str, fitting: Sequence[Analysis]) -> Analysis | None:
    return next((each for each in fitting if each.name == name), None)


def _command(name: str, fitting: Sequence[Analysis]) -> str:
    each = _named(name, fitting)
    assert each is not None
    return f"<code>.venv/bin/snakemake --cores 2 {each.target or each.name}</code>"


def _plain(words: object) -> str:
    return html.escape(str(words))
