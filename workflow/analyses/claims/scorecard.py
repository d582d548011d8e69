"""All claims in one table: number, how sure it is, verdict.

Two things make a number unsure. Discretisation: the dataset says by how much the force of each
state is off at most (force_error; without it SHARE of the curve's largest force), so the claims are
judged again on copies of the dataset in which every curve is shifted by that, up or down as chance
has it. And the thread stiffness, which the paper
does not give: they are judged again on datasets with other EA by a faster model. A claim that is
reproduced with one EA and not with another is reproduced partly.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace

import numpy as np
import pandas as pd
import xarray as xr

from solver.load_path import CONTRACTION_LIMITS
from workflow.analyses.claims.claim import GEOMETRIC, Claim, Data, Finding, Verdict
from workflow.analyses.claims.judge import CLAIMS, judge

MODELS = ("solid", "membrane")  # the fullest first
SWEPT_MODEL = "membrane"  # of the datasets with other EA
SHARE = 0.0025  # of the curve's largest force; the growth of a diameter is as exact
COPIES, SEED = 8, 20260101


def scorecard(trees: Mapping[float, xr.DataTree], stiffness: float) -> pd.DataFrame:
    """One row per claim.

    Parameters
    ----------
    trees : datasets by EA [N]
    stiffness : EA of the study; the verdict is its own
    """
    copies = list(shifted(trees[stiffness]))
    others = {ea: tree for ea, tree in trees.items() if ea != stiffness}
    return pd.DataFrame([_row(claim, trees[stiffness], copies, others) for claim in CLAIMS])


def _row(
    claim: Claim,
    tree: xr.DataTree,
    copies: Iterable[xr.DataTree],
    others: Mapping[float, xr.DataTree],
) -> dict[str, str | float]:
    model, found = _by_fullest_model(claim, tree)
    again = [judge(claim, Data(copy, model)).value for copy in copies]
    swept = {ea: _by_faster_model(claim, other) for ea, other in others.items()}
    swept = {ea: f for ea, f in swept.items() if f.verdict is not Verdict.NOT_TESTABLE}
    faster = _by_faster_model(claim, tree)
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


def _by_fullest_model(claim: Claim, tree: xr.DataTree) -> tuple[str, Finding]:
    """The finding of the first model that has what the claim speaks of."""
    for model in MODELS:
        found = judge(claim, Data(tree, model))
        if found.verdict is not Verdict.NOT_TESTABLE:
            break
    return model, found


def _by_faster_model(claim: Claim, tree: xr.DataTree) -> Finding:
    """The finding of the model that there is with every EA."""
    found = judge(claim, Data(tree, SWEPT_MODEL))
    return found if found.verdict is not Verdict.NOT_TESTABLE else _by_fullest_model(claim, tree)[1]


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


def shifted(tree: xr.DataTree) -> Iterator[xr.DataTree]:
    """Copies of a dataset with every curve of a solved model shifted by what it may be off."""
    chance = np.random.default_rng(SEED)
    for _ in range(COPIES):
        groups = {name: node.to_dataset() for name, node in tree.children.items()}
        for name in {"isobaric", "isometric", "isotonic"} & set(groups):
            groups[name] = _shifted(name, groups[name], chance)
        yield xr.DataTree.from_dict(groups)


def _shifted(name: str, data: xr.Dataset, chance: np.random.Generator) -> xr.Dataset:
    """One group, shifted."""
    dims = data.case.dims
    sign = xr.DataArray(chance.choice([-1.0, 1.0], data.case.shape), dims=dims)
    sign = sign.where(data.model != GEOMETRIC, 0.0)
    changed = {}
    if name == "isotonic":
        # stiffness is dF/dl, and contraction is 1 - l/L
        shift = sign * _error(data, _blocked_force(data)) / (data.stiffness * data.length)
        changed["contraction"] = (data.contraction + shift).clip(*CONTRACTION_LIMITS)
    else:
        swept = next(dim for dim in data.force.dims if dim not in dims)
        largest = np.abs(data.force).max(swept)
        error = _error(data, largest)
        changed["force"] = data.force + sign * error
        if "threshold_pressure" in data:
            steepness = largest / (data.pressure.max() - data.threshold_pressure)
            shift = sign * error.max(swept) / steepness
            changed["threshold_pressure"] = data.threshold_pressure - shift
    growth = data.inner_diameter_inflated - data.inner_diameter
    changed["inner_diameter_inflated"] = data.inner_diameter_inflated + sign * SHARE * growth
    return data.assign({key: new.transpose(*data[key].dims) for key, new in changed.items()})


def _error(data: xr.Dataset, largest: xr.DataArray) -> xr.DataArray:
    """What the force of each state is off at most [N]."""
    usual = SHARE * largest
    return data.force_error.fillna(usual) if "force_error" in data else usual


def _blocked_force(data: xr.Dataset) -> xr.DataArray:
    """Force at no contraction and each pressure by Eq. (1) [N]."""
    angle = np.radians(data.braid_angle)
    area = np.pi * data.inner_diameter**2 / 4
    force: xr.DataArray = data.pressure * area * (3 * np.cos(angle) ** 2 - 1) / np.sin(angle) ** 2
    return force
