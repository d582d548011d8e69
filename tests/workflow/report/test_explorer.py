"""The explorer in a real browser: what it shows and gives away are the numbers of the dataset."""

import csv
import os
import re
import shutil

import numpy as np
import pytest

from workflow.data import bench, records
from workflow.data.states import Table
from workflow.report.explorer import content, page

from ..synthetic import planned, write_records

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The page of invented records, and the table of states that it shows."""
    folder = tmp_path_factory.mktemp("explorer")
    plan = planned(folder)
    failed = next(iter(plan.scenes["few"].values()))
    write_records(plan, folder / "cases", failed=[failed])
    curves = records.curves_of_study(plan, folder / "cases")
    muscles = plan.study.muscles
    table = Table.of(curves, muscles)
    maps = bench.of_muscles(muscles)
    shown = content.content("<one> & more.yaml", curves, table, maps, folder)
    page.write(folder / "explorer.html", shown)
    return folder / "explorer.html", table, shown


@pytest.fixture(scope="module")
def browser():
    if CHROMIUM is None:
        reason = "no chromium: ./setup.sh --browser installs it"
        needed = "browser" in os.environ.get("MUSCLE_TESTS_NEED", "")
        pytest.fail(reason) if needed else pytest.skip(reason)
    from playwright.sync_api import sync_playwright

    with sync_playwright() as driver:
        found = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield found
        found.close()


@pytest.fixture
def shown(browser, made):
    """The page, opened from its file; no error and no request but for itself."""
    context = browser.new_context(viewport={"width": 1280, "height": 900}, accept_downloads=True)
    tab = context.new_page()
    said, asked = [], []
    tab.on("console", lambda message: said.append(message.text))
    tab.on("pageerror", lambda error: said.append(str(error)))
    tab.on("request", lambda request: asked.append(request.url))
    tab.goto(made[0].as_uri())
    tab.wait_for_selector("#plots figure canvas")
    yield tab
    own = (made[0].as_uri(), "data:", "blob:")
    assert said == []
    assert [url for url in asked if not url.startswith(own)] == []
    context.close()


def downloaded(tab, button, ending, folder):
    with tab.expect_download() as waiting:
        tab.click(f"#{button}")
    file = folder / f"it.{ending}"
    waiting.value.save_as(file)
    return file


def test_downloaded_numbers_are_those_of_the_dataset(shown, made, tmp_path):
    with downloaded(shown, "csv", "csv", tmp_path).open(newline="") as file:
        rows = list(csv.DictReader(file))
    table = made[1].joined()
    expected = table[(table["path"] == "isobaric") & (table["muscle"] == "one")]
    expected = expected[expected["variant"] == "default"]
    assert len(rows) == len(expected) > 20
    for name, unit in (("force", "N"), ("contraction", "1"), ("volume", "mm^3")):
        found = [float(row[f"{name} [{unit}]"] or "nan") for row in rows]
        np.testing.assert_allclose(found, expected[name], rtol=1e-6)
    assert [row["status"] for row in rows] == list(expected["status"])
    assert [row["case"] for row in rows] == list(expected["case"])


def test_read_by_mouse_and_by_keys(shown, made):
    table = made[1].joined()
    line = table[(table["path"] == "isobaric") & (table["muscle"] == "one")]
    line = line[(line["variant"] == "default") & (line["held"] == 0.3) & (line["model"] == "solid")]
    shown.uncheck("#measured")
    shown.focus("#plots .chart")
    shown.keyboard.press("Home")
    shown.keyboard.press("ArrowRight")
    head = shown.inner_text("#plots thead th")
    x = float(head.rpartition("=")[2])
    assert x == sorted(line["contraction"])[1]
    row = shown.locator("#plots tbody tr", has_text="one, FE solid, 0.3 MPa").first
    value = float(row.locator("td").nth(1).inner_text().removeprefix("≈ "))
    expected = line[line["contraction"] == x]["force"].iloc[0]
    assert value == pytest.approx(expected, rel=1e-5)
    box = shown.locator("#plots .u-over").bounding_box()
    shown.mouse.move(box["x"] + 0.97 * box["width"], box["y"] + box["height"] / 2)
    assert shown.inner_text("#plots thead th") != head


def test_measured_points_are_beside_their_muscle_only(shown):
    shown.focus("#plots .chart")
    shown.keyboard.press("Home")
    assert "measured: Festo MuscleSIM, 0.3 MPa" in shown.inner_text("#plots table")
    shown.uncheck("#measured")
    shown.focus("#plots .chart")
    shown.keyboard.press("Home")
    assert "measured" not in shown.inner_text("#plots table")


def test_another_path_two_muscles_and_a_link_that_says_so(shown, made):
    shown.select_option("#path", "isometric")
    assert "threshold" not in shown.inner_text("#warning")
    assert "pressure" in shown.inner_text("#plots thead th")
    shown.select_option("#path", "isobaric")
    shown.check("#compare")
    shown.select_option("#beside", "bare")
    captions = shown.locator("#plots figcaption").all_inner_texts()
    assert captions == ["one", "bare"]
    shown.select_option("#y", "volume")
    link = shown.url
    shown.goto("about:blank")
    shown.goto(link)
    shown.wait_for_selector("#plots figure canvas")
    assert shown.locator("#plots figcaption").all_inner_texts() == ["one", "bare"]
    assert shown.input_value("#y") == "volume"


def test_pictures_to_take_away(shown, tmp_path):
    svg = downloaded(shown, "svg", "svg", tmp_path).read_text()
    assert svg.count("<polyline") > 4
    assert "force [N]" in svg
    assert downloaded(shown, "png", "png", tmp_path).read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


def test_what_failed_is_said(shown, made):
    bad = made[1].curves
    reason = bad[bad["case_status"] != "converged"]["case_reason"].iloc[0]
    shown.select_option("#path", "isobaric")
    for name in ("one", "bare"):
        shown.check(f"#muscles input[value={name}]")
    shown.focus("#plots .chart")
    shown.keyboard.press("End")
    assert " ".join(reason.split()) in shown.inner_text("#plots table")


def test_it_has_no_server_and_is_small(made):
    path, _, _ = made
    text = path.read_text()
    assert len(text) < 1e6
    assert not re.search(r"""(src|href)=["']?(https?:)?//""", text)
    assert "Pneumatic muscles: &lt;one&gt; &amp; more.yaml" in text
    assert "Permission is hereby granted" in text


def test_the_same_content_gives_the_same_bytes(made, tmp_path):
    page.write(tmp_path / "again.html", made[2])
    assert (tmp_path / "again.html").read_bytes() == made[0].read_bytes()


@pytest.mark.parametrize("look", ["dark", "narrow"])
def test_it_is_readable_in_the_dark_and_on_a_phone(browser, made, look):
    narrow = {"width": 390, "height": 800} if look == "narrow" else {"width": 1280, "height": 900}
    context = browser.new_context(viewport=narrow, color_scheme="dark" if look == "dark" else None)
    tab = context.new_page()
    tab.goto(made[0].as_uri())
    tab.wait_for_selector("#plots figure canvas")
    wide = tab.evaluate("document.documentElement.scrollWidth")
    assert wide <= narrow["width"]  # nothing to scroll to the side
    ground = tab.evaluate("getComputedStyle(document.body).backgroundColor")
    assert (ground == "rgb(255, 255, 255)") == (look != "dark")
    context.close()
