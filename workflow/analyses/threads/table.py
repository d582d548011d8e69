"""The table of discrete threads: a row per state, and what single threads change."""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from solver.effects import Layers
from workflow.analyses.analysis import Solved
from workflow.analyses.threads import local
from workflow.analyses.threads.cases import CONTRACTION
from workflow.study.contents import Study

COLUMNS = {  # of a state -> of the table
    "contraction": "contraction [1]",
    "force": "force [N]",
    "inner_diameter_inflated": "inner diameter [mm]",
    "bulge": "bulge [mm]",
    "twist": "twist rate [rad/mm]",
    "thread_stretch_min": "smallest thread stretch [1]",
    "thread_stretch_max": "largest thread stretch [1]",
    "min_det_f": "smallest det F [1]",
    "min_det_f_nodes": "smallest det F at corners [1]",
}
STRESS, CONCENTRATION = "largest principal stress [MPa]", "stress concentration [1]"
SAME = ["set", "rubber", "wall [mm]", "pressure [MPa]", "size", "twist", "contraction [1]"]


def tables(study: Study, solved: Sequence[Solved]) -> dict[str, pd.DataFrame]:
    """One row per state."""
    return {"threads": table(solved)}


def table(solved: Sequence[Solved]) -> pd.DataFrame:
    """One row per state.

    ``change [N]`` is the force beyond that of smeared layers, where there are both, and
    ``share [1]`` the same over the largest force of the curve of smeared layers. Pictures have the
    largest stress of their rubber, and how many times that of smeared layers it is; in the set
    ``tension`` a row is a place along a thread instead.
    """
    rows = pd.concat([_rows(one) for one in solved], ignore_index=True)
    smeared = rows[rows["layers"] == Layers.SMEARED]
    known, known_stress = (smeared.set_index(SAME)[name] for name in ("force [N]", STRESS))
    curves = [key for key in SAME if key != "contraction [1]"]
    largest = smeared.groupby(curves)["force [N]"].agg(lambda force: force.abs().max())
    against = known.reindex(pd.MultiIndex.from_frame(rows[SAME])).to_numpy()
    scale = largest.reindex(pd.MultiIndex.from_frame(rows[curves])).to_numpy()
    rows["change [N]"] = rows["force [N]"] - against
    rows["share [1]"] = rows["change [N]"] / scale
    stress = known_stress.reindex(pd.MultiIndex.from_frame(rows[SAME])).to_numpy()
    rows[CONCENTRATION] = rows[STRESS] / stress
    along = [_tension(one) for one in solved if one.solution.fields]
    return pd.concat([rows, *along], ignore_index=True)


def change_by_wall(solved: Sequence[Solved], contraction: float = CONTRACTION) -> pd.Series:
    """What single threads change of the force [N], by wall thickness [mm]; of ``of_claim``."""
    rows = table(solved)
    chosen = (rows["layers"] == Layers.DISCRETE) & np.isclose(rows["contraction [1]"], contraction)
    return rows[chosen].set_index("wall [mm]")["change [N]"].sort_index()


def _rows(one: Solved) -> pd.DataFrame:
    rows = one.states[[*COLUMNS, "status"]].rename(columns=COLUMNS)
    rows["unknowns [1]"] = one.solution.unknowns
    rows[STRESS] = np.nan
    for state, fields in one.solution.fields.items():
        rows.loc[state, STRESS] = local.largest_stress(fields)
    return _tagged(rows, one)


def _tension(one: Solved) -> pd.DataFrame:
    return _tagged(local.tension(one), one).assign(set="tension")


def _tagged(rows: pd.DataFrame, one: Solved) -> pd.DataFrame:
    for tag, value in reversed(one.asked.tags.items()):
        rows.insert(0, tag, value)
    return rows
