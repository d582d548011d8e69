"""The tables of the ladder: errors of every rung on curves, and of every mesh at states."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from solver.record import Solution
from workflow.analyses.analysis import Solved
from workflow.analyses.ladder.cases import FINE_MEMBRANE, REFERENCE, RUNGS
from workflow.plan import likeness
from workflow.plan.judged import QUANTITIES, difference, is_answer, is_valid
from workflow.study.contents import Study

ORDER = 3.0  # of the solid's force where it is not observed; see ``limit``


def tables(study: Study, solved: Sequence[Solved]) -> dict[str, pd.DataFrame]:
    """Of curves, and of states."""
    by_curve: dict[float, dict[str, Solved]] = defaultdict(dict)
    for one in solved:
        by_curve[float(one.asked.tags["curve"])][str(one.asked.tags["setup"])] = one
    curves = [row for setups in by_curve.values() for row in of_curve(setups)]
    states = [row for setups in by_curve.values() for row in of_states(setups)]
    return {"ladder": pd.DataFrame(curves), "ladder_states": pd.DataFrame(states)}


def limit(setups: Mapping[str, Solved]) -> Solution:
    """What the solid converges to: its values on two meshes, one twice as fine, extrapolated.

    By the finest mesh that there is and the next coarser one of the family. States that only the
    coarser one has are as it has them: a mesh that loses them is no truth.
    """
    fine, coarse, ratio = setups["solid, finer"].solution, setups["solid"].solution, 2.0
    if REFERENCE in setups:
        fine, coarse, ratio = setups[REFERENCE].solution, fine, 1.5
    states = {
        name: np.where(
            np.isfinite(more := (values - coarse.states[name]) / (ratio**ORDER - 1)),
            values + more,
            values,
        )
        for name, values in fine.states.items()
    }
    only = is_valid(coarse) & ~is_valid(fine)
    states = {name: np.where(only, coarse.states[name], values) for name, values in states.items()}
    pairs = zip(only, coarse.state_status, fine.state_status, strict=True)
    return Solution(
        status=fine.status,
        reason=fine.reason,
        states=states,
        state_status=[of_coarse if lost else own for lost, of_coarse, own in pairs],
        flags=fine.flags,
    )


def of_curve(setups: Mapping[str, Solved]) -> list[dict[str, Any]]:
    """Of every rung the largest error on the curve, as a share of the largest value along it."""
    truth, found = limit(setups), []
    for name in RUNGS:
        case, solution = setups[name].asked.case, setups[name].solution
        errors = {
            quantity: difference(case, solution, truth, quantity)
            for quantity in (likeness.FOLLOWS, *QUANTITIES)
        }
        lost = is_valid(truth) & ~is_answer(case, solution)
        found.append(
            {
                "curve": int(setups[name].asked.tags["curve"]),
                "path": case.path.kind.value,
                "law": case.rubber.law(),
                **likeness.groups(case),
                "rung": name,
                "case": case.key,
                **errors,
                "lost": int(lost.sum()),
                "states": int(is_valid(truth).sum()),
            }
        )
    return found


def of_states(setups: Mapping[str, Solved]) -> list[dict[str, Any]]:
    """Of every mesh the error at every state, as a share of the largest value along the curve."""
    truth = {"solid": limit(setups), "membrane": setups[FINE_MEMBRANE].solution}
    found = []
    for name in ("membrane", "solid, coarser", "solid", "solid, finer"):
        case, solution = setups[name].asked.case, setups[name].solution
        exact = truth[case.model]
        common = is_valid(exact) & is_valid(solution)
        groups = likeness.of_states(case, solution)
        for state in np.flatnonzero(common):
            found.append(
                {
                    "curve": int(setups[name].asked.tags["curve"]),
                    "rung": name,
                    "state": int(state),
                    **{group: float(values[state]) for group, values in groups.items()},
                    **{
                        quantity: likeness.share(case, solution, exact, quantity)[state]
                        for quantity in (likeness.FOLLOWS, *QUANTITIES)
                    },
                }
            )
    return found
