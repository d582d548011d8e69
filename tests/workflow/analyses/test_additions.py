"""What analyses add to the dataset and to failures: from either side, the same bytes."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from solver import solve
from solver.status import CaseStatus
from workflow.analyses import additions
from workflow.analyses.analysis import failures_of
from workflow.data import dataset
from workflow.run import failures

ROWS = pd.DataFrame(
    {
        "name": ["one", "two"],
        "reason": [None, "no equilibrium"],
        "smallest det F": [0.75, np.nan],
        "largest force [N]": [3.0, 4.5],
        "cutbacks": [0, 2],
    }
)


@pytest.fixture
def results(tmp_path):
    """A folder with a dataset without groups of analyses."""
    dataset.write(dataset.build([], {}, effects=True), tmp_path / "dataset.nc")
    return tmp_path


def write_table(results):
    table = results / "tables/robustness.csv"
    table.parent.mkdir(exist_ok=True)
    ROWS.to_csv(table, index=False)
    return table


def test_a_table_becomes_variables_with_units():
    data = additions.group(ROWS)
    assert data.largest_force.values.tolist() == [3.0, 4.5]
    assert data.largest_force.attrs == {"long_name": "largest force", "units": "N"}
    assert data.smallest_det_f.isnull().values.tolist() == [False, True]
    assert data.reason.values.tolist() == ["", "no equilibrium"]


def test_an_ended_analysis_is_added_to_the_dataset(results):
    path = results / "dataset.nc"
    before = path.stat().st_mtime_ns
    write_table(results)
    additions.add("robustness", results)
    with xr.open_datatree(path, engine="h5netcdf") as tree:
        assert tree["robustness"].cutbacks.values.tolist() == [0, 2]
        assert "effects" in tree.children
    assert path.stat().st_mtime_ns == before


def test_gathered_or_added_the_bytes_are_the_same(results):
    path = results / "dataset.nc"
    table = write_table(results)
    additions.add("robustness", results)
    others = additions.found(["robustness"], table.parent)
    dataset.write(dataset.build([], {}, effects=True, others=others), results / "gathered.nc")
    assert path.read_bytes() == (results / "gathered.nc").read_bytes()
    additions.add("robustness", results)
    assert path.read_bytes() == (results / "gathered.nc").read_bytes()


def test_without_a_dataset_nothing_is_made(tmp_path):
    write_table(tmp_path)
    additions.add("robustness", tmp_path)
    assert not (tmp_path / "dataset.nc").exists()


@pytest.fixture
def failed(make_case):
    """Solutions of two cases that failed, by key; the first one is of a scene too."""
    found = [make_case(model=model) for model in ("membrane", "solid")]
    return {case.key: solve.failure(case, CaseStatus.TIMEOUT, "too slow") for case in found}


def test_failed_cases_of_an_analysis_stand_among_the_others(results, failed):
    """Each case once, gathered or added; those of analyses alone let no run fail."""
    tables, names = results / "tables", ("effects", "robustness")
    both, alone = failed
    scenes = SimpleNamespace(cases={both: SimpleNamespace(label="a", scenes=("fig04", "curves"))})
    own = {both: failed[both]}
    path = tables / "failures.csv"
    failures.write(scenes, own, path)
    first = path.stat().st_mtime_ns
    for name in names:
        failures.write_analysis(
            name, dict.fromkeys(failed, "b"), failed, tables / failures_of(name)
        )
        additions.add_failures(results)
    added = path.read_bytes()
    additions.add_failures(results)
    assert path.read_bytes() == added
    assert path.stat().st_mtime_ns == first
    failures.write(scenes, own, path, None, additions.failed(tables))
    assert path.read_bytes() == added
    rows = failures.read(path)
    assert [(row["case"], row["scenes"], row["analyses"]) for row in rows] == [
        (both, "fig04 curves", "effects robustness"),
        (alone, "", "effects robustness"),
    ]
    text, bad = failures.report(path)
    assert bad
    assert "1 case failed" in text
    assert "analysis robustness: 2 timeout" in text
    failures.write(SimpleNamespace(cases={}), {}, path, None, additions.failed(tables))
    assert not failures.report(path)[1]


def test_a_case_that_no_longer_fails_is_gone(results, failed):
    tables = results / "tables"
    path, table = tables / "failures.csv", tables / failures_of("effects")
    failures.write(SimpleNamespace(cases={}), {}, path)
    empty = path.read_bytes()
    failures.write_analysis("effects", dict.fromkeys(failed, "b"), failed, table)
    additions.add_failures(results)
    assert len(failures.read(path)) == 2
    failures.write_analysis("effects", {}, {}, table)
    additions.add_failures(results)
    assert path.read_bytes() == empty
