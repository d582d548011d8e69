"""Whether reported errors of a mesh cover the true ones, on any muscle.

Random curves by the solid on its default mesh, on one twice as fine, by which errors can be
measured, and on one four times as fine, by which they are judged. All have 500 states together.
"""

from geometry.mesh_settings import SectionMesh
from solver.numerics import Numerics
from workflow.analyses.analysis import AnalysisCase
from workflow.analyses.random_muscles import curves
from workflow.study.contents import Study

SEED, COUNT = 30, 60  # other muscles than those of the ladder
TRUTH = 4  # refinement
REFINEMENTS = (1, 2, TRUTH)


def cases(study: Study) -> list[AnalysisCase]:
    """Every curve on every mesh."""
    return [
        AnalysisCase(
            curve.case("solid", numerics=Numerics(section=SectionMesh(refinement=refinement))),
            f"muscle {curve.number}, refinement {refinement}",
            {"curve": float(curve.number), "refinement": float(refinement)},
        )
        for curve in curves(COUNT, SEED)
        for refinement in REFINEMENTS
    ]
