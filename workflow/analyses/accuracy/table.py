"""The table of the analysis of accuracy: one row per setting, all errors as shares.

Columns, where they say something of a row:

states, tolerance   of the curve and of Newton's method
force_error         discretisation: largest |F - F*| over the curve's largest force, F* extrapolated
force_order, force_gci, diameter_..., threshold_...   observed order; by the next coarser mesh
total_error         largest |F - F**|, F** of the fullest model: discretisation and modelling
modelling_error     the same with F* in place of F
<map>_relative, <map>_share   mean deviation from a reference map (workflow/data/deviation.py)

For scenes the error is that of a pair of meshes; for steps and tolerances it is against the curve
of the strictest setting on the same mesh.
"""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import pandas as pd

from solver.case import Case
from solver.load_path import PathKind
from workflow.analyses.accuracy.errors import (
    Array,
    extrapolate,
    grid_convergence_index,
    pair_error,
    share,
)
from workflow.analyses.analysis import Solved
from workflow.data import deviation, reference
from workflow.data.states import STOP
from workflow.plan.mesh_error import PART
from workflow.study.contents import Study

FULLEST = "solid"


def tables(study: Study, solved: Sequence[Solved]) -> dict[str, pd.DataFrame]:
    """One row per setting and curve."""
    return {"accuracy": rows(solved)}


def rows(solved: Iterable[Solved]) -> pd.DataFrame:
    """The whole table."""
    found = list(solved)
    curves = [_row(one) for one in found if one.asked.tags["quantity"] == "curve"]
    table = pd.DataFrame(curves)
    _add_thresholds(table, found)
    _against_limits(table)
    _against_strictest(table)
    _against_pairs(table)
    _against_smooth(table)
    _against_fullest(table)
    _against_maps(table)
    finest = table.groupby(["set", "model", "mesh"])["refinement"].transform("max")
    other_of_pair = (table["set"] == "scenes") & (table["refinement"] == finest)
    return table[~other_of_pair].drop(columns=["_states", "_case", "_maps"]).reset_index(drop=True)


def _row(one: Solved) -> dict[str, Any]:
    """What a curve says by itself; its states in a column that is dropped in the end."""
    tags, case = one.asked.tags, one.asked.case
    return {
        **{name: tags[name] for name in ("set", "model", "end", "mesh", "refinement")},
        **_mesh(case),
        "tolerance": tags["tolerance"],
        "states": case.path.states,
        "case": case.key,
        "status": one.solution.status.value,
        "iterations [1]": one.states["iterations"].sum(),
        **{
            f"force at {100 * e:g} % [N]": _along(one.states, "force").get(e, np.nan)
            for e in (0.0, 0.1, 0.2)
            if case.path.kind is PathKind.ISOBARIC
        },
        "_states": one.states,
        "_case": case,
        "_maps": tags.get("maps", ""),
    }


def _mesh(case: Case) -> dict[str, float | str]:
    """Settings of the mesh, as in the study file; the units are those of config/README.md."""
    if case.model not in PART:
        return {}
    mesh = getattr(case.numerics, PART[case.model])
    settings = {name: getattr(mesh, name) for name in ("cap_step", "growth", "body_step")}
    rows = getattr(mesh, "rows", ())
    return settings | {"rows": " ".join(map(str, rows))}


def _along(states: pd.DataFrame, name: str) -> pd.Series:
    """Values of a curve by the contraction that is prescribed."""
    at_stops = states.loc[states["point"] == STOP, ["contraction", name]]
    return at_stops.set_index("contraction")[name]


def _values(rows: pd.DataFrame, name: str) -> Array:
    """Values of shape (mesh, state)."""
    return np.stack([states[name].to_numpy() for states in rows["_states"]])


def _add_thresholds(table: pd.DataFrame, solved: list[Solved]) -> None:
    """Threshold pressure of every mesh of the normal condition [MPa]."""
    found = {
        (one.asked.tags["model"], one.asked.tags["mesh"]): one.states["pressure"].iloc[-1]
        for one in solved
        if one.asked.tags["quantity"] == "threshold"
    }
    chosen = table["set"] == "mesh"
    names = zip(table["model"], table["mesh"], strict=True)
    values = pd.Series([found.get(name, np.nan) for name in names], table.index)
    table["threshold_pressure [MPa]"] = values.where(chosen)


def _against_limits(table: pd.DataFrame) -> None:
    """Every mesh of a model against what its family of refinements converges to."""
    for (name, _), rows in table[table["set"].isin(["mesh", "butt"])].groupby(["set", "model"]):
        family = rows[rows["refinement"] > 0].sort_values("refinement")
        if len(family) < 3:
            continue
        quantities = {
            "force": ("force", _values(rows, "force")),
            "diameter": ("diameter", _values(rows, "inner_diameter_inflated")),
            "threshold": ("threshold", rows[["threshold_pressure [MPa]"]].to_numpy(dtype=float)),
        }
        if name == "butt":
            del quantities["threshold"]
        for quantity, values in quantities.values():
            _one_limit(table, rows.index, family, quantity, values)


