"""All claims in one table: number, how sure it is, verdict.

Two things make a number unsure. Discretisation: the table of states says by how much the force of
each is off at most (force_error; without it SHARE of the curve's largest force), so the claims are
judged again on copies of the table in which every curve is shifted by that, up or down as chance
has it. And the thread stiffness, which the paper does not give: they are judged again on states
with other EA by a faster model. A claim that is reproduced with one EA and not with another is
reproduced partly.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace

import numpy as np
import pandas as pd

from solver.load_path import CONTRACTION_LIMITS, PathKind
from workflow.analyses.claims.claim import GEOMETRIC, Claim, Data, Finding, Verdict
from workflow.analyses.claims.judge import CLAIMS, judge
from workflow.data.states import STOP, Table

MODELS = ("solid", "membrane")  # the fullest first
SWEPT_MODEL = "membrane"  # of the states with other EA
SHARE = 0.0025  # of the curve's largest force; also of the growth of a diameter
COPIES, SEED = 8, 20260101


def scorecard(data: Mapping[float, Data], stiffness: float) -> pd.DataFrame:
    """One row per claim.

    Parameters
    ----------
    data : by EA [N]
    stiffness : EA of the study; the verdict is its own
    """
    own = data[stiffness]
    copies = list(shifted(own))
    others = {ea: other for ea, other in data.items() if ea != stiffness}
    return pd.DataFrame([_row(claim, own, copies, others) for claim in CLAIMS])


def _row(
    claim: Claim, own: Data, copies: Iterable[Data], others: Mapping[float, Data]
) -> dict[str, str | float]:
    model, found = _by_fullest_model(claim, own)
    again = [judge(claim, replace(copy, model=model)).value for copy in copies]
    swept = {ea: _by_faster_model(claim, other) for ea, other in others.items()}
    swept = {ea: f for ea, f in swept.items() if f.verdict is not Verdict.NOT_TESTABLE}
    faster = _by_faster_model(claim, own)
    known = [found.value, *(f.value for f in swept.values())]
    judged = _weighed(found, faster, swept)
    untested = judged.verdict is Verdict.NOT_TESTABLE
    return {
        "id": claim.name,
        "figure": claim.figure,
        "claim": claim.text,
        "unit": claim.unit,
        "paper": claim.paper,
        "ours": judged.value,
        "discretisation": float(np.nanmax(np.abs(np.array(again) - found.value)))
        if np.isfinite(again).any()
        else np.nan,
        "lowest_by_EA": np.nan if untested else min(known),
        "highest_by_EA": np.nan if untested else max(known),
        "verdict": judged.verdict.value,
        "why": judged.why,
        "model": "" if untested else model,
        "EA_with_this_verdict": " ".join(
            f"{ea:g}" for ea, f in sorted(swept.items()) if f.verdict is faster.verdict
        ),
    }


def _by_fullest_model(claim: Claim, data: Data) -> tuple[str, Finding]:
    """The finding of the first model that has what the claim speaks of."""
    for model in MODELS:
        found = judge(claim, replace(data, model=model))
        if found.verdict is not Verdict.NOT_TESTABLE:
            break
    return model, found


def _by_faster_model(claim: Claim, data: Data) -> Finding:
    """The finding of the model that there is with every EA."""
    found = judge(claim, replace(data, model=SWEPT_MODEL))
    return found if found.verdict is not Verdict.NOT_TESTABLE else _by_fullest_model(claim, data)[1]


def _weighed(found: Finding, faster: Finding, swept: Mapping[float, Finding]) -> Finding:
    """A finding in the light of those with other EA, which are compared with the same model's.

    Where that model says something else already with the study's EA, it says nothing of EA.
    """
    unlike = [ea for ea, other in swept.items() if other.verdict is not faster.verdict]
    if not unlike or faster.verdict is not found.verdict:
        return found
    texts = ", ".join(f"{swept[ea].verdict.value} with {ea:g} N" for ea in sorted(unlike))
    why = f"{found.why}; it depends on EA: {texts}"
    worse = any(swept[ea].verdict is not Verdict.REPRODUCED for ea in unlike)
    if found.verdict is Verdict.REPRODUCED and worse:
        return replace(found, verdict=Verdict.PARTLY, why=why)
    return replace(found, why=why)


def shifted(data: Data) -> Iterator[Data]:
    """Copies in which every curve of a solved model is shifted by what it may be off."""
    chance = np.random.default_rng(SEED)
    curves, states, shifts = data.table.curves, data.table.states, _shifts(data.table)
    for _ in range(COPIES):
        signs = pd.Series(chance.choice([-1.0, 1.0], len(curves)), curves.index)
        sign = signs.loc[states["curve"]].to_numpy()
        changed = {name: states[name] + sign * shift for name, shift in shifts.items()}
        changed["contraction"] = changed["contraction"].clip(*CONTRACTION_LIMITS)
        yield replace(data, table=replace(data.table, states=states.assign(**changed)))


def _shifts(table: Table) -> dict[str, pd.Series]:
    """What the numbers of every state may be off, by column; 0 for Eq. (1), which has no mesh."""
    rows, curve = table.joined(), table.states["curve"]
    of_isotonic, of_isometric = (
        rows["path"] == kind for kind in (PathKind.ISOTONIC, PathKind.ISOMETRIC)
    )
    stops = rows["point"] == STOP
    largest = rows["force"].abs().where(stops).groupby(curve).transform("max")
    usual = SHARE * largest.mask(of_isotonic, _blocked_force(rows))
    error = rows["force_error"].fillna(usual) if "force_error" in rows else usual
    # the pressure of zero force moves by the error over the mean slope of the force above it
    highest = rows.loc[of_isometric & stops, "pressure"].max()
    steepness = largest / (highest - rows["pressure"])
    threshold = -error.where(stops).groupby(curve).transform("max") / steepness
    # stiffness is dF/dl, and contraction is 1 - l/L
    contraction = error / (rows["stiffness"] * rows["length"])
    growth = rows["inner_diameter_inflated"] - rows["inner_diameter"]
    shifts = {
        "force": error.where(stops & ~of_isotonic, 0.0),
        "contraction": contraction.where(of_isotonic, 0.0),
        "pressure": threshold.where(of_isometric & ~stops, 0.0),
        "inner_diameter_inflated": SHARE * growth,
    }
    return {name: shift.where(rows["model"] != GEOMETRIC, 0.0) for name, shift in shifts.items()}


def _blocked_force(rows: pd.DataFrame) -> pd.Series:
    """Force at no contraction and the pressure of each state by Eq. (1) [N]."""
    angle = np.radians(rows["braid_angle"])
    area = np.pi * rows["inner_diameter"] ** 2 / 4
    return rows["pressure"] * area * (3 * np.cos(angle) ** 2 - 1) / np.sin(angle) ** 2
