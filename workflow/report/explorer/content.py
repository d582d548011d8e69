"""What the explorer shows, as plain lists and dictionaries: the states of the dataset, and more.

Numbers have seven digits, what is not known is None. Rows of states are those of ``/states`` in the
dataset, in its order, so that whoever has the page can find a number there again.
"""

import math
import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from solver.load_path import PathKind
from solver.models import MODELS
from solver.record import IN_TIME, SLEEVED, VARIABLES
from workflow.answers.sheet import sheet
from workflow.data import deviation
from workflow.data.paper import is_normal
from workflow.data.principal_stress import principal_of_four
from workflow.data.records import Curve
from workflow.data.reference import SAME, ForceMap
from workflow.data.states import CONTROLS, OF_MUSCLE, OF_STATE, WITH_ERROR, Table, of_muscle
from workflow.report.tables import read as read_table
from workflow.study.contents import StudiedMuscle
from workflow.study.errors import StudyError
from workflow.study.schema import QUANTITIES, SHEET

MANY = 20_000  # states above which the solver's own numbers are left to the dataset
MOST_SHEETS = 200  # curves that get a data sheet, 8 ms each
MOST_TIMES = 600  # states of a curve in time
MOST_WALLS = 150  # states whose wall is shown, some 4 kB each
OF_SOLVER = {  # variables that say how a state was found, not what it is
    *("residual", "iterations", "cutbacks", "min_det_f", "min_det_f_nodes", "margin"),
    *("force_cap", "force_midplane", "smoothing_rate", "unstable_modes"),
}
WORDS = {**OF_STATE, **VARIABLES, **SLEEVED, **IN_TIME}  # unit and long name of a quantity
CLAIM = ("id", "claim", "figure", "paper", "ours", "unit", "verdict", "why")
WALL = {  # what a wall is coloured by: unit, long name; in the order of ``_painted``
    "largest_principal_stress": ("MPa", "largest principal stress"),
    "smallest_principal_stress": ("MPa", "smallest principal stress"),
    "hoop_stress": ("MPa", "hoop stress"),
    "axial_stress": ("MPa", "stress along the axis"),
    "hoop_stretch": ("1", "hoop stretch"),
}


def content(
    study: str,
    curves: Sequence[Curve],
    table: Table,
    maps: Mapping[str, Mapping[str, ForceMap]],
    tables: Path,
    muscles: Mapping[str, StudiedMuscle] | None = None,
    figures: Mapping[str, Sequence[str]] | None = None,
) -> dict[str, Any]:
    """All that the page shows.

    ``table`` is that of ``curves``; ``maps`` are the force maps of every muscle, by name; of
    ``tables``, the folder of results/tables, those of claims and deviations are taken if they are
    there. With ``muscles`` curves have data sheets, with ``figures``, the muscles of every scene,
    claims are of those that their figure shows. Rows of curves in time stand after those of
    ``table``.
    """
    timed = [curve for curve in curves if curve.place.scene]
    curves = [curve for curve in curves if not curve.place.scene]
    left_out = OF_SOLVER if len(table.states) > MANY else set()
    states, of_timed, thinned = _with_times(table, timed)
    quantities = {
        name: states[name]
        for name in [*CONTROLS, *VARIABLES, *SLEEVED, *IN_TIME]
        if name not in left_out and name in states and np.isfinite(states[name].astype(float)).any()
    }
    errors = {name: states[f"{name}_error"] for name in WITH_ERROR if name in quantities}
    models = {*table.curves["model"], *(curve["model"] for curve in of_timed)}
    named = _muscles(table, timed, muscles)
    walls, unshown = _walls([*curves, *timed], states)
    return {
        "title": f"Pneumatic muscles: {study}",
        "quantities": {
            name: {"unit": WORDS[name][0], "label": WORDS[name][1]} for name in quantities
        },
        "leftOut": sorted(left_out),
        "thinned": thinned,
        "paths": _paths(table, timed),
        "models": {name: MODELS[name].label for name in MODELS if name in models},
        "muscles": named,
        "muscleLabels": {name: list(words) for name, words in OF_MUSCLE.items()},
        "curves": [*_curves(table), *of_timed],
        "states": {
            "columns": {name: numbers(values) for name, values in quantities.items()},
            "errors": {name: numbers(values) for name, values in errors.items()},
            **{name: states[name].tolist() for name in ("point", "status", "flags", "note")},
        },
        "measured": _measured({each["name"] for each in named}, maps, table),
        "walls": {"quantities": WALL, "states": walls, "leftOut": unshown},
        "sheets": _sheets(curves, muscles or {}),
        "claims": [
            claim | _about(str(claim.get("figure", "")), figures or {})
            for claim in _rows(tables / "claims.csv", CLAIM)
        ],
        "hasClaims": muscles is None or any(map(is_normal, muscles.values())),
        "deviations": _deviations(tables / "deviation.csv"),
    }


