"""How far the mesh of a curve is from an infinitely fine one, at every state; how that is known.

- Measured here: by the same curve on a mesh twice as fine, where a scene asks for that
  (``errors: measured``). Of second order the coarser mesh is off by 4/3 of the difference;
  1.5 times that is reported, as muscles that are pushed far converge more slowly.
- Measured here by a coarser mesh: by what the climb of the curve has tried
  (workflow/plan/promise.py), with its factors. Two meshes may cross where both are off, so at no
  state less is said than a fifth of the most along the curve.
- Estimated from like muscles (workflow/plan/like_muscles.py), on the meshes of the ladder.
- Not known, otherwise. ``mesh_error.csv`` beside this module has what the analysis of accuracy has
  found on the curves of the paper: the largest errors on any of them, as shares of the largest
  value. It serves muscles of these sizes alone, where no muscles of the ladder are like them, and
  the choice of a mesh (workflow/plan/model_choice.py):

    snakemake --cores 2 accuracy && muscle mesh-errors

All of them are estimates.
"""

import csv
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from geometry.grading import Grading
from solver.case import Case
from solver.effects import Effects
from solver.models import MODELS
from solver.numerics import KINDS, Numerics
from solver.record import Solution
from workflow.plan.effect_costs import MESHES
from workflow.plan.judged import FOLLOWS, QUANTITIES, is_valid, scale
from workflow.plan.like_muscles import mesh_errors
from workflow.plan.promise import BY_COARSER

FILE = Path(__file__).with_suffix(".csv")
DATA = ("workflow/plan/mesh_error.csv",)
SETTINGS = ("model", "end", "cap_step", "growth", "body_step", "rows")
COLUMNS = (*SETTINGS, "refinement", "force_error", "diameter_error", "curves", "worst")
PART = {  # of the numerics, that is the mesh, of models whose mesh is a grading
    name: model.mesh
    for name, model in MODELS.items()
    if model.mesh and issubclass(KINDS[model.mesh], Grading)
}
PAPER = {  # mm: sizes of the muscles of the paper, whose curves were measured
    "inner_diameter": (20, 40),
    "wall_thickness": (1.5, 2, 2.5, 3),
    "length": (300,),
}
OF_PAIR = 4 / 3 * 1.5  # error of a mesh by the difference of one twice as fine, and for safety
LEAST_BY_COARSER = 0.2  # of the largest difference along the curve
CONTROLS = ("contraction", "pressure")
UNKNOWN = "not known"
OF_VARIABLE = {variable: quantity for quantity, variable in QUANTITIES.items()}
ERRORS = {"force": "force_error", "inner_diameter_inflated": "diameter_error"}


@dataclass(frozen=True)
class OfPaper:
    """Largest errors found on a mesh of the muscle of the paper, as shares."""

    refinement: int
    errors: dict[str, float]


def error(
    case: Case,
    solution: Solution,
    variable: str,
    finer: Solution | None = None,
    coarser: Solution | None = None,
) -> NDArray[np.float64]:
    """Discretisation error of a variable at every state of a curve, in its unit.

    Of force, contraction, pressure, inner diameter and volume; of a control that is prescribed NaN.
    0 for models without a mesh; NaN where nothing is known. ``finer`` is the same curve on a mesh
    twice as fine, ``coarser`` on the next coarser one of the ladder.
    """
    values = solution.states[variable]
    if MODELS[case.model].mesh is None:
        return np.where(np.isfinite(values), 0.0, np.nan)
    if variable in CONTROLS and variable != case.path.kind.follows:
        return _of_zero_force(case, solution, variable, finer, coarser)
    if variable == "force" != case.path.kind.follows:  # under a load: by that of the contraction
        per_contraction = np.abs(solution.states["stiffness"]) * case.muscle.length
        of_contraction = error(case, solution, "contraction", finer, coarser)
        return np.asarray(of_contraction * per_contraction)
    measured, _ = _measured(case, solution, variable, finer, coarser)
    return np.where(np.isfinite(measured), measured, _estimated(case, solution, variable)[0])


def known_by(
    case: Case,
    solution: Solution,
    finer: Solution | None = None,
    coarser: Solution | None = None,
) -> list[str]:
    """How the errors of every state of a curve are known."""
    if MODELS[case.model].mesh is None:
        return ["no mesh"] * case.path.states
    follows = case.path.kind.follows
    measured, how = _measured(case, solution, follows, finer, coarser)
    estimated, otherwise = _estimated(case, solution, follows)
    by = np.where(np.isfinite(measured), how, np.where(np.isfinite(estimated), otherwise, UNKNOWN))
    return [str(each) for each in by]


def _measured(
    case: Case,
    solution: Solution,
    variable: str,
    finer: Solution | None,
    coarser: Solution | None,
) -> tuple[NDArray[np.float64], str]:
    """Errors by another mesh, NaN where one of the two has no state; and by which."""
    mesh = rung_of(case).partition(", ")[2] or "default"
    if finer is not None:
        other, factor, least, how = finer, OF_PAIR, 0.0, "measured here"
    elif coarser is not None and mesh in BY_COARSER:
        other, factor, least = coarser, BY_COARSER[mesh], LEAST_BY_COARSER
        how = "measured here by a coarser mesh"
    else:
        return np.full(case.path.states, np.nan), UNKNOWN
    both = is_valid(solution) & is_valid(other)
    off = np.where(both, np.abs(solution.states[variable] - other.states[variable]), np.nan)
    most = np.nanmax(off[: len(case.path.stops)], initial=0.0)
    return factor * np.maximum(off, least * most), how


