"""What leaving out an effect changes on a curve: measured where records are there that say it.

Two records of one curve differ by an effect if one carries it and the other does not, and all else
is the same. Going from the solid to the membrane two are left out, so of these it is known together
only. What the mesh of the solid adds is not parted from that.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import permutations
from math import isnan, nan
from typing import Any

import numpy as np

from geometry.refusal import Refusal
from solver.case import Case
from solver.effects import EFFECTS, active
from solver.models import MODELS
from solver.record import Solution
from workflow.plan.effect_costs import MESHES
from workflow.plan.judged import is_valid, scale, variable_of
from workflow.plan.model_choice import readable, switched

Known = Callable[[str], tuple[Case, Solution] | None]  # the record of a key
FEW = 2  # effects that differ at most: of more together nothing can be said of one


@dataclass(frozen=True)
class Measured:
    """What leaving out some effects together has changed on a curve.

    Attributes
    ----------
    change : the largest at states that both have, as a share of the largest value along the curve
    lost : states that only the curve with it has
    by : the models that were compared
    """

    effects: tuple[str, ...]
    change: float
    lost: int
    by: tuple[str, str]


def effects_of(case: Case) -> tuple[str, ...]:
    """That a muscle at rest can have: of a bare tube those of a braid are none."""
    braided = case.muscle.braid is not None
    return tuple(name for name, effect in EFFECTS.items() if braided or not effect.braid)


def measured(
    cases: Sequence[Case], known: Known, quantities: Sequence[str], more: Iterable[str] = ()
) -> dict[str, Measured]:
    """Of a curve by some models what leaving out each effect has changed, as far as it is known.

    Also by what else ``known`` has: the curve by other models, and with one effect moved; and by
    ``more`` keys, of the curve at some of its stops. Said is what tells most: of fewest effects
    together, within the fullest model, on its finest mesh.
    """
    keys = dict.fromkeys([*more, *(case.key for case in _relatives(cases))])
    there = [found for key in keys if (found := known(key)) is not None]
    best: dict[str, tuple[tuple[int, int, int], Measured]] = {}
    for (number, (on, with_it)), (_, (off, without)) in permutations(enumerate(there), 2):
        effects = _between(on, off)
        if not effects:
            continue
        change, lost = _change(on, with_it, off, without, quantities)
        if isnan(change):
            continue
        order = (len(effects), -MODELS[on.model].rank, -number)
        for effect in effects:
            if effect not in best or order < best[effect][0]:
                best[effect] = order, Measured(effects, change, lost, (on.model, off.model))
    return {effect: found for effect, (_, found) in best.items()}


def _relatives(cases: Sequence[Case]) -> list[Case]:
    """The curve by some models, by all others and with one effect moved; coarser meshes first."""
    found: dict[str, Case] = {}
    for base in {case.path: case for case in reversed(cases)}.values():  # the first of each
        for mesh in MESHES.values():
            found |= {c.key: c for name in MODELS if (c := _made(base, name, mesh))}
        for name, model in MODELS.items():
            moved = (effect for effect in model.effects if EFFECTS[effect].switch in model.switches)
            found |= {c.key: c for effect in moved if (c := _made(base, name, {}, effect))}
    return list((found | {case.key: case for case in cases}).values())


def _made(base: Case, model: str, mesh: Mapping[str, Any], moved: str = "") -> Case | None:
    """By a model, on a mesh, with an effect moved; None if there is no such case."""
    try:
        effects = readable(model, base.effects)
        if moved:
            is_on = moved in active(model, effects, braided=base.muscle.braid is not None)
            effects = readable(model, switched(effects, {moved: "off" if is_on else "on"}))
        numerics = replace(base.numerics, **mesh)
        return replace(base, model=model, effects=effects, numerics=numerics, fields_at=())
    except Refusal:
        return None


def _between(on: Case, off: Case) -> tuple[str, ...]:
    """The few effects by which two cases of a curve differ; empty if there are more, or others."""
    more = [effect for effect in on.active_effects if effect not in off.active_effects]
    if not 0 < len(more) <= FEW or set(off.active_effects) - set(on.active_effects):
        return ()
    if on.model == off.model and on.numerics != off.numerics:
        return ()
    both = set(MODELS[on.model].switches) & set(MODELS[off.model].switches)
    both -= {EFFECTS[effect].switch for effect in more}
    same = all(getattr(on.effects, name) == getattr(off.effects, name) for name in both)
    return tuple(more) if same else ()


def _change(
    on: Case, with_it: Solution, off: Case, without: Solution, quantities: Sequence[str]
) -> tuple[float, int]:
    """The largest at common stops, of the largest value; and the states that are lost."""
    pairs = [
        (number, off.path.stops.index(stop))
        for number, stop in enumerate(on.path.stops)
        if stop in off.path.stops
    ]
    if not pairs:
        return nan, 0
    here, there = (list(numbers) for numbers in zip(*pairs, strict=True))
    valid, also = is_valid(with_it)[here], is_valid(without)[there]
    lost, changes = int((valid & ~also).sum()), []
    for quantity in quantities:
        name = variable_of(on, quantity)
        if name in with_it.states and name in without.states and (valid & also).any():
            off_by = np.abs(with_it.states[name][here] - without.states[name][there])
            changes.append(float(off_by[valid & also].max()) / scale(on, with_it, quantity))
    return (max(changes) if changes else nan), lost
