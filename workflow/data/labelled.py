"""States at their labels: groups whose dimensions are muscle, model, variant and two controls.

/isobaric    dims muscle, model, variant, pressure, contraction
/isometric   dims muscle, model, variant, contraction, pressure
/isotonic    dims muscle, model, variant, load, pressure
    the numbers of a state that are no dimension, NaN where there is none; force_error: what its
    mesh does to the force (workflow/plan/mesh_error.py), and so for other quantities;
    status: of the state (solver/status.py), not_asked where nobody asked for one; flags and note
    beside it (words with spaces between; a sentence), mostly empty;
    case, case_status, case_reason: of the curve (without the last dimension); tolerance that a
    scene wants of it, total_error of model and mesh, and how that is known;
    threshold_pressure (isometric), free_contraction (isobaric), each with its _status, _flags
    and _note: of the state of zero force, for curves that ask for it.
    Along muscle: what the muscle is made of. Coordinates are the decimals of the study file.
"""

from collections.abc import Iterable
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from solver.load_path import PathKind
from solver.models import MODELS
from solver.status import CaseStatus, StateStatus
from workflow.data.states import CONTROLS, OF_CURVE, OF_MUSCLE, OF_STATE, STOP, Table, attributes

EMPTY = {  # where no state is
    "status": StateStatus.NOT_ASKED.value,
    "flags": "",
    "note": "",
    "error_by": "",
}
NO_CURVE: dict[str, str | float] = {
    "case": "",
    "case_status": CaseStatus.NOT_ASKED.value,
    "case_reason": "",
    "tolerance": np.nan,
    "total_error": np.nan,
    "total_error_by": "",
}
NO_VARIABLES = {"state", "point", "load", *EMPTY}  # of the columns of a state


class Group:
    """The curves of one kind of path, with their axes; its size is known before it is made."""

    def __init__(self, table: Table, kind: str) -> None:
        self.kind = PathKind(kind)
        self.held, self.swept = self.kind.held.key, self.kind.swept.key
        self.muscles = table.muscles
        self.curves = table.curves[table.curves["path"] == kind]
        states = table.states[table.states["curve"].isin(self.curves.index)]
        at_stops = states["point"] == STOP
        self.states, self.zeros = states[at_stops], states[~at_stops]

    @cached_property
    def axes(self) -> dict[str, list[Any]]:
        """The labels along each dimension."""
        models, variants = set(self.curves["model"]), set(self.curves["variant"])
        return {
            "muscle": sorted(set(self.curves["muscle"])),
            "model": [model for model in MODELS if model in models],
            "variant": sorted(variants, key=lambda variant: (variant != "default", variant)),
            self.held: sorted(set(self.curves["held"])),
            self.swept: sorted(set(self.states[self.swept])),
        }

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of labels along each dimension."""
        return tuple(map(len, self.axes.values()))

    @property
    def filled(self) -> float:
        """Share of the places at which there is a state."""
        return len(self.states) / max(1, int(np.prod(self.shape)))

    @property
    def bytes(self) -> int:
        """Of all places, before compression."""
        longest = sum(int(self.states[word].str.len().max()) for word in EMPTY)
        return int(np.prod(self.shape)) * (8 * len(self._variables()) + longest)

    def _variables(self) -> list[str]:
        """Numbers of a state that are no dimension."""
        known = [name for name in OF_STATE if name in self.states]
        return [name for name in known if name not in NO_VARIABLES and name not in self.axes]

    def dataset(self) -> xr.Dataset:
        """Every state at its place."""
        dims, curves = tuple(self.axes), self._places()
        of_curve = dict(zip(self.curves.index, zip(*curves, strict=True), strict=True))
        data = xr.Dataset(coords=self._coordinates())

        def at(states: pd.DataFrame) -> tuple[NDArray[np.intp], ...]:
            places = [of_curve[curve] for curve in states["curve"]]
            return tuple(np.array(places, int).reshape(-1, len(dims) - 1).T)

        along = np.searchsorted(self.axes[self.swept], self.states[self.swept])
        stops = (*at(self.states), along)
        for name in self._variables():
            values = _spread(self.shape, stops, self.states[name], np.nan)
            data[name] = (dims, values, attributes(OF_STATE[name]))
        for name, empty in EMPTY.items():
            texts = _spread(self.shape, stops, self.states[name], empty)
            data[name] = (dims, texts, attributes(OF_STATE[name]))
        for name, none in NO_CURVE.items():
            values = _spread(self.shape[:-1], curves, self.curves[name], none)
            data[name] = (dims[:-1], values, attributes(OF_CURVE[name]))
        if len(self.zeros):
            variable, column = self.kind.zero_force, self.swept
            long_name = f"{column} of zero force"
            values = _spread(self.shape[:-1], at(self.zeros), self.zeros[column], np.nan)
            data[variable] = (dims[:-1], values, attributes((CONTROLS[column][0], long_name)))
            for name, empty in EMPTY.items():
                texts = _spread(self.shape[:-1], at(self.zeros), self.zeros[name], empty)
                said = {"long_name": f"{name} of the state of zero force"}
                data[f"{variable}_{name}"] = (dims[:-1], texts, said)
        return data

    def _places(self) -> tuple[NDArray[np.intp], ...]:
        """Where the curves stand along every dimension but their own."""
        named = self.curves.rename(columns={"held": self.held})
        places = []
        for dim in list(self.axes)[:-1]:
            number = {label: k for k, label in enumerate(self.axes[dim])}
            places.append(np.array([number[label] for label in named[dim]], np.intp))
        return tuple(places)

    def _coordinates(self) -> dict[str, Any]:
        """Labels of the dimensions, and what the muscles are made of."""
        found: dict[str, Any] = {
            dim: (dim, values, attributes(CONTROLS[dim]) if dim in CONTROLS else {})
            for dim, values in self.axes.items()
        }
        described = self.muscles.loc[self.axes["muscle"]]
        for name, column in OF_MUSCLE.items():
            found[name] = ("muscle", described[name].to_list(), attributes(column))
        return found


def _spread(
    shape: tuple[int, ...], at: tuple[NDArray[np.intp], ...], values: pd.Series, empty: Any
) -> NDArray[Any]:
    """An array with the values at their places; a text is there once, whatever the cells."""
    found = np.full(shape, empty, object if isinstance(empty, str) else float)
    found[at] = values.to_numpy(found.dtype)
    return found


def groups(table: Table) -> Iterable[Group]:
    """The groups that have curves."""
    return [Group(table, kind) for kind in PathKind if (table.curves["path"] == kind).any()]


def tree(table: Table) -> xr.DataTree:
    """All states of a table at their labels, however many places stay empty."""
    return xr.DataTree.from_dict({group.kind.value: group.dataset() for group in groups(table)})