def _estimated(case: Case, solution: Solution, variable: str) -> tuple[NDArray[np.float64], str]:
    """Errors by like muscles, else by those of the paper, NaN where nothing is known; by which."""
    quantity = OF_VARIABLE.get(variable, FOLLOWS)
    if rung := rung_of(case):
        share, count = mesh_errors(case, solution, rung, quantity)
        if count and np.isfinite(share).any():
            by = f"estimated from {count} like muscles"
            return share * scale(case, solution, quantity), by
    of_paper = _share(case, "force" if quantity == FOLLOWS else variable)
    here = np.isfinite(solution.states[variable])
    errors = np.where(here, of_paper * scale(case, solution, quantity), np.nan)
    return errors, "estimated from the curves of the paper"


def rung_of(case: Case) -> str:
    """The rung of the ladder whose mesh a case has; empty if it has another, or other effects."""
    if case.model not in PART or case.path.by_way:
        return ""
    switches = MODELS[case.model].switches
    if any(getattr(case.effects, name) != getattr(Effects(), name) for name in switches):
        return ""
    for mesh in sorted(MESHES, key="default".__ne__):  # what others do not set is of it
        settings = MESHES[mesh]
        numerics = replace(Numerics(), **settings).of(case.muscle)
        parts = [PART[case.model], *(["clamp"] if case.clamped else [])]
        if all(getattr(numerics, part) == getattr(case.numerics, part) for part in parts):
            return case.model if mesh == "default" else f"{case.model}, {mesh}"
    return ""


def twice_as_fine(case: Case) -> Case | None:
    """The same curve on a mesh twice as fine; None for a model whose mesh is no grading."""
    if case.model not in PART:
        return None
    part = PART[case.model]
    mesh = getattr(case.numerics, part)
    finer = replace(mesh, refinement=2 * mesh.refinement)
    return replace(case, numerics=replace(case.numerics, **{part: finer}), fields_at=())


def _of_zero_force(
    case: Case,
    solution: Solution,
    variable: str,
    finer: Solution | None,
    coarser: Solution | None,
) -> NDArray[np.float64]:
    """Of the control that is swept, which is not prescribed where the force is zero."""
    found, stops = np.full(case.path.states, np.nan), len(case.path.stops)
    if variable != case.path.kind.swept.variable or not case.path.zero_force:
        return found
    measured = _measured(case, solution, variable, finer, coarser)[0][stops]
    if finer is not None and np.isfinite(measured):
        found[stops] = measured
        return found
    states = solution.states
    slope = {
        "pressure": np.abs(states["force_by_pressure"]),
        "contraction": np.abs(states["stiffness"]) * case.muscle.length,
    }[variable]
    by_force = error(case, solution, case.path.kind.follows, None, coarser) / slope
    found[stops] = np.fmax(by_force[stops], measured)
    return found


def _share(case: Case, variable: str) -> float:
    """Of muscles of the paper: by the mesh of the case or the next coarser one of its family."""
    if any(getattr(case.muscle, name) not in sizes for name, sizes in PAPER.items()):
        return np.nan
    if case.model not in PART:
        return np.nan
    return share_of(case.model, case.effects, case.numerics, variable)


def share_of(model: str, effects: Effects, numerics: Numerics, variable: str = "force") -> float:
    """Largest error found on a mesh of a model, as a share; 0 without a mesh, NaN if not known."""
    if model not in PART:
        return np.nan if MODELS[model].mesh else 0.0
    if variable not in ERRORS:
        return np.nan
    settings, refinement = settings_of(model, effects, numerics)
    finest = None
    for found in _of_paper().get(settings, ()):
        if found.refinement <= refinement:
            finest = found
    return finest.errors[variable] if finest else np.nan


def settings_of(model: str, effects: Effects, numerics: Numerics) -> tuple[tuple[str, ...], int]:
    """What names a family of meshes in the table, as it stands there; and the refinement."""
    mesh = getattr(numerics, PART[model])
    end = str(effects.end) if "end" in MODELS[model].switches else ""
    steps = (f"{value:g}" for value in (mesh.cap_step, mesh.growth, mesh.body_step))
    rows = " ".join(map(str, getattr(mesh, "rows", ())))
    return (model, end, *steps, rows), mesh.refinement


@cache
def _of_paper() -> dict[tuple[str, ...], list[OfPaper]]:
    """By settings, finer meshes last."""
    found: dict[tuple[str, ...], list[OfPaper]] = {}
    with FILE.open(newline="", encoding="utf-8") as stream:
        for row in csv.DictReader(line for line in stream if not line.startswith("#")):
            errors = {variable: float(row[column]) for variable, column in ERRORS.items()}
            of_mesh = OfPaper(int(row["refinement"]), errors)
            found.setdefault(tuple(row[name] for name in SETTINGS), []).append(of_mesh)
    return {key: sorted(each, key=lambda each: each.refinement) for key, each in found.items()}
