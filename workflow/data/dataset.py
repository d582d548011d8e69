"""All states of a study in one file: ``results/dataset.nc``.

Layout, version 3
-----------------
/states      dim row: every state; the columns of OF_STATE (workflow/data/states.py), and curve: the
             row of its curve in /curves
/curves      dim curve: the columns of OF_CURVE
/muscles     dim muscle: the columns of OF_MUSCLE
/isobaric, /isometric, /isotonic   the same states at their labels (workflow/data/labelled.py); only
             where at least 5 % of the places are filled or all of them take less than 50 MB: with
             the square of the number of muscles that have stops of their own they would be more.
             ``workflow.data.open`` makes these groups of any muscle
/cycle, /transient   curves in time, a group for each scene (workflow/data/in_time.py)
/dynamic_stiffness   dim row: answers to small vibrations (workflow/data/vibration.py)
/effects     dims regime, path, effect: what leaving out an effect changes and costs, as measured by
             the analysis of effects (workflow/plan/effect_costs.py); only in results/dataset.nc
/reference   dim point: the force maps that are of muscles of the study
/robustness, /threads   dim row: the tables of these studies, where they were asked for

A state that is invalid_state keeps its numbers: look at status before you believe one.
Units and long names are attributes. Groups without a curve are absent. The same records give the
same bytes.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from geometry.files import atomic_write
from solver import sources
from workflow.data import bench, in_time, labelled, vibration
from workflow.data.records import Curve
from workflow.data.reference import ForceMap
from workflow.data.states import CONTROLS, OF_CURVE, OF_MUSCLE, OF_STATE, Table, attributes
from workflow.plan.effect_costs import group as measured_effects
from workflow.study.contents import StudiedMuscle

FILE = "dataset.nc"  # in the folder of a study
LAYOUT = 3
FILLED, LARGE = 0.05, 50e6  # share, bytes: what labelled groups must have, or not exceed
INDEX = ("1", "row of the curve in /curves")
MUSCLES = {"muscle": OF_CURVE["muscle"], **OF_MUSCLE}


def build(
    curves: Sequence[Curve],
    muscles: Mapping[str, StudiedMuscle],
    *,
    study: str = "",
    effects: bool = False,
    others: Mapping[str, xr.Dataset] | None = None,
    table: Table | None = None,
) -> xr.DataTree:
    """The tree of some curves and of ``others``, further groups by name.

    ``table`` is that of the curves, where it is there. With ``effects`` also what is known of
    leaving effects out; ``study`` is its name.
    """
    table = Table.of(curves, muscles) if table is None else table
    groups = {**(others or {})}
    if maps := bench.of_muscles(muscles):
        by_name = {name: found for own in maps.values() for name, found in own.items()}
        groups["reference"] = _reference(dict(sorted(by_name.items())))
    if effects:
        groups["effects"] = measured_effects()
    groups |= in_time.groups(curves) | vibration.group(curves)
    if len(table.curves):
        groups |= {
            "muscles": _rows(table.muscles.rename_axis("muscle").reset_index(), "muscle", MUSCLES),
            "curves": _rows(table.curves, "curve", OF_CURVE),
            "states": _rows(table.states, "row", {"curve": INDEX, **OF_STATE}),
        }
    for group in labelled.groups(table):
        if group.filled >= FILLED or group.bytes < LARGE:
            groups[group.kind.value] = group.dataset()
    tree = xr.DataTree.from_dict(dict(sorted(groups.items())))
    tree.attrs.update(
        title="States of pneumatic muscles" + (f" of the study {study}" if study else ""),
        study=study,
        Conventions="CF-1.11",
        source=f"pneumatic-muscle {sources.version()}",
        code=" ".join(sorted(set(table.curves["code"]) - {""})),
        filetype="muscle-dataset",
        layout=LAYOUT,
    )
    return tree


def _rows(table: pd.DataFrame, dim: str, columns: Mapping[str, tuple[str, str]]) -> xr.Dataset:
    """A table as variables along one dimension."""
    there = [name for name in columns if name in table]
    variables = {name: (dim, _array(table[name]), attributes(columns[name])) for name in there}
    return xr.Dataset(variables)


def _array(values: pd.Series) -> np.ndarray[Any, Any]:
    numeric = pd.api.types.is_numeric_dtype(values)
    return np.asarray(values, None if numeric else object)


def table_of(tree: xr.DataTree) -> Table:
    """The table of states that a dataset was made of."""
    names = ("muscles", "curves", "states")
    muscles, curves, states = (tree[name].to_dataset().to_dataframe() for name in names)
    return Table(muscles, curves.reset_index(drop=True), states.reset_index(drop=True))


def write(tree: xr.DataTree, path: Path) -> None:
    """Write a tree as netCDF-4, whole or not at all; HDF5 checks the sums of its numbers.

    All but labels is compressed, texts as characters.
    """
    encoding = {
        group.path: {
            name: _encoding(variable)
            for name, variable in group.dataset.variables.items()
            if variable.size and (variable.dtype.kind in "fi" or name not in variable.dims)
        }
        for group in tree.subtree
    }
    content = tree.to_netcdf(None, engine="h5netcdf", encoding=encoding)
    with atomic_write(path) as beside:
        beside.write_bytes(content)  # HDF5 itself crashes where the disk is full


def _encoding(variable: xr.Variable) -> dict[str, Any]:
    if not variable.dims:
        return {}
    packed = {"zlib": True, "complevel": 4, "shuffle": True, "fletcher32": True}
    return packed if variable.dtype.kind in "fi" else packed | {"dtype": "S1"}


def _reference(found: Mapping[str, ForceMap]) -> xr.Dataset:
    """Force maps as points."""
    maps = found.values()
    points = np.concatenate([np.concatenate([m.points, m.suspect]) for m in maps])
    sources = [m.name for m in maps for _ in range(len(m.points) + len(m.suspect))]
    suspect = [s for m in maps for s in [0] * len(m.points) + [1] * len(m.suspect)]
    pressure, contraction, force = points.T
    return xr.Dataset(
        {
            "force": ("point", force, {"units": "N", "long_name": "force"}),
            "suspect": ("point", np.array(suspect, "i1"), {"long_name": "1: point not used"}),
        },
        {
            "source": ("point", sources, {"long_name": "map; see config/reference/SOURCES.md"}),
            "pressure": ("point", pressure, attributes(CONTROLS["pressure"])),
            "contraction": ("point", contraction, attributes(CONTROLS["contraction"])),
        },
    )
