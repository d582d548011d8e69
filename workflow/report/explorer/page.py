"""Puts the content of the explorer into its template: one file that opens by itself.

The content is compressed JSON, which browsers of 2023 and later unpack by themselves. A study of a
thousand muscles takes some megabytes.
"""

import base64
import gzip
import html
import json
from pathlib import Path
from typing import Any

from geometry.files import atomic_write

HERE = Path(__file__).parent
DATA = (
    "workflow/report/explorer/template.html",
    "workflow/report/explorer/explorer.*",
    "workflow/report/explorer/vendor/*",
)


def write(output: Path, content: dict[str, Any]) -> None:
    """Write the page, whole or not at all; the same content gives the same bytes."""
    text = json.dumps(content, separators=(",", ":"), allow_nan=False)
    packed = base64.b64encode(gzip.compress(text.encode(), mtime=0)).decode()
    page = _read("template.html")
    parts = {
        "title": html.escape(str(content["title"])),
        "style": _read("vendor/uPlot.min.css") + _read("explorer.css"),
        "chart": _read("vendor/uPlot.iife.min.js"),
        "licence": _read("vendor/LICENSE"),
        "script": _read("explorer.js"),
        "content": packed,
    }
    for name, part in parts.items():
        page = page.replace(f"<!-- {name} -->", part)
    with atomic_write(output) as beside:
        beside.write_text(page, encoding="utf-8")


def _read(file: str) -> str:
    return (HERE / file).read_text(encoding="utf-8")
