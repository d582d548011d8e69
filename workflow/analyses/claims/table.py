"""The scorecard, from the solutions of all cases of the claims."""

from collections.abc import Iterator, Sequence

import numpy as np
import pandas as pd
import xarray as xr

from solver.status import StateStatus
from workflow.analyses.analysis import Solved
from workflow.analyses.claims.cases import PlacedCase
from workflow.analyses.claims.scorecard import scorecard
from workflow.analyses.claims.stress import SUMMARY, summary
from workflow.analyses.threads.table import change_by_wall
from workflow.data import dataset
from workflow.data.records import Curve
from workflow.study.contents import Study


def tables(study: Study, solved: Sequence[Solved]) -> dict[str, pd.DataFrame]:
    """The scorecard."""
    return {"claims": table(solved)}


def table(solved: Sequence[Solved]) -> pd.DataFrame:
    """The scorecard."""
    trees, own = {}, np.nan
    for stiffness in sorted({_asked(s).stiffness for s in solved}):
        here = [s for s in solved if _asked(s).stiffness == stiffness]
        own = stiffness if _asked(here[0]).own else own
        trees[stiffness] = tree(here)
    return scorecard(trees, own)


def tree(all_solved: Sequence[Solved]) -> xr.DataTree:
    """The dataset of some cases, with the groups of the stress and of single threads."""
    muscles, curves, solved, cells = {}, [], [], []
    for each in all_solved:
        asked = _asked(each)
        if asked.place is None or asked.muscle is None:
            cells.append(each)
            continue
        solved.append(each)
        muscles[asked.place.muscle] = asked.muscle
        case, stops = asked.case, asked.case.path.stops
        curves.append(Curve(asked.place, case.key, case, each.solution, stops))
    found = dataset.build(curves, muscles)
    states = [state for s in solved for state in _stresses(s)]
    if states:
        rows = pd.DataFrame(states).set_index(
            ["muscle", "model", "variant", "pressure", "contraction"]
        )
        found["stress"] = xr.DataTree(rows.to_xarray())
    if cells:
        change = change_by_wall(cells).rename_axis("wall").to_xarray()
        found["threads"] = xr.DataTree(xr.Dataset({"change": change}))
    return found


def _stresses(solved: Solved) -> Iterator[dict[str, str | float]]:
    """Summaries of the states that have a stress."""
    asked, path = _asked(solved), solved.asked.case.path
    assert asked.place is not None
    for number, fields in solved.solution.fields.items():
        if "stress" in fields and solved.solution.state_status[number] is StateStatus.CONVERGED:
            muscle = asked.case.muscle
            numbers = summary(fields, muscle.inner_diameter, muscle.length)
            yield {
                "muscle": asked.place.muscle,
                "model": asked.place.model,
                "variant": asked.place.variant,
                "pressure": path.held,
                "contraction": path.stops[number],
                **dict(zip(SUMMARY, numbers, strict=True)),
            }


def _asked(solved: Solved) -> PlacedCase:
    """The case, which is one of the claims."""
    assert isinstance(solved.asked, PlacedCase)
    return solved.asked
