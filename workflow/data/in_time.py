"""Curves in time as groups of the dataset: /cycle/<scene> and /transient/<scene>.

Dims muscle, model, variant, the control that is held, and time [s] since the first stop. A scene of
several periods has a group for each, /cycle/<scene>_<period>s. Variables are those of a state
(solver/record.py) with work and dissipated energy, status and note of every state, and case,
case_status, case_reason, period and cycle (number of the cycle, from 1) of every curve.
"""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import xarray as xr

from solver.load_path import PathKind
from solver.models import MODELS
from solver.record import variables
from solver.status import CaseStatus, StateStatus
from workflow.data.records import Curve
from workflow.data.states import CONTROLS, OF_CURVE, OF_STATE, attributes

WORDS = {"status": StateStatus.NOT_ASKED.value, "note": ""}  # of a state, where there is none
OF_CASE = {"case": "", "case_status": CaseStatus.NOT_ASKED.value, "case_reason": ""}


def groups(curves: Iterable[Curve]) -> dict[str, xr.Dataset]:
    """Groups by name, of those curves that are in time."""
    found: dict[str, list[Curve]] = {}
    timed = [curve for curve in curves if curve.place.scene]
    periods = {(curve.place.scene, curve.place.period) for curve in timed}
    for curve in timed:
        place = curve.place
        several = sum(scene == place.scene for scene, _ in periods) > 1
        name = f"{place.scene}_{place.period:g}s" if several else place.scene
        found.setdefault(f"{place.group}/{name}", []).append(curve)
    return {name: _group(some) for name, some in found.items()}


def _group(curves: Sequence[Curve]) -> xr.Dataset:
    """Curves of equal times."""
    first, path = curves[0].place, curves[0].case.path
    assert path.history is not None
    held = PathKind(first.kind).held.key
    models = {curve.place.model for curve in curves}
    axes: dict[str, list[Any]] = {
        "muscle": sorted({curve.place.muscle for curve in curves}),
        "model": [model for model in MODELS if model in models],
        "variant": sorted({c.place.variant for c in curves}, key=lambda v: (v != "default", v)),
        held: sorted({curve.place.held for curve in curves}),
        "time": list(path.history.times),
    }
    dims, shape = tuple(axes), tuple(map(len, axes.values()))
    known = {name: said for curve in curves for name, said in variables(curve.case).items()}
    own = [name for name in known if name not in axes]
    numbers = {name: np.full(shape, np.nan) for name in own}
    words = {name: np.full(shape, empty, object) for name, empty in WORDS.items()}
    of_case = {name: np.full(shape[:-1], empty, object) for name, empty in OF_CASE.items()}
    for curve in curves:
        place, solution = curve.place, curve.solution
        labels = (place.muscle, place.model, place.variant, place.held)
        at = tuple(axis.index(v) for axis, v in zip(axes.values(), labels, strict=False))
        for name, values in numbers.items():
            values[at] = solution.states.get(name, np.nan)
        words["status"][at] = [status.value for status in solution.state_status]
        words["note"][at] = solution.notes
        said = (curve.key, solution.status.value, solution.reason)
        for values, text in zip(of_case.values(), said, strict=True):
            values[at] = text
    coordinates: dict[str, Any] = {
        dim: (dim, values, attributes(known["time"] if dim == "time" else CONTROLS[dim]))
        if dim in ("time", held)
        else (dim, values)
        for dim, values in axes.items()
    }
    data = xr.Dataset(coords=coordinates)
    cycle = np.zeros(shape[-1])
    for number, (begin, end) in enumerate(path.history.cycles(), 1):
        cycle[begin + 1 : end + 1] = number
    cycle[0] = 1
    data["cycle"] = ("time", cycle, {"units": "1", "long_name": "number of the cycle"})
    period = first.period or np.nan
    data["period"] = ((), period, {"units": "s", "long_name": "period of a cycle"})
    for name, values in numbers.items():
        data[name] = (dims, values, attributes(known[name]))
    for name, values in words.items():
        data[name] = (dims, values, attributes(OF_STATE[name]))
    for name, values in of_case.items():
        data[name] = (dims[:-1], values, attributes(OF_CURVE[name]))
    return data
