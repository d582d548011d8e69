"""Answers to small vibrations as a group of the dataset: /dynamic_stiffness, one row per frequency.

Columns are what the curve is (muscle, model, variant, path, held), the controls and the force of
the state, the frequency, and the stiffness by length at constant pressure: storage, what is in
phase, and loss, what is a quarter ahead; loss over storage is the loss factor.
"""

from collections.abc import Iterable

import pandas as pd
import xarray as xr

from solver.case import DYNAMIC
from solver.record import VARIABLES
from workflow.data.records import Curve
from workflow.data.states import OF_CURVE, attributes

OF_ROW = {
    **{name: OF_CURVE[name] for name in ("muscle", "model", "variant", "path", "held")},
    **{name: VARIABLES[name] for name in ("contraction", "pressure", "force")},
    "frequency": ("Hz", "frequency"),
    "storage": ("N/mm", "storage stiffness, real part of dF/dl at constant pressure"),
    "loss": ("N/mm", "loss stiffness, imaginary part of dF/dl at constant pressure"),
}

NUMBERS = [name for name, (unit, _) in OF_ROW.items() if unit or name == "held"]


def table(curves: Iterable[Curve]) -> pd.DataFrame:
    """All answers of some curves at the stops that are wanted."""
    rows = []
    for curve in curves:
        place, path, states = curve.place, curve.case.path, curve.solution.states
        named = [place.muscle, place.model, place.variant, place.group, place.held]
        for number, fields in sorted(curve.solution.fields.items()):
            if DYNAMIC not in fields or path.stops[number] not in curve.stops:
                continue
            at = [states[name][number] for name in ("contraction", "pressure", "force")]
            rows += [[*named, *at, *answer] for answer in fields[DYNAMIC]]
    return pd.DataFrame(rows, columns=list(OF_ROW))


def group(curves: Iterable[Curve]) -> dict[str, xr.Dataset]:
    """The group by its name; nothing where no curve has answers."""
    found = table(curves)
    if found.empty:
        return {}
    variables = {
        name: (
            "row",
            found[name].to_numpy(float if name in NUMBERS else object),
            attributes(column),
        )
        for name, column in OF_ROW.items()
    }
    return {DYNAMIC: xr.Dataset(variables)}
