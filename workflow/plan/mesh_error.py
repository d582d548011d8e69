"""How far the mesh of a curve is from one that is infinitely fine: measured once, looked up since.

``mesh_error.csv`` beside this module holds, for every mesh of the scenes, the largest errors
that the analysis of accuracy has found on any of their curves, as shares of the largest value of
the curve:

    snakemake --cores 2 accuracy && python -m workflow bounds

writes it anew; a test says when it has to be. A finer mesh of a family has the error of the coarser
one as its bound. For another muscle it is an estimate; with that muscle in a scene, the study gives
the error of its own curves.
"""

import csv
from dataclasses import dataclass
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

FILE = Path(__file__).with_suffix(".csv")
DATA = ("workflow/plan/mesh_error.csv",)
SETTINGS = ("model", "end", "cap_step", "growth", "body_step", "rows")
COLUMNS = (*SETTINGS, "refinement", "force_error", "diameter_error", "curves", "worst")
PART = {  # of the numerics, that is the mesh, of models whose mesh is a grading
    name: model.mesh
    for name, model in MODELS.items()
    if model.mesh and issubclass(KINDS[model.mesh], Grading)
}
ERRORS = {"force": "force_error", "inner_diameter_inflated": "diameter_error"}


@dataclass(frozen=True)
class Bound:
    """Largest errors found on a mesh, as shares."""

    refinement: int
    errors: dict[str, float]


def error(case: Case, solution: Solution, variable: str) -> NDArray[np.float64]:
    """Discretisation error of a variable at every state of a curve, in its unit.

    Known for force and inner diameter, and for the contraction under a load. 0 for models without a
    mesh; NaN where nothing is known of the mesh or the variable.
    """
    values = solution.states[variable]
    if MODELS[case.model].mesh is None:
        return np.where(np.isfinite(values), 0.0, np.nan)
    if variable == "contraction" == case.path.kind.follows:
        per_contraction = np.abs(solution.states["stiffness"]) * case.muscle.length
        return np.asarray(error(case, solution, "force") / per_contraction)
    share = _share(case, variable)
    known = values[np.isfinite(values)]
    largest = float(np.max(np.abs(known))) if known.size else np.nan
    return np.where(np.isfinite(values), share * largest, np.nan)


def _share(case: Case, variable: str) -> float:
    """From the mesh of the case or the next coarser one of its family."""
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
    for bound in _bounds().get(settings, ()):
        if bound.refinement <= refinement:
            finest = bound
    return finest.errors[variable] if finest else np.nan


def settings_of(model: str, effects: Effects, numerics: Numerics) -> tuple[tuple[str, ...], int]:
    """What names a family of meshes in the table, as it stands there; and the refinement."""
    mesh = getattr(numerics, PART[model])
    end = str(effects.end) if "end" in MODELS[model].switches else ""
    steps = (f"{value:g}" for value in (mesh.cap_step, mesh.growth, mesh.body_step))
    rows = " ".join(map(str, getattr(mesh, "rows", ())))
    return (model, end, *steps, rows), mesh.refinement


@cache
def _bounds() -> dict[tuple[str, ...], list[Bound]]:
    """Bounds by settings, finer meshes last."""
    found: dict[tuple[str, ...], list[Bound]] = {}
    with FILE.open(newline="", encoding="utf-8") as stream:
        for row in csv.DictReader(line for line in stream if not line.startswith("#")):
            errors = {variable: float(row[column]) for variable, column in ERRORS.items()}
            bound = Bound(int(row["refinement"]), errors)
            found.setdefault(tuple(row[name] for name in SETTINGS), []).append(bound)
    return {key: sorted(each, key=lambda b: b.refinement) for key, each in found.items()}
