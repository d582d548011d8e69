"""The explorer in a real browser: what it shows and gives away are the numbers of the dataset."""

import copy
import csv
import os
import re
import shutil
from contextlib import contextmanager

import numpy as np
import pytest

from solver import record
from solver.freefem import Limits
from solver.record import VARIABLES, unreached, variables
from solver.solve import solve
from workflow.answers.sheet import sheet
from workflow.data import bench, in_time, records, reference
from workflow.data.states import Table
from workflow.report.explorer import content, page

from ..synthetic import MUSCLE, converged, planned, write_records

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


@contextmanager
def opened(browser, path):
    """A page, opened from its file; no error and no request but for itself."""
    context = browser.new_context(viewport={"width": 1280, "height": 900}, accept_downloads=True)
    tab = context.new_page()
    said, asked = [], []
    tab.on("console", lambda message: said.append(message.text))
    tab.on("pageerror", lambda error: said.append(str(error)))
    tab.on("request", lambda request: asked.append(request.url))
    tab.goto(path.as_uri())
    tab.wait_for_selector("#plots figure canvas")
    yield tab
    own = (path.as_uri(), "data:", "blob:")
    assert said == []
    assert [url for url in asked if not url.startswith(own)] == []
    context.close()


@pytest.fixture
def shown(browser, made):
    with opened(browser, made[0]) as tab:
        yield tab


MORE = (
    MUSCLE.replace(
        "c01: 0.083805}", "c01: 0.083805, memory: {per_decade: 0.06, from: 1e-2, to: 10}}"
    )
    + """\
scenes:
  loops:
    path: cycle
    muscles: [one]
    cycle: {held: pressure, period: [4, 40], cycles: 1, samples: 12}
    pressure: [0.3]
    contraction: [0, 0.2]
    models: [cylinder]
  drop:
    path: transient
    muscles: [one]
    load: [49]
    transient: {supply: [[0, 0.1], [0, 0.3], [1, 0.3]], duration: 0.02, step: 0.002}
    models: [cylinder]
  curve:
    path: isobaric
    muscles: [one]
    pressure: [0.3]
    contraction: {from: 0, to: 0.25, step: 0.01}
    models: [cylinder]
    quantities: [free_contraction]
  wall:
    path: isobaric
    muscles: [one]
    pressure: [0.2]
    contraction: [0, 0.1, 0.2]
    models: [solid]
    quantities: [stress]
"""
)
MEASURED = (("pressure", "MPa"), ("contraction", "1"), ("force", "N"))
CORNERS = np.array([[10, 0, 15, 0], [12, 0, 16.5, 0], [10, 5, 15, 4]], dtype=float)


@pytest.fixture(scope="module")
def more(tmp_path_factory):
    """A page with curves in time, a data sheet, and a wall that moves; with its plan and curves."""
    folder = tmp_path_factory.mktemp("more")
    plan = planned(folder, MORE)
    (folder / "cases").mkdir()
    for key, each in plan.cases.items():
        case = each.case
        if case.model == "cylinder":
            solution, _ = solve(case, None, folder / "log", Limits(wall_time=60, memory=2000))
        else:
            states = unreached(3, variables(case))
            states |= {"contraction": np.array(case.path.stops), "force": np.array([5.0, 3.0, 1.0])}
            stress = np.array([[-0.3, 0.1, 0.2, 1.0], [0, 0, 0.5, 0.8], [-0.3, 0, -0.4, -0.6]])
            fields = {
                k: {"corners": CORNERS + np.array([0, 0, k, 0]), "stress": (k + 1) ** 2 * stress}
                for k in range(3)
            }
            solution = converged(states, fields=fields)
        record.write(folder / f"cases/{key}.h5", case, solution)
    curves = records.curves_of_study(plan, folder / "cases")
    muscles = plan.study.muscles
    table = Table.of(curves, muscles)
    page.write(
        folder / "explorer.html", content.content("more", curves, table, {}, folder, muscles)
    )
    return folder / "explorer.html", plan, curves


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
    points = [row for row in rows if row["model"] == "measured"]
    rows = [row for row in rows if "measured" not in row["model"]]
    assert len(rows) == len(expected) > 20
    own = reference.musclesim()
    found = [
        [float(row[f"{name} [{unit}]"]) for name, unit in MEASURED]
        for row in points
        if row["variant"] == own.label and row["muscle"] == "one"
    ]
    held = [point for point in own.points.tolist() if point[0] in (0.2, 0.3)]
    np.testing.assert_allclose(sorted(found), sorted(held), rtol=1e-6)
    assert {row["volume [mm^3]"] for row in points} == {""}
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