def _one_limit(
    table: pd.DataFrame, index: pd.Index, family: pd.DataFrame, quantity: str, values: Array
) -> None:
    """Errors, order and grid-convergence index of one quantity, values (mesh, state)."""
    own = [index.get_loc(k) for k in family.index]
    refinements = family["refinement"].tolist()
    limit = extrapolate(refinements, values[own])
    errors = [share(value - limit.limit, limit.limit) for value in values]
    table.loc[index, f"{quantity}_error [1]"] = errors
    table.loc[family.index, f"{quantity}_order [1]"] = limit.order
    for k, at in enumerate(family.index[1:], 1):
        ratio = refinements[k] / refinements[k - 1]
        pair = values[own[k]], values[own[k - 1]]
        index = grid_convergence_index(*pair, ratio, limit.order)
        table.loc[at, f"{quantity}_gci [1]"] = share(index, limit.limit)


def _against_strictest(table: pd.DataFrame) -> None:
    """Step sizes and tolerances against the default mesh with the strictest tolerance."""
    for _, rows in table[table["set"].isin(["steps", "tolerance"])].groupby("model"):
        best = rows.loc[rows["tolerance"].idxmin()]
        for index, states in rows["_states"].items():
            for quantity, name in (("force", "force"), ("diameter", "inner_diameter_inflated")):
                strict = _along(best["_states"], name)
                off = _along(states, name) - strict  # at the contractions that both have
                table.loc[index, f"{quantity}_error [1]"] = share(off, strict)


def _against_pairs(table: pd.DataFrame) -> None:
    """Curves of the scenes against their own on a mesh twice as fine."""
    for _, pair in table[table["set"] == "scenes"].groupby(["model", "mesh"]):
        coarse, fine = pair.sort_values("refinement").index
        states = [table.loc[k, "_states"] for k in (coarse, fine)]
        case = table.loc[coarse, "_case"]
        force = [s["force"] for s in states]
        if case.path.kind is PathKind.ISOTONIC:
            # the force is given here: the error of the contraction times the stiffness instead
            length = case.muscle.length
            force = [-s["contraction"] * length * states[0]["stiffness"] for s in states]
            scale = np.array([case.path.held])
        else:
            scale = states[1]["force"]
        for quantity, values, largest in (
            ("force", force, scale),
            ("diameter", [s["inner_diameter_inflated"] for s in states], None),
        ):
            error = share(pair_error(*values), values[1] if largest is None else largest)
            table.loc[coarse, f"{quantity}_error [1]"] = error


def _against_smooth(table: pd.DataFrame) -> None:
    """The bare tube against its own limit; the exact solution has fewer digits than that."""
    rows = table[table["set"] == "tube"].sort_values("refinement")
    for quantity, name in (("force", "force"), ("diameter", "inner_diameter_inflated")):
        _one_limit(table, rows.index, rows, quantity, _values(rows, name))


def _against_fullest(table: pd.DataFrame) -> None:
    """Every curve of the normal condition against the limit of the fullest model."""
    mesh = table[table["set"] == "mesh"]
    limits = {}
    for model, family in mesh[mesh["refinement"] > 0].groupby("model"):
        limit = extrapolate(family["refinement"].tolist(), _values(family, "force")).limit
        limits[model] = pd.Series(limit, _along(family["_states"].iloc[0], "force").index)
    fullest = limits[FULLEST]
    for index, row in table[table["set"].isin(["mesh", "steps", "tolerance"])].iterrows():
        force = _along(row["_states"], "force")
        table.loc[index, "total_error [1]"] = share(force - fullest, fullest)
        own = limits.get(row["model"], force if row["set"] == "mesh" else None)
        if own is not None:
            table.loc[index, "modelling_error [1]"] = share(own - fullest, fullest)


def _against_maps(table: pd.DataFrame) -> None:
    """Mean deviation from the muscle's maps by workflow/data/deviation.py, at one pressure."""
    for index, row in table[table["set"] == "mesh"].iterrows():
        for name, found in reference.load(row["_maps"].split()).items():
            summary = deviation.summary(deviation.states(found, row["_states"]))
            table.loc[index, f"{name}_relative [1]"] = summary["mean_relative [1]"]
            table.loc[index, f"{name}_share [1]"] = summary["mean_of_largest_force [1]"]
            left_out = summary["left_out_outside_the_map"] + summary["left_out_small_reference"]
            table.loc[index, f"{name}_left_out [1]"] = left_out
