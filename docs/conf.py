"""How Sphinx makes the site of these pages: ``muscle site``, or ``sphinx-build -W docs FOLDER``."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from solver import sources

project = "Pneumatic muscle"
author = "The pneumatic-muscle developers"
copyright = f"{author}; MIT licence"
version = release = sources.version()

extensions = ["myst_parser", "workflow.report.site.extension"]
source_suffix = {".md": "markdown"}
exclude_patterns = ["figures", "numbers", "static"]
nitpicky = True  # a reference to nothing is an error, with -W
suppress_warnings = ["myst.header"]  # of included pages, whose headings are right where they stand

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3
html_math_renderer = "mathml"

html_theme = "furo"
html_title = f"Pneumatic muscle {version}"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = False