def test_a_map_says_what_it_has_between_its_points(shown, made):
    """That of Martens 2017 has other pressures and contractions than the curves."""
    content_of, found = made[2], reference.martens2017()
    (own,) = (m for m in content_of["measured"] if m["label"] == found.label)
    assert {row[1] for row in own["between"]["isometric"]} == {0.1}
    isobaric = own["between"]["isobaric"]
    assert {row[0] for row in isobaric} == {0.2, 0.3}
    for pressure in (0.2, 0.3):
        forces = [row[2] for row in isobaric if row[0] == pressure]
        at = found.contractions(pressure)
        assert len(at) == len(forces) > 0
        np.testing.assert_allclose(forces, found.force(at, pressure), rtol=1e-6)
    assert f"between what was measured: {found.label}" in shown.inner_text("#plots .marks")
    (sim,) = (m for m in content_of["measured"] if m["label"] == reference.musclesim().label)
    assert "isobaric" not in sim["between"]  # it has points there
    first = min(row[1] for row in isobaric if row[0] == 0.3)
    shown.focus("#plots .chart")
    shown.keyboard.press("Home")
    while float(shown.inner_text("#plots thead th").rpartition("=")[2]) < first - 1e-7:
        shown.keyboard.press("ArrowRight")
    assert f"between what was measured: {found.label}, 0.3 MPa" in shown.inner_text("#plots table")


def test_claims_are_asked_for_where_the_muscle_is_the_papers(made, tmp_path):
    _, table, own = made
    assert own["hasClaims"]
    text = MUSCLE.replace("wall_thickness: 2", "wall_thickness: 2.1")
    plan = planned(tmp_path, text + "scenes: {}\n")
    assert not content.content("mine", [], table, {}, tmp_path, plan.study.muscles)["hasClaims"]


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


def test_curves_in_time_are_loops_and_are_read_by_their_time(browser, more, tmp_path):
    path, _, curves = more
    groups = in_time.groups(curves)
    with opened(browser, path) as tab:
        tab.select_option("#path", "cycle loops")
        assert (tab.input_value("#x"), tab.input_value("#y")) == ("contraction", "force")
        tab.focus("#plots .chart")
        for _ in range(2):
            tab.keyboard.press("ArrowRight")
        head = tab.inner_text("#plots thead th")
        time = float(head.removeprefix("time [s] = "))
        own = groups["cycle/loops_4s"].squeeze()
        assert time == pytest.approx(own["time"].values[2])
        row = tab.locator("#plots tbody tr", has_text="period 4 s").first
        value = float(row.locator("td").nth(1).inner_text())
        assert value == pytest.approx(float(own["force"][2]), rel=1e-5)
        assert "steps too long in time: in cycle 1 work differs by" in row.inner_text()
        box = tab.locator("#plots .u-over").bounding_box()
        tab.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
        assert tab.inner_text("#plots thead th") != head
        with downloaded(tab, "csv", "csv", tmp_path).open(newline="") as file:
            rows = list(csv.DictReader(file))
        for period, name in (("4", "cycle/loops_4s"), ("40", "cycle/loops_40s")):
            found = [row for row in rows if row["period [s]"] == period]
            for column, unit in (("time", "s"), ("force", "N"), ("work", "N*mm")):
                numbers = [float(row[f"{column} [{unit}]"] or "nan") for row in found]
                expected = groups[name].squeeze()[column].values
                np.testing.assert_allclose(numbers, expected, rtol=1e-6, atol=1e-9)
        tab.select_option("#path", "transient drop")
        assert tab.input_value("#x") == "time"
        assert "time [s] = 0" in tab.inner_text("#plots thead th")


def test_the_wall_moves_with_its_colours(browser, more):
    path, _, _ = more
    with opened(browser, path) as tab:
        assert "contraction 0 (1 of 3)" in tab.inner_text("#wall-state")
        picture = "document.getElementById('wall-canvas').toDataURL()"
        before = tab.evaluate(picture)
        tab.focus("#wall-at")
        tab.keyboard.press("ArrowRight")
        assert "pressure 0.2 MPa, contraction 0.1 (2 of 3)" in tab.inner_text("#wall-state")
        moved = tab.evaluate(picture)
        assert moved != before
        tab.select_option("#wall-quantity", label="hoop stretch")
        assert tab.evaluate(picture) != moved
        low, high = map(float, tab.inner_text("#wall-scale").split()[:2])
        radii = CORNERS[:, 2] + np.arange(3)[:, None]
        stretches = (radii / CORNERS[:, 0]).mean(axis=1)  # of the one triangle, in every state
        np.testing.assert_allclose([low, high], stretches[[0, 2]], rtol=5e-3)
        assert "hoop stretch" in tab.get_attribute("#wall-canvas", "aria-label")
        tab.click("#play")
        tab.wait_for_function("document.getElementById('wall-at').value === '2'")
        tab.click("#play")
        assert tab.get_attribute("#play", "aria-pressed") == "false"


def test_the_data_sheet_of_what_is_shown(browser, more):
    path, plan, curves = more
    (curve,) = (c for c in curves if c.place.group == "isobaric" and c.place.model == "cylinder")
    muscle = plan.study.muscles["one"]
    found = sheet(muscle, "one", "default", curve.case, curve.solution)
    with opened(browser, path) as tab:
        text = tab.locator("#sheet table").nth(1)
        for name in ("blocked force", "work to free contraction", "largest outer diameter"):
            row = text.locator("tr", has_text=name).first
            value = float(row.locator("td").nth(1).inner_text())
            assert value == pytest.approx(found.value(name), rel=1e-3)
        tab.uncheck("#models input[value=cylinder]")
        assert tab.locator("#sheet table").count() == 1


