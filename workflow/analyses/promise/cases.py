"""Whether promises are kept on any muscle, and what they cost.

Random curves, each with four tolerances, one climb after the other from an empty store. Every rung
is solved at all states too: that says how far each is off, and what would have been cheapest. A
climb knows nothing of these, only what the climbs on its curve before it have asked for.
"""

from workflow.analyses.analysis import AnalysisCase
from workflow.analyses.ladder.cases import RUNGS
from workflow.analyses.random_muscles import curves
from workflow.plan.judged import FOLLOWS
from workflow.plan.promise import Promise
from workflow.study.contents import Study

TOLERANCES = (0.05, 0.02, 0.01, 0.005)


def cases(study: Study) -> list[AnalysisCase]:
    """Of every curve its rungs and its climbs."""
    asked, found = study.promise, []
    for curve in curves(asked.muscles, asked.seed):
        rungs = {name: setup.case(curve) for name, setup in RUNGS.items()}
        tags: dict[str, str | float] = {"curve": float(curve.number)}
        for name, case in rungs.items():
            label = f"muscle {curve.number} of seed {asked.seed}, {name}"
            found.append(AnalysisCase(case, label, tags | {"setup": name}))
        before: list[str] = []
        for tolerance in TOLERANCES:
            promise = Promise(tolerance, (FOLLOWS,), rungs, tuple(before))
            label = f"muscle {curve.number} of seed {asked.seed}, within {100 * tolerance:g} %"
            own = tags | {"setup": "climb", "tolerance": tolerance}
            found.append(AnalysisCase(rungs["solid"], label, own, promise))
            before.append(promise.key)
    return found
