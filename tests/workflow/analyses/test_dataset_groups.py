"""Tables of studies in the dataset: from either side, the same bytes."""

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from workflow.analyses import dataset_groups
from workflow.data import dataset

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
    """A folder with a dataset without groups of studies."""
    dataset.write(dataset.build([], {}, effects=True), tmp_path / "dataset.nc")
    return tmp_path


def write_table(results):
    table = results / "tables/robustness.csv"
    table.parent.mkdir(exist_ok=True)
    ROWS.to_csv(table, index=False)
    return table


def test_a_table_becomes_variables_with_units():
    data = dataset_groups.group(ROWS)
    assert data.largest_force.values.tolist() == [3.0, 4.5]
    assert data.largest_force.attrs == {"long_name": "largest force", "units": "N"}
    assert data.smallest_det_f.isnull().values.tolist() == [False, True]
    assert data.reason.values.tolist() == ["", "no equilibrium"]


def test_an_ended_study_is_added_to_the_dataset(results):
    path = results / "dataset.nc"
    before = path.stat().st_mtime_ns
    dataset_groups.add("robustness", write_table(results), path)
    with xr.open_datatree(path, engine="h5netcdf") as tree:
        assert tree["robustness"].cutbacks.values.tolist() == [0, 2]
        assert "effects" in tree.children
    assert path.stat().st_mtime_ns == before


def test_gathered_or_added_the_bytes_are_the_same(results):
    path = results / "dataset.nc"
    table = write_table(results)
    dataset_groups.add("robustness", table, path)
    others = dataset_groups.found(table.parent)
    dataset.write(dataset.build([], {}, effects=True, others=others), results / "gathered.nc")
    assert path.read_bytes() == (results / "gathered.nc").read_bytes()
    dataset_groups.add("robustness", table, path)
    assert path.read_bytes() == (results / "gathered.nc").read_bytes()


def test_without_a_dataset_nothing_is_made(tmp_path):
    dataset_groups.add("robustness", write_table(tmp_path), tmp_path / "dataset.nc")
    assert not (tmp_path / "dataset.nc").exists()