def test_what_a_thousand_muscles_show_is_said(browser, tmp_path):
    """More curves than can be told apart are not drawn, more muscles than are read not listed."""
    sizes = "{inner_diameter: {from: 10, to: 29.975, step: 0.025}}"
    many = (
        MUSCLE
        + f"""\
  many: {{base: one, sweep: {sizes}}}
scenes:
  all:
    path: isobaric
    muscles: [many]
    pressure: [0.3]
    contraction: {{from: 0, to: 0.2, step: 0.05}}
    models: [cylinder]
"""
    )
    plan = planned(tmp_path, many)
    curves = []  # as they are read, but from no disk
    for each in plan.cases.values():
        case, (place,) = each.case, each.places
        states = {name: np.linspace(1, 2, 5) for name in VARIABLES}
        solution = converged(states | {"contraction": np.array(case.path.stops)})
        curves.append(records.Curve(case, solution, case.path.stops, place))
    table = Table.of(curves, plan.study.muscles)
    assert len(table.muscles) == 800
    shown = content.content("many", curves, table, {}, tmp_path)
    page.write(tmp_path / "explorer.html", shown)
    with opened(browser, tmp_path / "explorer.html") as tab:
        assert "200 of 800: Find narrows the list." in tab.inner_text("#muscles")
        name = table.muscles.index[700]
        tab.fill("#find", name)
        tab.check(f"#muscles input[value='{name}']")
        assert name in tab.inner_text("#plots tbody")
        tab.fill("#find", "d1")
        listed = tab.locator("#muscles input").evaluate_all("boxes => boxes.map(b => b.value)")
        tab.click("#all")
        assert re.search("60 curves are drawn; [0-9]+ more are chosen", tab.inner_text("#warning"))
        assert tab.locator("#plots tbody tr").count() == 60
        assert tab.locator("#muscles input:checked").count() == len(listed) == 200
        sought = [found for found in table.muscles.index if "d19" in found]
        tab.fill("#find", "d19")
        assert tab.locator("#muscles input").first.input_value() == sought[0]


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


def test_errors_that_are_not_known_and_notes_are_said(browser, made, tmp_path):
    changed = copy.deepcopy(made[2])
    by = {"membrane": "not known", "solid": "no mesh"}
    for curve in (c for c in changed["curves"] if c["muscle"] == "one" and c["model"] in by):
        curve["error_by"] = by[curve["model"]]
        rows = slice(curve["first"], curve["first"] + curve["count"])
        for values in changed["states"]["errors"].values():
            values[rows] = [None] * curve["count"]
        if curve["model"] == "membrane":
            changed["states"]["note"][rows] = ["threads too wide"] * curve["count"]
    assert {c["error_by"] for c in made[2]["curves"]} > {"no mesh"}
    page.write(tmp_path / "page.html", changed)
    with opened(browser, tmp_path / "page.html") as tab:
        tab.select_option("#path", "isobaric")
        tab.focus("#plots .chart")
        tab.keyboard.press("Home")
        while "contraction = 0\t" not in (table := tab.inner_text("#plots table")):
            tab.keyboard.press("ArrowRight")
        assert "error of the mesh" in table
        assert "not known" in table
        assert "no mesh" in table
        assert "threads too wide" not in table  # which stands below it once, however many have it
        (note,) = tab.locator("#plots p.said").all_inner_texts()
        assert note.endswith("threads too wide")
        assert "FE membrane" in note
        assert "errors: measured" in tab.inner_text("#plots .marks")


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


def luminance(colour):
    """Relative luminance of a colour as #rrggbb (WCAG 2.2)."""
    parts = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    linear = [p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
    return float(np.dot([0.2126, 0.7152, 0.0722], linear))


def contrast(one, other):
    low, high = sorted(map(luminance, (one, other)))
    return (high + 0.05) / (low + 0.05)


def test_curves_and_text_stand_out_in_light_and_dark():
    """WCAG 2.2: 3 to 1 for what is drawn, 4.5 to 1 for text."""
    script, style = ((page.HERE / f"explorer.{end}").read_text() for end in ("js", "css"))
    curves = re.findall("#[0-9a-f]{6}", re.search(r"const COLOURS = \[(.*?)\]", script)[1])
    assert len(curves) > 5
    schemes = re.findall(
        r"--ground: (#\w+); --ink: (#\w+); --soft: (#\w+);.*?--panel: (#\w+)", style
    )
    assert len(schemes) == 2
    for ground, *text, panel in schemes:
        ground = "#ffffff" if ground == "#fff" else ground
        assert min(contrast(curve, ground) for curve in curves) >= 3
        assert min(contrast(each, behind) for each in text for behind in (ground, panel)) >= 4.5
