"""Pages of the report: self-contained, with every number, and readable."""

import base64
import re

import numpy as np
import pandas as pd
import pytest

from workflow.analyses.claims import readers
from workflow.report import html_page

SCORECARD = '''\
id,figure,claim,unit,paper,ours,discretisation,lowest_by_EA,highest_by_EA,verdict,why,model
C1,fig04,force falls,1,always,1.0,0.0,1.0,1.0,reproduced,because,solid
C3,fig06,threshold <p>,MPa,0.15,0.136472,0.0007,0.13,0.66,partly,"9 % below, ""about""",solid
C8,fig12,best wall,mm,2,1.5,0.0,1.5,1.5,not reproduced,it falls,membrane
C10,,27 minutes,min,27,,,,,not testable,no times,
'''


@pytest.fixture
def written(tmp_path):
    (tmp_path / "caption.rst").write_text("What it shows & how.\n")
    (tmp_path / "claims.csv").write_text(SCORECARD)
    (tmp_path / "other.csv").write_text("name,value [N]\na,1.23456789\nb,\n")
    (tmp_path / "picture.png").write_bytes(b"not quite a picture")

    def write(name, tables=("claims",), pictures=()):
        output = tmp_path / f"{name}.html"
        files = [tmp_path / f"{table}.csv" for table in tables]
        drawn = [tmp_path / f"{picture}.png" for picture in pictures]
        html_page.write(output, "A title", tmp_path / "caption.rst", drawn, files)
        return output.read_text()

    return write


def test_the_scorecard_has_all_claims_and_a_figure_its_own(written):
    assert re.findall(r"<td>(C\d+):", written("claims")) == ["C1", "C3", "C8", "C10"]
    assert re.findall(r"<td>(C\d+):", written("fig06")) == ["C3"]
    assert "<table>" not in written("fig07")


def test_verdicts_have_colours_and_reasons(written):
    text = written("claims")
    for look in ("reproduced", "partly", "not-reproduced", "not-testable"):
        assert f'<tr class="{look}">' in text
        assert f".{look} {{" in text
    assert "9 % below, &quot;about&quot;" in text
    assert "threshold &lt;p&gt;" in text


def test_numbers_have_units_and_errors(written):
    text = written("claims")
    assert "<td>0.15 MPa</td><td>0.136 ± 0.0007 MPa</td><td>0.13 to 0.66</td>" in text
    assert "<td>2 mm</td><td>1.5 mm</td><td></td>" in text
    assert "<td>always</td><td>1</td>" in text
    assert "<td>27 min</td><td></td>" in text
    assert "nan" not in text


def test_a_page_needs_no_other_file(written):
    text = written("fig06", pictures=["picture"])
    assert base64.b64encode(b"not quite a picture").decode() in text
    assert "What it shows &amp; how." in text
    assert not re.search(r'(src|href)="(?!data:)', text)


def test_other_tables_are_shown_whole(written):
    text = written("fig06", tables=["other"])
    assert "<th>value [N]</th>" in text
    assert '<td class="number">1.2346</td>' in text
    assert '<td class="number"></td>' in text


def test_large_numbers_are_said_without_an_exponent():
    rows = pd.DataFrame({"force": [123456.7, 2e-5], "count": [1234567, 1]})
    text = html_page.table(rows, "large")
    for shown in ("123460", "0.00002", "1234567"):
        assert f'<td class="number">{shown}</td>' in text


def test_every_number_of_ours_is_readable():
    row = {"discretisation": np.nan, "unit": "N"}
    assert readers.ours({"ours": -98.7654, **row}) == "-98.8 N"
    assert readers.ours({"ours": np.nan, **row}) == ""
    assert readers.for_readers(pd.DataFrame({"figure": []}), "fig04") is None
