"""What a design must say so that it can be looked for."""

from collections.abc import Iterator
from typing import Any

from geometry.braid import Braid
from solver.load_path import CONTRACTION_LIMITS
from workflow.study.contents import Study
from workflow.study.errors import StudyError, choices
from workflow.study.limits import HIGHEST
from workflow.study.schema import DesignEntry, RequirementEntry
from workflow.study.source import Keys

NEEDS = {"force": "contraction", "stroke": "load", "air": "contraction"}  # of a quantity
TAKES = {  # what a requirement of a quantity may have, beside its limits and a pressure
    "force": ("contraction",),
    "stroke": ("load",),
    "air": ("contraction",),
}
NO_PRESSURE = ("length", "thread_cover")
LIMITS = ("at_least", "at_most")


def check(study: Study, name: str) -> Iterator[StudyError]:
    """What is wrong with a design of a study."""
    source, entry, keys = study.source, study.design[name], ("design", name)
    known = source.names("muscles")
    for key, names in (("base", (entry.base,)), ("free", entry.free.muscle or ())):
        for each in names:
            at = (*keys, key, "muscle") if key == "free" else (*keys, key)
            if each not in known:
                yield source.refuse(at, each, choices(each, known))
            elif each in study.muscles and not isinstance(study.muscles[each].muscle.braid, Braid):
                yield source.refuse(at, each, "a muscle with two layers of threads in its wall")
    for each in entry.free.material or ():
        if each not in study.rubbers:
            allowed = choices(each, study.rubbers)
            yield source.refuse((*keys, "free", "material"), each, allowed)
    chosen = entry.free.model_dump(exclude_none=True)
    if not any(key not in ("material", "muscle") or len(v) > 1 for key, v in chosen.items()):
        yield source.refuse((*keys, "free"), chosen, "at least one that may be chosen")
    for key in ("inner_diameter", "wall_thickness", "length", "angle", "threads"):
        pair = getattr(entry.free, key)
        if pair is not None and not 0 < pair[0] < pair[1]:
            yield source.refuse((*keys, "free", key), list(pair), "two rising numbers > 0")
    yield from _wall(study, (*keys, "free", "wall_thickness"), entry)
    if len(entry.minimise) + len(entry.maximise) not in (1, 2):
        key = "minimise" if entry.minimise or not entry.maximise else "maximise"
        value = list(getattr(entry, key)) or None
        yield source.refuse((*keys, key), value, "one objective, or two for a trade-off")
    if "mass" in entry.minimise:
        yield from _density(study, (*keys, "minimise"), entry)
    if not entry.require:
        yield source.refuse((*keys, "require"), {}, "at least one requirement")
    yield from _pressure(study, (*keys, "pressure"), entry.pressure)
    if entry.contraction is not None and not 0 < entry.contraction <= CONTRACTION_LIMITS[1]:
        allowed = f"more than 0, at most {CONTRACTION_LIMITS[1]:g}"
        yield source.refuse((*keys, "contraction"), entry.contraction, allowed)
    for each, requirement in entry.require.items():
        yield from _requirement(study, (*keys, "require", each), entry, requirement)


def _wall(study: Study, keys: Keys, entry: DesignEntry) -> Iterator[StudyError]:
    """The layers keep their depth, so no wall may be as thin as that."""
    walls = entry.free.wall_thickness
    for name in entry.free.muscle or (entry.base,):
        base = study.muscles[name].muscle if name in study.muscles else None
        if walls is None or base is None or not isinstance(base.braid, Braid):
            continue
        depth = (base.braid.layer_diameters[1] - base.inner_diameter) / 2
        if walls[0] <= depth < walls[1]:
            allowed = f"from more than {depth:.6g} mm on, where the outer layer of {name} lies"
            yield study.source.refuse(keys, list(walls), allowed)


def _density(study: Study, keys: Keys, entry: DesignEntry) -> Iterator[StudyError]:
    """A mass is that of the wall at least, whose density must be known."""
    for name in entry.free.muscle or (entry.base,):
        made = study.muscles.get(name)
        if made is not None and made.installation.density is None:
            allowed = f"another objective: {made.material} of {name} has no density"
            yield study.source.refuse(keys, "mass", allowed)


def _pressure(study: Study, keys: Keys, pressure: float) -> Iterator[StudyError]:
    if not 0 < pressure <= HIGHEST:
        yield study.source.refuse(keys, pressure, f"more than 0, at most {HIGHEST:g} (MPa)")


def _requirement(
    study: Study, keys: Keys, entry: DesignEntry, requirement: RequirementEntry
) -> Iterator[StudyError]:
    source, quantity = study.source, requirement.quantity
    given: dict[str, Any] = requirement.model_dump(exclude_none=True)
    limits = [key for key in LIMITS if key in given]
    if len(limits) != 1:
        at = (*keys, limits[0] if limits else "at_least")
        value = given[limits[0]] if limits else None
        yield source.refuse(at, value, f"exactly one of {', '.join(LIMITS)}")
    needed = NEEDS.get(quantity)
    if needed is not None and needed not in given:
        yield source.refuse((*keys, needed), None, f"this key must be given for {quantity}")
    for key in ("contraction", "load", "pressure"):
        used = key in TAKES.get(quantity, ()) or (key == "pressure" and quantity not in NO_PRESSURE)
        if key in given and not used:
            yield source.refuse((*keys, key), given[key], f"this key is not used for {quantity}")
    low, high = CONTRACTION_LIMITS
    if not low <= given.get("contraction", 0.0) <= high:
        allowed = f"a contraction from {low:g} to {high:g}, as a fraction"
        yield source.refuse((*keys, "contraction"), given["contraction"], allowed)
    if "pressure" in given:
        yield from _pressure(study, (*keys, "pressure"), given["pressure"])
    if quantity == "thread_share":
        bases = entry.free.muscle or (entry.base,)
        for base in bases:
            made = study.muscles.get(base)
            if made is not None and made.limits.thread_strength is None:
                allowed = f"another quantity: {base} has no thread_strength"
                yield source.refuse((*keys, "quantity"), quantity, allowed)
