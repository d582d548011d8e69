"""All curves in one labelled tree: ``results/dataset.nc``.

Layout, version 2
-----------------
/isobaric    dims muscle, model, variant, pressure, contraction
/isometric   dims muscle, model, variant, contraction, pressure
/isotonic    dims muscle, model, variant, load, pressure
    the variables of solver.record.VARIABLES that are no dimension, NaN where there is no state;
    force_error: what its mesh does to the force at most (workflow/plan/mesh_error.py);
    status: of the state (solver/status.py), empty where nobody asked for one; flags and note beside
    it (words with spaces between; a sentence), mostly empty;
    case, case_status, case_reason: of the curve (without the last dimension);
    threshold_pressure (isometric), free_contraction (isobaric), each with its _status, _flags
    and _note: of the state of zero force, for curves that ask for it.
    Along muscle: what the muscle is made of. Coordinates are the decimals of the study file.
/effects     dims regime, path, effect: what leaving out an effect changes and costs, as measured by
             the analysis of effects (workflow/plan/effect_costs.py); only in results/dataset.nc
/reference   dim point: the force maps that are of muscles of the study
/robustness, /threads   dim row: the tables of these studies, where they were asked for

A state that is invalid_state keeps its numbers: look at status before you believe one.
Units and long names are attributes. Groups without a curve are absent. The same records give the
same bytes.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from geometry.files import atomic_write
from solver.models import MODELS
from solver.record import VARIABLES, Solution
from workflow.data import reference
from workflow.data.records import Curve
from workflow.data.reference import ForceMap
from workflow.plan import mesh_error
from workflow.plan.effect_costs import group as measured_effects
from workflow.study.contents import StudiedMuscle
from workflow.study.schema import HELD_KEY, SWEPT_KEY

LAYOUT = 2
NAN = math.nan
CONTROLS = {
    "contraction": {"units": "1", "long_name": "contraction, 1 - l/L"},
    "pressure": {"units": "MPa", "long_name": "pressure"},
    "load": {"units": "N", "long_name": "load"},
}
ZERO_FORCE = {
    "isometric": ("threshold_pressure", "pressure", "pressure of zero force"),
    "isobaric": ("free_contraction", "contraction", "contraction of zero force"),
}
WORDS = ("status", "flags", "note")  # of a state
FORCE_ERROR = {"units": "N", "long_name": "bound on the discretisation error of the force"}
Coordinate = tuple[str, str, Callable[[StudiedMuscle], object]]  # unit, long name, value
MUSCLE: dict[str, Coordinate] = {  # coordinates along muscle
    "inner_diameter": ("mm", "initial inner diameter", lambda m: m.muscle.inner_diameter),
    "wall_thickness": ("mm", "initial wall thickness", lambda m: m.muscle.wall_thickness),
    "length": ("mm", "initial length between the caps", lambda m: m.muscle.length),
    "braid_angle": ("degree", "braid angle at the mean layer diameter", lambda m: _angle(m)),
    "lead": ("mm", "lead of the threads", lambda m: _of_braid(m, "lead")),
    "threads": ("1", "threads per layer", lambda m: _of_braid(m, "threads")),
    "thread_stiffness": (
        "N",
        "EA of a thread",
        lambda m: m.thread.stiffness if m.thread else NAN,
    ),
    "material": ("", "rubber", lambda m: m.material),
}


def build(
    curves: Sequence[Curve],
    muscles: Mapping[str, StudiedMuscle],
    *,
    effects: bool = False,
    others: Mapping[str, xr.Dataset] | None = None,
) -> xr.DataTree:
    """The tree of some curves and of ``others``, further groups by name.

    With ``effects`` also what is known of leaving effects out.
    """
    groups = {**(others or {})}
    if named := {muscle.reference for muscle in muscles.values()} - {()}:
        groups["reference"] = _reference(reference.load(sorted(set().union(*named))))
    if effects:
        groups["effects"] = measured_effects()
    for name in HELD_KEY:
        found = [curve for curve in curves if curve.place.group == name]
        if found:
            groups[name] = _group(name, found, muscles)
    tree = xr.DataTree.from_dict(dict(sorted(groups.items())))
    tree.attrs.update(filetype="muscle-dataset", layout=LAYOUT)
    return tree


def write(tree: xr.DataTree, path: Path) -> None:
    """Write a tree as netCDF-4, whole or not at all; HDF5 checks the sums of its numbers."""
    checked = {
        group.path: {
            name: {"fletcher32": True}
            for name, variable in group.dataset.variables.items()
            if variable.dims and variable.dtype.kind in "fi"
        }
        for group in tree.subtree
    }
    content = tree.to_netcdf(None, engine="h5netcdf", encoding=checked)
    with atomic_write(path) as beside:
        beside.write_bytes(content)  # HDF5 itself crashes where the disk is full


def _group(name: str, curves: Sequence[Curve], muscles: Mapping[str, StudiedMuscle]) -> xr.Dataset:
    """One group: every curve written to its place."""
    held, swept = HELD_KEY[name], SWEPT_KEY[name]
    axes = _axes(held, swept, curves)
    place_of = {dim: {value: k for k, value in enumerate(axis)} for dim, axis in axes.items()}
    shape = tuple(map(len, axes.values()))
    states = {v: np.full(shape, np.nan) for v in VARIABLES if v not in axes}
    labels = {v: np.full(shape[:-1], "", object) for v in ("case", "case_status", "case_reason")}
    words = {name: np.full(shape, "", object) for name in WORDS}
    force_error = np.full(shape, np.nan)
    for curve in curves:
        at: tuple[Any, ...] = tuple(
            place_of[dim][value] for dim, value in _labels(curve, held).items()
        )
        along = [place_of[swept][stop] for stop in curve.stops]
        chosen = [curve.case.path.stops.index(stop) for stop in curve.stops]
        for variable, values in states.items():
            values[(*at, along)] = curve.solution.states[variable][chosen]
        force_error[(*at, along)] = mesh_error.error(curve.case, curve.solution, "force")[chosen]
        said = [_words(curve.solution, k) for k in chosen]
        for word, texts in words.items():
            texts[(*at, along)] = [of_state[word] for of_state in said]
        labels["case"][at] = curve.key
        labels["case_status"][at] = curve.solution.status.value
        labels["case_reason"][at] = curve.solution.reason
    dims = tuple(axes)
    data = xr.Dataset(coords=_coordinates(axes, muscles))
    for variable, values in states.items():
        unit, long_name = VARIABLES[variable]
        data[variable] = (dims, values, {"units": unit, "long_name": long_name})
    data["force_error"] = (dims, force_error, FORCE_ERROR)
    for word, texts in words.items():
        data[word] = (dims, texts.astype(str), {"long_name": f"{word} of the state"})
    for variable, texts in labels.items():
        long_name = variable.replace("_", " ") + (" key" if variable == "case" else "")
        data[variable] = (dims[:-1], texts.astype(str), {"long_name": long_name})
    return data.assign(_zero_force(name, curves, data))


def _axes(held: str, swept: str, curves: Sequence[Curve]) -> dict[str, list[Any]]:
    """The labels along each dimension."""
    places = [curve.place for curve in curves]
    variants = {place.variant for place in places}
    models = {place.model for place in places}
    return {
        "muscle": sorted({place.muscle for place in places}),
        "model": [model for model in MODELS if model in models],
        "variant": sorted(variants, key=lambda variant: (variant != "default", variant)),
        held: sorted({place.held for place in places}),
        swept: sorted({stop for curve in curves for stop in curve.stops}),
    }


def _labels(curve: Curve, held: str) -> dict[str, Any]:
    """Where a curve stands along every dimension but its own."""
    place = curve.place
    return {
        "muscle": place.muscle,
        "model": place.model,
        "variant": place.variant,
        held: place.held,
    }


def _coordinates(
    axes: Mapping[str, list[Any]], muscles: Mapping[str, StudiedMuscle]
) -> dict[str, Any]:
    """Labels of the dimensions, and what the muscles are made of."""
    found: dict[str, Any] = {
        dim: (dim, values, CONTROLS.get(dim, {})) for dim, values in axes.items()
    }
    for name, (unit, long_name, value) in MUSCLE.items():
        attrs = ({"units": unit} if unit else {}) | {"long_name": long_name}
        found[name] = ("muscle", [value(muscles[m]) for m in axes["muscle"]], attrs)
    return found


def _zero_force(name: str, curves: Sequence[Curve], data: xr.Dataset) -> dict[str, xr.DataArray]:
    """The state of zero force of the curves that have one; nothing if none has."""
    with_zero = [curve for curve in curves if curve.case.path.zero_force]
    if not with_zero:
        return {}
    variable, state, long_name = ZERO_FORCE[name]
    value = xr.full_like(data.case, NAN, dtype=float)
    words = {word: xr.full_like(data.case, "", dtype=object) for word in WORDS}
    value.attrs = {"units": CONTROLS[state]["units"], "long_name": long_name}
    for curve in with_zero:
        at = _labels(curve, HELD_KEY[name])
        last = len(curve.case.path.stops)
        value.loc[at] = curve.solution.states[state][last]
        for word, text in _words(curve.solution, last).items():
            words[word].loc[at] = text
    found = {variable: value}
    for word, texts in words.items():
        found[f"{variable}_{word}"] = texts.astype(str)
        found[f"{variable}_{word}"].attrs = {"long_name": f"{word} of the state of zero force"}
    return found


def _words(solution: Solution, state: int) -> dict[str, str]:
    """What is said of a state, by the names in WORDS."""
    flags = " ".join(sorted(solution.flags[state]))
    return {
        "status": solution.state_status[state].value,
        "flags": flags,
        "note": solution.notes[state],
    }


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
            "pressure": ("point", pressure, CONTROLS["pressure"]),
            "contraction": ("point", contraction, CONTROLS["contraction"]),
        },
    )


def _angle(muscle: StudiedMuscle) -> float:
    """In degrees; rounded, for what a file says is no 17-digit number."""
    braid = muscle.muscle.braid
    return round(math.degrees(braid.angle), 12) if braid else NAN


def _of_braid(muscle: StudiedMuscle, name: str) -> float:
    return float(getattr(muscle.muscle.braid, name)) if muscle.muscle.braid else NAN
