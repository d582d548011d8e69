"""What Sphinx is told beside its own: parts of pages made of the code, formulas without scripts.

In a page::

    ```{generated} commands
    ```

stands for the Markdown that the function of that name in ``PARTS`` gives.
"""

import html
from collections.abc import Callable, Mapping
from typing import Any

from docutils import nodes
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.errors import ExtensionError
from sphinx.util.docutils import SphinxDirective

from solver.sources import ROOT
from workflow.report.site import gallery, reference

PARTS: Mapping[str, Callable[[], str]] = {**reference.PARTS, **gallery.PARTS}


def setup(app: Sphinx) -> dict[str, Any]:
    """Called by Sphinx."""
    app.add_directive("generated", Generated)
    app.connect("source-read", _turn_links)
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _turn_links(app: Sphinx, page: str, content: list[str]) -> None:
    """Links to files that are pages of the site lead there, as to the study file's keys."""
    folder = (ROOT / "docs" / page).parent
    content[0] = reference.with_links(content[0], folder, folder)


class Generated(SphinxDirective):
    """A part of a page that is made of the code."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """Its nodes."""
        name = self.arguments[0]
        if name not in PARTS:
            raise self.error(f"there is no part {name}; there are {', '.join(PARTS)}")
        return self.parse_text_to_nodes(PARTS[name](), allow_section_headings=True)


def mathml(formula: str, *, as_block: bool = False) -> str:
    """A formula as MathML, which browsers draw by themselves.

    Raises
    ------
    ExtensionError
        If it has something that cannot be written so.
    """
    plain = formula.strip().replace("\\cr ", "\\\\ ").replace("°", "^\\circ ")
    try:
        return str(tex2mathml(plain, as_block=as_block))
    except MathError as error:
        raise ExtensionError(f"{error}: {formula}") from error


def _inline(translator: Any, node: nodes.math) -> None:
    translator.body.append(mathml(node.astext()))
    raise nodes.SkipNode


def _block(translator: Any, node: nodes.math_block) -> None:
    label = html.escape(node.astext())
    formula = mathml(node.astext(), as_block=True)
    translator.body.append(f'<div class="math" title="{label}">{formula}</div>')
    raise nodes.SkipNode
