"""Whether reported errors of a mesh cover the true ones, on any muscle.

Random curves by the solid or by the membrane on the default mesh, on one twice as fine, by which
errors can be measured, and on one four times as fine, by which they are judged. They have 600
states together, as a mesh does not have them all. At constant contraction the threshold pressure is
looked for as well.
"""

from dataclasses import replace

from solver.load_path import PathKind
from solver.numerics import Numerics
from workflow.analyses.analysis import AnalysisCase
from workflow.analyses.random_muscles import RandomCurve, curves
from workflow.plan.mesh_error import PART
from workflow.study.contents import Study

SEED = 11  # other muscles than those of the ladder
MODELS = {"solid": range(24), "membrane": range(24, 72)}  # of which curves: of all kinds
TRUTH = 4  # refinement
REFINEMENTS = (1, 2, TRUTH)


def cases(study: Study) -> list[AnalysisCase]:
    """Every curve on every mesh."""
    found = list(curves(max(each.stop for each in MODELS.values()), SEED))
    return [
        _case(found[number], model, refinement)
        for model, numbers in MODELS.items()
        for number in numbers
        for refinement in REFINEMENTS
    ]


def _case(curve: RandomCurve, model: str, refinement: int) -> AnalysisCase:
    path = replace(curve.path, zero_force=curve.path.kind is PathKind.ISOMETRIC)
    part = PART[model]
    mesh = replace(getattr(Numerics(), part), refinement=refinement)
    case = curve.case(model, numerics=replace(Numerics(), **{part: mesh}))
    tags: dict[str, str | float] = {"curve": float(curve.number), "refinement": float(refinement)}
    label = f"muscle {curve.number}, {model}, refinement {refinement}"
    return AnalysisCase(replace(case, path=path), label, tags)
