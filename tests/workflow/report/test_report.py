"""The report of a small study in a real browser; skipped only where there is none."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
CHROMIUM = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None
)
PARTS = ("Snakefile", "config", "geometry", "profiles", "pyproject.toml", "solver", "workflow")
pytestmark = pytest.mark.slow


def snakemake(folder, *arguments):
    command = [sys.executable, "-m", "snakemake", *arguments, "--config"]
    command.append("study=config/smoke/study.yaml")
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    """The report of the smoke study, made in a copy of the project."""
    folder = tmp_path_factory.mktemp("report")
    for part in (
        "Snakefile",
        "config",
        "geometry",
        "profiles",
        "pyproject.toml",
        "solver",
        "workflow",
    ):
        copy = shutil.copytree if (ROOT / part).is_dir() else shutil.copy
        copy(ROOT / part, folder / part)
    snakemake(folder, "--cores", "2")
    snakemake(folder, "--report", "results/report.html")  # after a usual run, which makes no pages
    return folder / "results/report.html"


def browse(page, *options):
    """What a headless browser makes of a page: its text and its errors."""
    if CHROMIUM is None:
        pytest.skip("no Chromium here: the report is not looked at in a browser")
    command = [CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--enable-logging=stderr"]
    command += ["--virtual-time-budget=10000", *options, page.as_uri()]
    return subprocess.run(command, capture_output=True, text=True, timeout=120)


def test_the_report_needs_no_network(report):
    text = report.read_text(encoding="utf-8")
    assert not re.findall(r'<(?:script|link)[^>]+(?:src|href)="https?://', text)
    for page in ("fig04", "fig08", "deviation", "failures", "explorer"):
        assert f"{page}.html" in text


def test_the_report_opens_without_errors(report):
    done = browse(report, "--dump-dom")
    errors = [line for line in done.stderr.splitlines() if "CONSOLE" in line and "rror" in line]
    assert errors == []
    shown = done.stdout.replace("&#x27;", "'")
    assert shown.index("What is open") > 0  # it opens with this, before any page is chosen
    for chapter in ("0 Explorer", "1 The paper's figures", "2 The verdict", "5 Hard cases"):
        assert chapter in shown


def test_pages_can_be_made_by_jobs_too(report):
    """A run of everything has nothing to solve after it, and its pages are the same."""
    folder = report.parents[1]
    page = folder / "results/studies/smoke/report/fig04.html"
    before = page.read_bytes()
    page.unlink()
    snakemake(folder, "--cores", "2", "results/studies/smoke/report/fig04.html")
    assert page.read_bytes() == before


@pytest.mark.parametrize("name", ["fig04", "fig08"])
def test_a_page_shows_its_whole_figure(report, name):
    """At the width of a phone the figure is as wide as the page, and nothing of it is cut off."""
    page = report.parent / "studies/smoke/report" / f"{name}.html"
    probe = page.with_name("probe.html")
    measure = (
        "<script>addEventListener('load', () => {const i = document.images[0],"
        " b = i.getBoundingClientRect(); document.title = [i.naturalWidth, i.naturalHeight,"
        " b.width, b.height, document.documentElement.scrollWidth, innerWidth].join(' ')})</script>"
    )
    probe.write_text(page.read_text().replace("</body>", f"{measure}</body>"))
    done = browse(probe, "--dump-dom", "--window-size=600,400")
    title = re.search(r"<title>([\d. ]+)</title>", done.stdout)
    assert title, done.stdout[:500]
    natural_width, natural_height, width, height, scroll, inner = map(float, title[1].split())
    assert natural_width > 0
    assert height / width == pytest.approx(natural_height / natural_width, rel=0.01)
    assert scroll <= inner
