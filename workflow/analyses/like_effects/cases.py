"""What leaving out an effect changes on muscles of all kinds: its cases.

The first of the random curves of the ladder, each effect within the fullest model that can be had
with and without it, as in the analysis of effects. Single threads are left out: the cell takes
minutes for a curve, and is of no braid with a gap.
"""

from solver.case import Case
from solver.effects import EFFECTS
from solver.refusal import UnsolvableCase
from workflow.analyses.analysis import AnalysisCase
from workflow.analyses.effects.cases import SETUPS, Setup
from workflow.analyses.effects.table import SWITCHES
from workflow.analyses.ladder.cases import SEED
from workflow.analyses.random_muscles import RandomCurve, curves
from workflow.study.contents import Study

COUNT = 112  # the spread of what an effect changes is known well enough by these
NOT_HERE = ("discrete_threads",)
PAIRS = {  # of the effects of the vocabulary: (setup with it, setup without)
    effect: SWITCHES[effect] for effect in EFFECTS if effect not in NOT_HERE
}


def cases(study: Study) -> list[AnalysisCase]:
    """Every curve with and without every effect."""
    setups = dict.fromkeys(name for pair in PAIRS.values() for name in pair)
    return [
        AnalysisCase(
            case,
            f"muscle {curve.number}, {name}",
            {"curve": float(curve.number), "setup": name},
        )
        for curve in curves(COUNT, SEED)
        for name in setups
        if (case := _case(curve, SETUPS[name]))
    ]


def _case(curve: RandomCurve, setup: Setup) -> Case | None:
    """A curve by a setup; None where its braid has no such effect: a sleeve cannot push."""
    try:
        return curve.case(setup.model, effects=setup.effects)
    except UnsolvableCase:
        return None
