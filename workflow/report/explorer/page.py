"""Puts the content of the explorer into its template: one file that opens by itself.

The content is compressed JSON, which browsers of 2023 and later unpack by themselves. A study of a
thousand muscles takes some megabytes.
"""

import base64
import gzip
import html
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from geometry.files import atomic_write
from workflow.data import bench
from workflow.data.records import Curve
from workflow.data.states import Table
from workflow.plan.plan import Plan
from workflow.report.explorer.content import content

FILE = "explorer.html"  # in the folder of the results of a study
HERE = Path(__file__).parent
DATA = (
    "workflow/report/explorer/template.html",
    "workflow/report/explorer/explorer.*",
    "workflow/report/explorer/vendor/*",
)


def make(plan: Plan, title: str, curves: Sequence[Curve], table: Table, results: Path) -> None:
    """Write the page of a study into the folder of its results.

    ``table`` is that of ``curves``. Of tables beside the dataset, those of claims and deviations
    are shown if they are there.
    """
    muscles = plan.study.muscles
    maps = bench.of_muscles(muscles)
    figures = {name: scene.muscles for name, scene in plan.study.scenes.items()}
    shown = content(title, curves, table, maps, results / "tables", muscles, figures)
    write(results / FILE, shown)


def write(output: Path, shown: dict[str, Any]) -> None:
    """Write the page, whole or not at all; the same content gives the same bytes."""
    text = json.dumps(shown, separators=(",", ":"), allow_nan=False)
    packed = base64.b64encode(gzip.compress(text.encode(), mtime=0)).decode()
    page = _read("template.html")
    parts = {
        "title": html.escape(str(shown["title"])),
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
