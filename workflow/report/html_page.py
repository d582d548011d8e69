"""Pages of the report: a caption, pictures and tables as one HTML file that needs nothing else.

A picture as wide as the page and as tall as it has to be; a table with a line per row. Of the
scorecard a page shows the claims of its figure, so that every figure says how far it agrees.
"""

import base64
import html
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pandas as pd

from geometry.files import atomic_write

STYLE = """
body { font: 14px/1.4 system-ui, sans-serif; margin: 1em; color: #222; max-width: 75em }
img { display: block; max-width: 100%; height: auto; margin: 1em 0 }
table { border-collapse: collapse; margin: 1em 0 }
caption { text-align: left; font-weight: bold; padding: .4em 0 }
th, td { border-bottom: 1px solid #ddd; padding: .3em .6em; text-align: left; vertical-align: top }
th { position: sticky; top: 0; background: #fff }
td.number { text-align: right; white-space: nowrap }
.reproduced { background: #dcefdc }
.partly { background: #fdf3cf }
.not-reproduced { background: #f8dcd8 }
.not-testable { background: #eee }
"""
SCORECARD = "claims"  # stem of its file


def write(
    output: Path, title: str, caption: Path, pictures: Iterable[Path], tables: Iterable[Path]
) -> None:
    """Write a page, whole or not at all."""
    parts = [f"<p>{html.escape(caption.read_text(encoding='utf-8').strip())}</p>"]
    parts += [picture(path) for path in pictures]
    for path in tables:
        rows = pd.read_csv(path, keep_default_na=False, na_values=[""])
        if path.stem == SCORECARD:
            rows = claims(rows, None if output.stem == SCORECARD else output.stem)
        if len(rows) or path.stem != SCORECARD:
            parts.append(table(rows, path.stem))
    document = (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{html.escape(title)}'
        f"</title>\n<style>{STYLE}</style></head>\n<body><h1>{html.escape(title)}</h1>\n"
        + "\n".join(parts)
        + "\n</body></html>\n"
    )
    with atomic_write(output) as beside:
        beside.write_text(document, encoding="utf-8")


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


def claims(rows: pd.DataFrame, figure: str | None = None) -> pd.DataFrame:
    """The scorecard for readers; of one figure only, if it is given."""
    chosen = rows if figure is None else rows[rows["figure"] == figure]
    return pd.DataFrame(
        {
            "claim": f"{row['id']}: {row['claim']}",
            "figure": _text(row["figure"]),
            "paper": _with_unit(str(row["paper"]), row["unit"]),
            "ours": ours(row),
            "EA 50 to 650 N": _range(row["lowest_by_EA"], row["highest_by_EA"]),
            "verdict": row["verdict"],
            "why": row["why"],
        }
        for row in chosen.to_dict("records")
    )


def ours(row: dict[Any, Any]) -> str:
    """Our number with what it may be off by discretisation."""
    if pd.isna(row["ours"]):
        return ""
    text = f"{row['ours']:.3g}"
    if row["discretisation"] > 0.001 * abs(row["ours"]):
        text += f" ± {row['discretisation']:.1g}"
    return _with_unit(text, row["unit"])


def _with_unit(text: str, unit: str) -> str:
    return f"{text} {unit}" if text.lstrip("-")[:1].isdigit() and unit != "1" else text


def _range(low: float, high: float) -> str:
    return "" if pd.isna(low) or low == high else f"{low:.3g} to {high:.3g}"


def _text(value: object) -> str:
    return "" if isinstance(value, float) and pd.isna(value) else str(value)


def _cell(value: object) -> str:
    if isinstance(value, int | float):
        return f'<td class="number">{"" if pd.isna(value) else f"{value:.5g}"}</td>'
    return f"<td>{html.escape(str(value))}</td>"
