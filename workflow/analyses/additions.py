"""What an analysis adds to the results of the scenes: a group of the dataset, and its failed cases.

An analysis is asked for apart from the scenes, so it comes to results/dataset.nc and failures.csv
from two sides: gathering takes over the tables that are there, and an analysis that ends adds its
own to a dataset, and to failures, that are there. Both give the same bytes. What stands there is as
old as the last run of the analysis: after a change of the study file ask for it again.
"""

import os
import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pandas as pd
import xarray as xr

from workflow.analyses import analysis
from workflow.data import dataset
from workflow.run import failures, lock


def failed(tables: Path) -> list[Path]:
    """The tables of failed cases that are there."""
    files = [tables / analysis.failures_of(name) for name in analysis.names()]
    return [file for file in files if file.exists()]


def found(names: Iterable[str], tables: Path) -> dict[str, xr.Dataset]:
    """The groups of those analyses whose tables are there, by name."""
    files = {name: tables / f"{name}.csv" for name in names}
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


def add(name: str, results: Path) -> None:
    """Add the table of an analysis to the dataset of a study, if that is there."""
    table, to = results / "tables" / f"{name}.csv", results / dataset.FILE
    if not to.exists():
        return
    with alone(results), same_time(to):
        with xr.open_datatree(to, engine="h5netcdf") as tree:
            whole = tree.load()
        groups = {
            node.path: node.to_dataset(inherit=False).drop_encoding() for node in whole.subtree
        }
        groups[f"/{name}"] = group(pd.read_csv(table))
        dataset.write(xr.DataTree.from_dict(dict(sorted(groups.items()))), to)


def add_failures(results: Path) -> None:
    """Add the failed cases of all analyses to a table of those of the scenes, if that is there."""
    to = results / failures.TABLE
    if not to.exists():
        return
    with alone(to.parent), same_time(to):
        failures.add(to, failed(to.parent))


@contextmanager
def same_time(path: Path) -> Iterator[None]:
    """Let a file keep its time: nothing that was made of it must be made again."""
    times = path.stat()
    yield
    os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))


@contextmanager
def alone(path: Path) -> Iterator[None]:
    """Wait until no other process writes to a folder in such a block."""
    path.mkdir(parents=True, exist_ok=True)
    folder = os.open(path, os.O_RDONLY)
    try:
        lock.wait(folder)
        yield
    finally:
        os.close(folder)  # and the lock with it
