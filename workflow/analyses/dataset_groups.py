"""Tables of studies as groups of ``results/dataset.nc``: /robustness, /threads.

A study is asked for apart from the scenes, so it comes to the dataset from two sides: gathering
takes over the tables that are there, and a study that ends adds its own to a dataset that is there.
Both give the same bytes. A group is as old as the last run of its study: after a change of the
study file ask for the study again.
"""

import fcntl
import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pandas as pd
import xarray as xr

from workflow.analyses.analysis import IN_DATASET
from workflow.data import dataset

TABLES = Path("results/tables")


def found(tables: Path = TABLES) -> dict[str, xr.Dataset]:
    """The groups of all tables that are there, by name."""
    files = {name: tables / f"{name}.csv" for name in IN_DATASET}
    return {name: group(pd.read_csv(file)) for name, file in files.items() if file.exists()}


def group(table: pd.DataFrame) -> xr.Dataset:
    """A table as a dataset of dim ``row``.

    ``smallest det F`` becomes smallest_det_f, ``wall [mm]`` wall with its unit.
    """
    data = xr.Dataset()
    for column in table.columns:
        parts = re.fullmatch(r"(.*?)(?: \[(.*)\])?", column)
        assert parts is not None  # any text fits
        name, unit = parts.groups()
        values = table[column]
        if not pd.api.types.is_numeric_dtype(values):
            values = values.fillna("").astype(str)
        attrs = {"long_name": name} | ({"units": unit} if unit else {})
        data[re.sub(r"\W+", "_", name.lower())] = ("row", values.to_numpy(), attrs)
    return data


def add(name: str, table: Path, to: Path) -> None:
    """Add a study's table to a dataset, if both are there.

    The time of the dataset stays: nothing that was made of it must be made again.
    """
    if name not in IN_DATASET or not to.exists():
        return
    with alone(to):
        times = to.stat()
        with xr.open_datatree(to, engine="h5netcdf") as tree:
            whole = tree.load()
        groups = {
            node.path: node.to_dataset(inherit=False).drop_encoding() for node in whole.subtree
        }
        groups[f"/{name}"] = group(pd.read_csv(table))
        dataset.write(xr.DataTree.from_dict(dict(sorted(groups.items()))), to)
        os.utime(to, ns=(times.st_atime_ns, times.st_mtime_ns))


@contextmanager
def alone(path: Path) -> Iterator[None]:
    """Wait until no other process writes to the folder of a file in such a block."""
    path.parent.mkdir(parents=True, exist_ok=True)
    folder = os.open(path.parent, os.O_RDONLY)
    try:
        fcntl.flock(folder, fcntl.LOCK_EX)
        yield
    finally:
        os.close(folder)  # and the lock with it