def _measured(
    muscles: Collection[str], maps: Mapping[str, Mapping[str, ForceMap]], table: Table
) -> list[dict[str, Any]]:
    """The force maps of some muscles: their points, and what they say between them."""
    return [
        {
            "muscle": muscle,
            "label": found.label,
            "points": [numbers(row) for row in found.points],
            "suspect": [numbers(row) for row in found.suspect],
            "between": _between(found, muscle, table),
        }
        for muscle, its in maps.items()
        if muscle in muscles
        for found in its.values()
    ]


def _between(found: ForceMap, muscle: str, table: Table) -> dict[str, list[list[float | None]]]:
    """What a map says between its points, where a curve of its muscle is held there, by path.

    Pressure, contraction and force: along a pressure that it does not have at the contractions
    that it has around it; along a contraction at the pressures at which that was not measured.
    """
    own = table.curves[table.curves["muscle"] == muscle]
    rows: dict[str, list[tuple[float, float]]] = {}
    for kind, held in sorted(set(zip(own["path"], own["held"].astype(float), strict=True))):
        if kind == PathKind.ISOBARIC and not _has(found.points[:, 0], held):
            rows.setdefault(kind, []).extend((held, float(e)) for e in found.contractions(held))
        if kind == PathKind.ISOMETRIC:
            there = found.points[np.abs(found.points[:, 1] - held) <= SAME, 0]
            lacking = [(float(p), held) for p in found.pressures if not _has(there, p)]
            rows.setdefault(kind, []).extend(lacking)
    return {
        kind: [numbers((p, e, f)) for p, e in its if math.isfinite(f := float(found.force(e, p)))]
        for kind, its in rows.items()
    }


def _has(values: NDArray[np.float64], wanted: float) -> bool:
    return bool((np.abs(values - wanted) <= SAME).any())


def _paths(table: Table, timed: Sequence[Curve]) -> dict[str, dict[str, Any]]:
    """What is held, what stands across and what up, of every path; one for each scene in time."""
    found: dict[str, dict[str, Any]] = {
        kind.value: {"held": kind.held.key, "swept": kind.swept.key, "follows": kind.follows}
        for kind in PathKind
        if kind.value in set(table.curves["path"])
    }
    for curve in timed:
        kind, cycles = PathKind(curve.place.kind), curve.place.group == "cycle"
        found[_path_of(curve)] = {
            "held": kind.held.key,
            "swept": kind.swept.key if cycles else "time",
            "follows": kind.follows,
            "inTime": True,
        }
    return found


def _path_of(curve: Curve) -> str:
    """What the path of a curve in time is called."""
    return f"{curve.place.group} {curve.place.scene}"


