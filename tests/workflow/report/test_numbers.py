"""Numbers of the documentation have a source, and are what it says."""

from pathlib import Path

import pandas as pd
import pytest

from solver.load_path import LoadPath
from workflow.report.site import numbers
from workflow.report.site.numbers import Number, problems

ROOT = Path(__file__).parents[3]


def test_all_pages_are_right():
    assert numbers.of_all_pages() == []


@pytest.fixture
def tables(tmp_path, monkeypatch):
    (tmp_path / "some.csv").write_text(
        "model,force [N],error [1],why\nsolid,123.456,0.00139,it is 77 there\nother,9,0.5,\n"
    )
    monkeypatch.setattr(numbers, "FOLDER", tmp_path)
    numbers.table.cache_clear()
    yield
    numbers.table.cache_clear()


SOURCE = "<!-- source: some.csv model=solid -->"


@pytest.mark.parametrize(
    "text",
    [
        f"It pulls with 123.5 N. {SOURCE}",
        f"{SOURCE}\nIt pulls with 123 N, which is 0.14 % off.",
        f"{SOURCE}\n| a | b |\n|---|---|\n| it | 123.46 |\n",
        f"It is 77 N there {SOURCE}",
        "From 98.7 to 99.1 N. <!-- given: the maker -->",
        "It takes 42 s. <!-- given 42: measured -->",
        "# 99 s in a heading\n\n`99 s` and $99 s$\n\n    99 s\n\n```\n99 s\n```\n",
        "$$\n99 s\n$$",
        "# a\n<!-- given on this page: measured -->\n\nIt is 99 N.\n\nAnd 98 N.",
        "Of 0.3 MPa at 10 %.",  # the default study's
    ],
)
def test_a_number_with_a_source_is_right(tables, text):
    assert problems("page.md", text) == []


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("It pulls with 124.5 N.", "page.md:1: 124.5 N has no source"),
        ("x\n\nFrom 98.7 to 99.1 N.", "page.md:3: 98.7 N has no source"),
        ("| a | b |\n|---|---|\n| it | 98.5 |\n", "98.5 has no source"),
        (f"It pulls with 124 N. {SOURCE}", "124 N is not in the table named as its source"),
        (f"It is 123.5 N. {SOURCE}\n\nIt is 9.5 N.", "page.md:3: 9.5 N has no source"),
        ("9 N, 9.5 N <!-- source: some.csv model=no -->", "has no row model=no"),
        ("9 N <!-- source: some.csv modell=solid -->", "has no column modell"),
        ("9 N <!-- source: none.csv -->", "there is no docs/numbers/none.csv"),
        ("It takes 43 s. <!-- given 42: measured -->", "43 s has no source"),
        ("It is 97 N. <!-- given: -->", "97 N has no source"),
        ("It takes 0.3 s.", "0.3 s has no source"),  # seconds are no inputs
    ],
)
def test_a_number_without_its_source_is_named(tables, text, what):
    assert any(what in found for found in problems("page.md", text))


def test_numbers_are_compared_to_their_last_digit():
    assert Number("0.136", "MPa").is_of([0.13636])
    assert not Number("0.137", "MPa").is_of([0.13636])
    assert Number("−9.8", "%").is_of([-0.0979])
    assert not Number("-9.9", "%").is_of([-0.0979])
    assert Number("10,000", "N").is_of([1e4])


def test_copies_are_those_of_a_run(tables, tmp_path, monkeypatch):
    results = tmp_path / "results"
    (results / "tables").mkdir(parents=True)
    monkeypatch.setattr(numbers, "ROOT", tmp_path)
    assert numbers.outdated(results) == []  # nothing has been run
    made = results / "tables/some.csv"
    made.write_text((tmp_path / "some.csv").read_text())
    assert numbers.outdated(results) == []
    made.write_text(made.read_text().replace("123.456", "123.457"))
    assert len(numbers.outdated(results)) == 1


@pytest.mark.parametrize("model", ["geometric", "cylinder", "membrane", "solid"])
def test_the_tables_are_what_is_computed(model, make_case, solve_case):
    """Forces of the normal condition, which the tables of numbers have, solved anew."""
    rows = pd.read_csv(ROOT / "docs/numbers/accuracy.csv")
    rows = rows[(rows["set"] == "mesh") & (rows["model"] == model)]
    row = rows[rows["mesh"].isna() | (rows["mesh"] == "1/1")].iloc[0]
    path = LoadPath(kind="isobaric", held=0.3, stops=tuple(k / 100 for k in range(21)))
    forces = solve_case(make_case(model=model, path=path)).states["force"]
    found = [forces[k] for k in (0, 10, 20)]
    expected = [row[f"force at {k} % [N]"] for k in (0, 10, 20)]
    assert found == pytest.approx(expected, rel=1e-6)
