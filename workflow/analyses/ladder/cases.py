"""How far is every rung from a refined solid, on muscles of all kinds.

Random curves (workflow/analyses/random_muscles.py) by every rung of the ladder and, for what its
own mesh does, by a finer membrane. What the solid converges to is extrapolated from two meshes;
every eighth curve is solved on a finer one still, by which that can be judged.
"""

from dataclasses import dataclass, replace

from geometry.mesh_settings import MeridianMesh, SectionMesh
from solver.case import Case
from solver.numerics import Numerics
from workflow.analyses.analysis import AnalysisCase
from workflow.analyses.random_muscles import RandomCurve, curves
from workflow.plan.effect_costs import MESHES
from workflow.study.contents import Study

SEED, COUNT = 15, 240  # other muscles than those by which a promise is tried
FINEST, EVERY = 3, 8  # refinement; and which curves have it of the solid


@dataclass(frozen=True)
class Setup:
    """A model on a mesh."""

    model: str
    numerics: Numerics

    def case(self, curve: RandomCurve) -> Case:
        """A curve by it."""
        return curve.case(self.model, numerics=self.numerics)


def _setup(model: str, mesh: str = "default") -> Setup:
    return Setup(model, replace(Numerics(), **MESHES[mesh]))


REFERENCE, FINE_MEMBRANE = "solid, refined", "membrane, refined"
RUNGS = {
    "cylinder": _setup("cylinder"),
    "membrane": _setup("membrane"),
    "solid, coarser": _setup("solid", "coarser"),
    "solid": _setup("solid"),
    "solid, finer": _setup("solid", "finer"),
}
SETUPS = RUNGS | {
    FINE_MEMBRANE: Setup("membrane", Numerics(meridian=MeridianMesh(refinement=FINEST))),
    REFERENCE: Setup("solid", Numerics(section=SectionMesh(refinement=FINEST))),
}


def cases(study: Study) -> list[AnalysisCase]:
    """Every curve by every setup."""
    return [
        AnalysisCase(
            setup.case(curve),
            f"muscle {curve.number}, {name}",
            {"curve": float(curve.number), "setup": name},
        )
        for curve in curves(COUNT, SEED)
        for name, setup in SETUPS.items()
        if name != REFERENCE or curve.number % EVERY == 0
    ]
