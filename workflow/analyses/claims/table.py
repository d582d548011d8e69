"""The scorecard, from the solutions of all cases of the claims."""

from collections.abc import Iterator, Sequence

import numpy as np
import pandas as pd

from solver.status import StateStatus
from workflow.analyses.analysis import Solved
from workflow.analyses.claims.cases import PlacedCase
from workflow.analyses.claims.claim import Data
from workflow.analyses.claims.scorecard import MODELS, scorecard
from workflow.analyses.claims.stress import SUMMARY, summary
from workflow.analyses.threads.table import change_by_wall
from workflow.data import reference
from workflow.data.records import Curve
from workflow.data.states import Table
from workflow.study.contents import StudiedMuscle, Study
from workflow.study.schema import is_path


def tables(study: Study, solved: Sequence[Solved]) -> dict[str, pd.DataFrame]:
    """The scorecard."""
    return {"claims": table(solved)}


def table(solved: Sequence[Solved]) -> pd.DataFrame:
    """The scorecard."""
    data, own = {}, np.nan
    for stiffness in sorted({_asked(s).stiffness for s in solved}):
        here = [s for s in solved if _asked(s).stiffness == stiffness]
        own = stiffness if _asked(here[0]).own else own
        data[stiffness] = data_of(here)
    return scorecard(data, own)


def data_of(solved: Sequence[Solved]) -> Data:
    """What the cases of one EA say: their states, the stress and what single threads change."""
    muscles: dict[str, StudiedMuscle] = {}
    curves: list[Curve] = []
    cells: list[Solved] = []
    for each in solved:
        asked = _asked(each)
        if asked.place is None or asked.muscle is None:
            cells.append(each)
            continue
        muscles[asked.place.muscle] = asked.muscle
        curves.append(Curve(asked.case, each.solution, asked.case.path.stops, asked.place))
    stresses = [summed_up for curve in curves for summed_up in _stresses(curve)]
    named = {n for muscle in muscles.values() for n in muscle.reference if not is_path(n)}
    return Data(
        Table.of(curves, muscles),
        model=MODELS[0],
        maps=reference.load(sorted(named)),
        stress=pd.DataFrame(stresses) if stresses else None,
        threads=change_by_wall(cells) if cells else None,
    )


def _stresses(curve: Curve) -> Iterator[dict[str, str | float]]:
    """Summaries of the states that have a stress."""
    case, place = curve.case, curve.place
    for number, fields in curve.solution.fields.items():
        if "stress" in fields and curve.solution.state_status[number] is StateStatus.CONVERGED:
            numbers = summary(fields, case.muscle.inner_diameter, case.muscle.length)
            yield {
                "muscle": place.muscle,
                "model": place.model,
                "variant": place.variant,
                "pressure": place.held,
                "contraction": case.path.stops[number],
                **dict(zip(SUMMARY, numbers, strict=True)),
            }


def _asked(solved: Solved) -> PlacedCase:
    """The case, which is one of the claims."""
    assert isinstance(solved.asked, PlacedCase)
    return solved.asked
