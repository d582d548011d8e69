"""The site: made without a warning, complete, and whole without a network."""

import re
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest

from solver import record
from workflow.__main__ import main, names
from workflow.analyses.registry import ANALYSES
from workflow.data import states
from workflow.report.site import extension, reference
from workflow.study.schema import StudyFile

from .test_explorer import browser  # noqa: F401

ROOT = Path(__file__).parents[3]
pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    folder = tmp_path_factory.mktemp("site") / "html"
    assert main(["site", "--output", str(folder)]) == 0
    return folder


class Links(HTMLParser):
    """What a page has and what it points to."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.names: set[str] = set()
        self.targets: list[str] = []
        self.loaded: list[str] = []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        self.names |= {given[key] for key in ("id", "name") if given.get(key)}
        if tag == "a" and given.get("href"):
            self.targets.append(given["href"])
        for key in ("src", "href"):
            if tag in ("img", "script", "link") and given.get(key):
                self.loaded.append(given[key])


@pytest.fixture(scope="module")
def pages(site):
    return {path: Links(path) for path in sorted(site.rglob("*.html"))}


def test_every_document_is_a_page(site):
    for document in (ROOT / "docs").rglob("*.md"):
        name = document.relative_to(ROOT / "docs").with_suffix(".html")
        assert (site / name).is_file(), document


def test_links_lead_somewhere(site, pages):
    """Within the site, to the part of the page; others are well-formed and nothing is looked up."""
    lost = []
    for path, page in pages.items():
        for target in [*page.targets, *page.loaded]:
            parts = urlsplit(target)
            if parts.scheme in ("http", "https"):
                assert parts.netloc, target
                continue
            if parts.scheme in ("data", "mailto"):
                continue
            file = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if not file.is_file():
                lost.append((path.name, target))
            elif parts.fragment and file in pages:
                anchors = pages[file].names
                if unquote(parts.fragment) not in anchors and file.name != "search.html":
                    lost.append((path.name, target))
    assert lost == []


def test_nothing_is_loaded_from_elsewhere(pages):
    asked = {target for page in pages.values() for target in page.loaded}
    assert {target for target in asked if urlsplit(target).scheme in ("http", "https")} == set()


def text_of(site, page):
    return (site / f"{page}.html").read_text(encoding="utf-8")


def test_the_reference_is_that_of_the_code(site):
    commands = text_of(site, "reference/commands")
    for name in names():
        assert f"usage: muscle {name}" in commands
    for each in ANALYSES.values():
        assert f">{each.target or each.name}<" in commands
    files = text_of(site, "reference/files")
    for column in [*states.OF_STATE, *states.OF_CURVE, *states.OF_MUSCLE, *record.VARIABLES]:
        assert f">{column}<" in files
    keys = text_of(site, "reference/keys")
    found = StudyFile.model_json_schema()
    for entry in [found, *found["$defs"].values()]:
        for key in entry["properties"]:
            assert f">{key}<" in keys


def test_the_keys_say_what_is_allowed():
    text = reference.keys()
    assert "| `path` | `isobaric`, `isometric`, `isotonic`, `cycle`, `transient` |  |" in text
    assert "| `wall_time` | integer, > 0, <= 10000000 | `600` |" in text
    assert "| `muscles` | a list of: text | must be given |" in text


def test_the_gallery_has_every_figure(site):
    text = text_of(site, "gallery")
    for each in ANALYSES.values():
        for picture in each.figures:
            assert f'id="{picture}"' in text
    for number in range(3, 14):
        assert f'id="fig{number:02}"' in text


@pytest.mark.parametrize("formula", [r"\frac{a}{b_1}", r"\begin{pmatrix} a \cr b \end{pmatrix}"])
def test_formulas_are_drawn_by_the_browser(site, formula):
    assert extension.mathml(formula, as_block=True).startswith("<math")
    theory = text_of(site, "theory")
    assert theory.count("<math") > 300
    assert "MathJax" not in theory


@pytest.mark.parametrize(
    ("page", "scheme", "width"),
    [
        ("index", "light", 1300),
        ("theory", "dark", 390),
        ("gallery", "light", 390),
        ("reference/keys", "dark", 1300),
    ],
)
def test_pages_open_without_errors(browser, site, page, scheme, width):  # noqa: F811
    context = browser.new_context(
        viewport={"width": width, "height": 800}, color_scheme=scheme, offline=True
    )
    tab = context.new_page()
    said = []
    tab.on("console", lambda message: said.append(message.text) if message.type == "error" else 0)
    tab.on("pageerror", lambda error: said.append(str(error)))
    tab.goto((site / f"{page}.html").as_uri())
    assert said == []
    assert tab.evaluate("document.documentElement.scrollWidth") <= width
    dark = tab.evaluate("getComputedStyle(document.body).backgroundColor")
    assert (sum(map(int, re.findall(r"\d+", dark)[:3])) < 200) == (scheme == "dark")
    context.close()
