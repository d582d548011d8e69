"""The dataset for whoever reads it: the labelled groups of any muscle, and single curves."""

from collections.abc import Iterable
from pathlib import Path

import pandas as pd
import xarray as xr

from solver.load_path import PathKind
from solver.status import StateStatus
from workflow.data import dataset, labelled
from workflow.data.states import Table

DATASET = "results/dataset.nc"


def open(path: str | Path = DATASET, muscle: str | Iterable[str] | None = None) -> xr.DataTree:
    """The groups isobaric, isometric and isotonic of one muscle, of several, or of all.

    They are made of /states, so it does not matter whether they stand in the file; those of all
    muscles together may be large where each has stops of its own.

    Raises
    ------
    KeyError
        If the dataset has no such muscle.
    """
    table = _read(path)
    if muscle is None:
        return labelled.tree(table)
    named = [muscle] if isinstance(muscle, str) else list(muscle)
    for name in named:
        _check("muscle", name, table.curves["muscle"])
    return labelled.tree(table.of_muscles(named))


def curve(
    path: str | Path = DATASET,
    *,
    muscle: str,
    model: str,
    variant: str = "default",
    **held: float,
) -> xr.Dataset:
    """The states of one curve along what it sweeps, by its names and the one value it holds.

    With ``pressure=0.3`` it is isobaric, with ``contraction=0.1`` isometric, with ``load=200``
    isotonic.

    Raises
    ------
    KeyError
        If the dataset has no such curve, with what there is.
    """
    kinds = {kind.held.key: kind for kind in PathKind}
    if len(held) != 1 or not held.keys() <= kinds.keys():
        raise KeyError(f"one of {', '.join(kinds)} must be given, not {', '.join(held) or 'none'}")
    ((control, value),) = held.items()
    table = _read(path)
    wanted = {"path": kinds[control].value, "muscle": muscle, "model": model, "variant": variant}
    for name, label in (wanted | {"held": value}).items():
        _check(control if name == "held" else name, label, table.curves[name])
        table = table.part(table.curves[name] == label)
    found = (
        labelled.Group(table, kinds[control])
        .dataset()
        .squeeze(["muscle", "model", "variant", control])
    )
    return found.sel({kinds[control].swept.key: found.status != StateStatus.NOT_ASKED.value})


def _read(path: str | Path) -> Table:
    with xr.open_datatree(path, engine="h5netcdf") as tree:
        return dataset.table_of(tree)


def _check(name: str, label: str | float, known: "pd.Series[str]") -> None:
    if not (known == label).any():
        there = ", ".join(map(str, sorted(set(known))))
        raise KeyError(f"the dataset has no {name} {label!r} there; it has {there}")