def _with_times(
    table: Table, timed: Sequence[Curve]
) -> tuple[pd.DataFrame, list[dict[str, Any]], int]:
    """The states, those of curves in time after the others; these curves; how many were thinned."""
    states = table.states.reset_index(drop=True)
    frames, found, thinned = [states], [], 0
    first = len(states)
    for number, curve in enumerate(timed, len(table.curves)):
        solution, place = curve.solution, curve.place
        every = len(solution.state_status)
        step = -(-every // MOST_TIMES)
        thinned += step > 1
        kept = np.arange(0, every, step)
        rows: dict[str, Any] = {
            name: np.asarray(values, float)[kept] for name, values in solution.states.items()
        }
        held, swept = curve.case.path.kind.held.key, curve.case.path.kind.swept.key
        loads = "load" in (held, swept)
        rows["load"] = rows["force"] if loads else np.full(len(kept), np.nan)
        rows |= {"curve": number, "state": kept, "point": "stop"}
        rows["status"] = [solution.state_status[k].value for k in kept]
        rows["flags"] = [" ".join(sorted(solution.flags[k])) for k in kept]
        rows["note"] = [solution.notes[k] for k in kept]
        frames.append(pd.DataFrame(rows))
        of_curve = {
            "muscle": place.muscle,
            "model": place.model,
            "variant": place.variant,
            "path": _path_of(curve),
            "held": _plain(place.held),
            "case": curve.key,
            "case_status": solution.status.value,
            "case_reason": solution.reason,
        }
        period = {"period": _plain(place.period)} if place.period else {}
        found.append(of_curve | period | {"first": first, "count": len(kept)})
        first += len(kept)
    return pd.concat(frames, ignore_index=True), found, thinned


def _muscles(
    table: Table, timed: Sequence[Curve], studied: Mapping[str, StudiedMuscle] | None
) -> list[dict[str, Any]]:
    """All muscles that have curves, with what they are."""
    rows = dict(table.muscles.iterrows())
    for name in sorted({curve.place.muscle for curve in timed} - rows.keys()):
        known = of_muscle(studied[name]) if studied else [math.nan] * len(OF_MUSCLE)
        rows[name] = pd.Series(known, list(OF_MUSCLE))
    return [
        {"name": name, **{column: _plain(row[column]) for column in OF_MUSCLE}}
        for name, row in rows.items()
    ]


def _sheets(curves: Sequence[Curve], muscles: Mapping[str, StudiedMuscle]) -> dict[str, Any]:
    """The data sheet of every isobaric curve that has states enough, its columns by curve."""
    columns: dict[int, dict[str, Any]] = {}
    notes: dict[int, dict[str, str]] = {}
    for number, curve in enumerate(curves):
        place = curve.place
        if place.group != PathKind.ISOBARIC or place.model not in QUANTITIES[SHEET]:
            continue
        if place.muscle not in muscles or len(columns) >= MOST_SHEETS:
            continue
        studied = muscles[place.muscle]
        try:
            found = sheet(studied, place.muscle, place.variant, curve.case, curve.solution)
        except StudyError:
            continue  # too few states
        columns[number] = {f"{row.name} [{row.unit}]": _plain(row.value) for row in found.rows}
        notes[number] = {f"{row.name} [{row.unit}]": row.note for row in found.rows if row.note}
    return {"columns": columns, "notes": notes, "most": MOST_SHEETS}


def numbers(values: Iterable[Any]) -> list[float | None]:
    """Seven digits of each; None for what is not finite."""
    return [float(f"{v:.7g}") if math.isfinite(v) else None for v in np.asarray(values, float)]


def _curves(table: Table) -> list[dict[str, Any]]:
    """Every curve with its rows in the states, ``first`` to ``first + count``."""
    count = table.states.groupby("curve").size()
    first = table.states.reset_index(drop=True).reset_index().groupby("curve")["index"].min()
    by = table.states.groupby("curve")["error_by"].agg(lambda known: "; ".join(known.unique()))
    names = ("muscle", "model", "variant", "path", "held", "case", "case_status", "case_reason")
    return [
        {name: _plain(row[name]) for name in names}
        | {"first": int(first.get(number, 0)), "count": int(count.get(number, 0))}
        | {"error_by": str(by.get(number, ""))}
        for number, row in table.curves.iterrows()
    ]


def _walls(curves: Sequence[Curve], states: pd.DataFrame) -> tuple[list[dict[str, Any]], int]:
    """The deformed wall in states that have fields of one section, and how many are left out.

    Of more than MOST_WALLS every second or third one of a curve is taken, and so on.
    """
    there = []
    for number, curve in enumerate(curves):
        if not curve.solution.fields:
            continue
        of_curve = states.loc[states["curve"] == number, "state"]
        found = [
            (row, curve.solution.fields.get(int(state), {})) for row, state in of_curve.items()
        ]
        there.append([(number, row, fields) for row, fields in found if _is_section(fields)])
    count = sum(map(len, there))
    every = -(-count // MOST_WALLS) or 1
    kept = [each for own in there for each in own[::every]]
    return [_wall(*each) for each in kept], count - len(kept)


def _is_section(fields: Mapping[str, NDArray[np.float64]]) -> bool:
    return "corners" in fields and fields["corners"].shape[1] == 4


def _wall(curve: int, row: Any, fields: Mapping[str, NDArray[np.float64]]) -> dict[str, Any]:
    """The wall of one state, three corners to a triangle, and a value of each triangle."""
    corners = fields["corners"]
    return {
        "curve": curve,
        "row": int(row),
        "r": _rounded(corners[:, 2], 3),
        "z": _rounded(corners[:, 3], 3),
        "values": [_rounded(v, 4) for v in _painted(corners, fields["stress"])],
    }


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
    rows = read_table(file)
    return [
        {name: _plain(row[name]) for name in columns if name in row}
        for row in rows.to_dict("records")
    ]


def _about(figure: str, scenes: Mapping[str, Sequence[str]]) -> dict[str, list[str]]:
    """The muscles that the figures of a claim show, as ``4, 5`` or ``12``; nothing if not known."""
    names = [f"fig{int(number):02d}" for number in re.findall(r"\d+", figure)]
    found = [muscle for name in names for muscle in scenes.get(name, ())]
    return {"muscles": sorted(set(found))} if found else {}


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
        if row.get("interpolation") == deviation.RULE
    ]


def _plain(value: Any) -> Any:
    """A value that JSON has."""
    if isinstance(value, float | np.floating | np.integer | int) and not isinstance(value, bool):
        return float(f"{float(value):.7g}") if math.isfinite(float(value)) else None
    return str(value)
