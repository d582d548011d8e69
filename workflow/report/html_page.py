"""Pages of the report: a caption, pictures and tables as one HTML file that needs nothing else.

A picture as wide as the page and as tall as it has to be; a table with a line per row, or with what
its analysis says that readers of this page want of it (workflow/analyses/<name>/readers.py).
"""

import base64
import html
from collections.abc import Iterable
from importlib import import_module
from pathlib import Path

import pandas as pd

from geometry.files import atomic_write
from geometry.readable import plain
from workflow.report.tables import read

ANALYSES = Path(__file__).parents[1] / "analyses"
DATA = ("workflow/analyses/*/readers.py", "workflow/analyses/*/__init__.py")
STYLE = """
body { font: 14px/1.4 system-ui, sans-serif; margin: 1em; color: #222; max-width: 75em }
img { display: block; max-width: 100%; height: auto; margin: 1em 0 }
table { border-collapse: collapse; margin: 1em 0 }
caption { text-align: left; font-weight: bold; padding: .4em 0 }
th, td { border-bottom: 1px solid #ddd; padding: .3em .6em; text-align: left; vertical-align: top }
th { position: sticky; top: 0; background: #fff }
td, th { overflow-wrap: break-word }
@media (max-width: 48rem) { table { display: block; overflow-x: auto } }
td.number { text-align: right; white-space: nowrap }
.reproduced { background: #dcefdc }
.partly { background: #fdf3cf }
.not-reproduced { background: #f8dcd8 }
.not-testable { background: #eee }
"""


def write(
    output: Path, title: str, caption: Path, pictures: Iterable[Path], tables: Iterable[Path]
) -> None:
    """Write a page, whole or not at all."""
    parts = [f"<p>{html.escape(caption.read_text(encoding='utf-8').strip())}</p>"]
    parts += [picture(path) for path in pictures]
    for path in tables:
        rows = read(path)
        shown = for_readers(path.stem, rows, output.stem)
        if shown is not None:
            parts.append(table(shown, path.stem))
    document = (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{html.escape(title)}'
        f"</title>\n<style>{STYLE}</style></head>\n<body><h1>{html.escape(title)}</h1>\n"
        + "\n".join(parts)
        + "\n</body></html>\n"
    )
    with atomic_write(output) as beside:
        beside.write_text(document, encoding="utf-8")


def for_readers(name: str, rows: pd.DataFrame, page: str) -> pd.DataFrame | None:
    """What a page shows of a table; None if nothing of it belongs there."""
    if not (ANALYSES / name / "readers.py").exists():
        return rows
    chosen: pd.DataFrame | None = import_module(f"workflow.analyses.{name}.readers").for_readers(
        rows, page
    )
    return chosen


def write_beside(output: Path, title: str, caption: str, *, rows: bool = True) -> None:
    """A page of the picture and, with its ``rows``, the table of the same name beside it."""
    words = Path(__file__).with_name(f"{caption}.rst")
    tables = [output.with_suffix(".csv")] if rows else []
    write(output.with_suffix(".html"), title, words, [output.with_suffix(".png")], tables)


def picture(path: Path) -> str:
    """A PNG file inside the page."""
    data = base64.b64encode(path.read_bytes()).decode()
    return f'<img alt="{html.escape(path.stem)}" src="data:image/png;base64,{data}">'


def table(rows: pd.DataFrame, title: str) -> str:
    """A table; a column ``verdict`` colours its rows."""
    head = "".join(f"<th>{html.escape(str(column))}</th>" for column in rows.columns)
    lines = []
    for row in rows.to_dict("records"):
        look = str(row.get("verdict", "")).replace(" ", "-")
        lines.append(f'<tr class="{html.escape(look)}">{"".join(map(_cell, row.values()))}</tr>')
    body = "\n".join(lines)
    heading = f"{title} ({len(rows)} rows)" if len(rows) else f"{title}: no rows"
    return (
        f"<table><caption>{html.escape(heading)}</caption>\n<thead><tr>{head}</tr></thead>\n"
        f"<tbody>{body}</tbody></table>"
    )


def _cell(value: object) -> str:
    if isinstance(value, int | float):
        shown = str(int(value)) if isinstance(value, int) else plain(value, 5)
        return f'<td class="number">{"" if pd.isna(value) else shown}</td>'
    return f"<td>{html.escape(str(value))}</td>"
