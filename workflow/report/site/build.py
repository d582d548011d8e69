"""Sphinx, and before it the numbers of all pages."""

import sys
from pathlib import Path

from sphinx.cmd.build import build_main

from solver.sources import ROOT
from workflow.report.site import numbers


def build(output: Path) -> int:
    """Make the site in a folder; status 0, or 1 after what is wrong has been said."""
    wrong = numbers.of_all_pages()
    for line in wrong:
        print(line, file=sys.stderr)
    cache = str(output.with_name(f"{output.name}.doctrees"))
    words = ["-W", "--keep-going", "-q", "-d", cache, str(ROOT / "docs"), str(output)]
    return max(int(build_main(words) != 0), int(bool(wrong)))
