"""What the explorer shows, as plain lists and dictionaries: the states of the dataset, and more.

Numbers have seven digits, what is not known is None. Rows of states are those of ``/states`` in the
dataset, in its order, so that whoever has the page can find a number there again.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from solver.load_path import PathKind
from solver.models import MODELS
from solver.record import SLEEVED, VARIABLES
from workflow.data.principal_stress import principal_of_four
from workflow.data.records import Curve
from workflow.data.reference import ForceMap
from workflow.data.states import CONTROLS, OF_MUSCLE, OF_STATE, WITH_ERROR, Table

MANY = 20_000  # states above which the solver's own numbers are left to the dataset
OF_SOLVER = {  # variables that say how a state was found, not what it is
    *("residual", "iterations", "cutbacks", "min_det_f", "min_det_f_nodes", "margin"),
    *("force_cap", "force_midplane", "smoothing_rate", "unstable_modes"),
}
CLAIM = ("id", "claim", "figure", "paper", "ours", "unit", "verdict", "why")
WALL = {  # what a wall is coloured by: unit, long name; in the order of ``_painted``
    "largest_principal_stress": ("MPa", "largest principal stress"),
    "smallest_principal_stress": ("MPa", "smallest principal stress"),
    "hoop_stress": ("MPa", "hoop stress"),
    "axial_stress": ("MPa", "stress along the axis"),
    "hoop_stretch": ("1", "stretch around the tube"),
}


def content(
    study: str,
    curves: Sequence[Curve],
    table: Table,
    maps: Mapping[str, Mapping[str, ForceMap]],
    tables: Path,
) -> dict[str, Any]:
    """All that the page shows.

    ``table`` is that of ``curves``; ``maps`` are the force maps of every muscle, by name; of
    ``tables``, the folder of results/tables, those of claims and deviations are taken if they are
    there. Curves in time are in the dataset only.
    """
    curves = [curve for curve in curves if not curve.place.scene]
    left_out = OF_SOLVER if len(table.states) > MANY else set()
    quantities = {
        name: table.states[name]
        for name in [*CONTROLS, *VARIABLES, *SLEEVED]
        if name not in left_out
        and name in table.states
        and np.isfinite(table.states[name].astype(float)).any()
    }
    errors = {name: table.states[f"{name}_error"] for name in WITH_ERROR if name in quantities}
    return {
        "title": f"Pneumatic muscles: {study}",
        "quantities": {
            name: {"unit": OF_STATE[name][0], "label": OF_STATE[name][1]} for name in quantities
        },
        "leftOut": sorted(left_out),
        "paths": {
            kind.value: {
                "held": kind.held.key,
                "swept": kind.swept.key,
                "follows": kind.follows,
            }
            for kind in PathKind
            if kind.value in set(table.curves["path"])
        },
        "models": {
            name: MODELS[name].label for name in MODELS if name in set(table.curves["model"])
        },
        "muscles": [
            {"name": name, **{column: _plain(row[column]) for column in OF_MUSCLE}}
            for name, row in table.muscles.iterrows()
        ],
        "muscleLabels": {name: list(words) for name, words in OF_MUSCLE.items()},
        "curves": _curves(table),
        "states": {
            "columns": {name: numbers(values) for name, values in quantities.items()},
            "errors": {name: numbers(values) for name, values in errors.items()},
            "point": table.states["point"].tolist(),
            "status": table.states["status"].tolist(),
            "flags": table.states["flags"].tolist(),
            "note": table.states["note"].tolist(),
        },
        "measured": [
            {
                "muscle": muscle,
                "label": found.label,
                "points": [numbers(row) for row in found.points],
                "suspect": [numbers(row) for row in found.suspect],
            }
            for muscle, its in maps.items()
            if muscle in table.muscles.index
            for found in its.values()
        ],
        "walls": {"quantities": WALL, "states": _walls(curves, table)},
        "claims": _rows(tables / "claims.csv", CLAIM),
        "deviations": _deviations(tables / "deviation.csv"),
    }


def numbers(values: Iterable[Any]) -> list[float | None]:
    """Seven digits of each; None for what is not finite."""
    return [float(f"{v:.7g}") if math.isfinite(v) else None for v in np.asarray(values, float)]


def _curves(table: Table) -> list[dict[str, Any]]:
    """Every curve with its rows in the states, ``first`` to ``first + count``."""
    count = table.states.groupby("curve").size()
    first = table.states.reset_index(drop=True).reset_index().groupby("curve")["index"].min()
    names = ("muscle", "model", "variant", "path", "held", "case", "case_status", "case_reason")
    return [
        {name: _plain(row[name]) for name in names}
        | {"first": int(first.get(number, 0)), "count": int(count.get(number, 0))}
        for number, row in table.curves.iterrows()
    ]


def _walls(curves: Sequence[Curve], table: Table) -> list[dict[str, Any]]:
    """The deformed wall in every state that has fields of one section."""
    found = []
    for number, curve in enumerate(curves):
        if not curve.solution.fields:
            continue
        rows = table.states.index[table.states["curve"] == number]
        for row in rows:
            fields = curve.solution.fields.get(int(table.states.loc[row, "state"]))
            if fields and "corners" in fields and fields["corners"].shape[1] == 4:
                corners, stress = fields["corners"], fields["stress"]
                found.append(
                    {
                        "curve": number,
                        "row": int(table.states.index.get_loc(row)),
                        "r": _rounded(corners[:, 2], 3),
                        "z": _rounded(corners[:, 3], 3),
                        "values": [_rounded(v, 4) for v in _painted(corners, stress)],
                    }
                )
    return found


def _painted(corners: NDArray[np.float64], stress: NDArray[np.float64]) -> list[NDArray[Any]]:
    """A value per triangle, in the order of WALL: means of its corners."""
    largest, smallest = principal_of_four(stress)
    at_corners = [largest, smallest, stress[:, 3], stress[:, 2], corners[:, 2] / corners[:, 0]]
    return [v.reshape(-1, 3).mean(axis=1) for v in at_corners]


def _rounded(values: NDArray[np.float64], decimals: int) -> list[float]:
    return [float(v) for v in np.round(values, decimals)]


def _rows(file: Path, columns: Sequence[str]) -> list[dict[str, Any]]:
    """Some columns of a table, or nothing where it has not been made."""
    if not file.exists():
        return []
    rows = pd.read_csv(file, keep_default_na=False, na_values=[""])
    return [
        {name: _plain(row[name]) for name in columns if name in row}
        for row in rows.to_dict("records")
    ]


def _deviations(file: Path) -> list[dict[str, Any]]:
    """How far curves are from the maps of their muscle, by the rule of docs/verdict.md."""
    names = {
        "muscle": "muscle",
        "model": "model",
        "variant": "variant",
        "reference": "reference",
        "interpolation": "interpolation",
        "pressure [MPa]": "pressure",
        "mean_of_largest_force [1]": "mean",
        "largest_of_largest_force [1]": "largest",
    }
    rows = _rows(file, list(names))
    return [
        {names[column]: value for column, value in row.items()}
        for row in rows
        if row.get("interpolation") == "pchip"
    ]


def _plain(value: Any) -> Any:
    """A value that JSON has."""
    if isinstance(value, float | np.floating | np.integer | int) and not isinstance(value, bool):
        return float(f"{float(value):.7g}") if math.isfinite(float(value)) else None
    return str(value)
