"""What a map, and a pair of maps, must say so that it can be made."""

from collections.abc import Iterator

from solver.load_path import CONTRACTION_LIMITS
from workflow.study.contents import Study
from workflow.study.errors import StudyError, choices
from workflow.study.limits import HIGHEST

FEWEST = 3  # values of a factor, between which cubics mean something


def check(study: Study, name: str) -> Iterator[StudyError]:
    """What is wrong with a map of a study."""
    source, entry, keys = study.source, study.maps[name], ("map", name)
    if entry.muscle not in source.names("muscles"):
        allowed = choices(entry.muscle, source.names("muscles"))
        yield source.refuse((*keys, "muscle"), entry.muscle, allowed)
    if entry.variant not in study.variants:
        allowed = choices(entry.variant, study.variants)
        yield source.refuse((*keys, "variant"), entry.variant, allowed)
    for key, low, high, unit in (
        ("pressure", 0.0, HIGHEST, " (MPa)"),
        ("contraction", *CONTRACTION_LIMITS, ", as a fraction"),
    ):
        values = list(getattr(entry, key))
        if len(values) < FEWEST:
            yield source.refuse((*keys, key), values, f"at least {FEWEST} values")
        elif not low <= values[0] <= values[-1] <= high:
            yield source.refuse((*keys, key), values, f"values from {low:g} to {high:g}{unit}")
    if entry.contraction[0] > 0 or entry.contraction[-1] <= 0:
        allowed = "values from 0 or less to more than 0"
        yield source.refuse((*keys, "contraction"), list(entry.contraction), allowed)


def check_pair(study: Study, name: str) -> Iterator[StudyError]:
    """What is wrong with a pair of maps on a pulley."""
    source, entry, keys = study.source, study.pairs[name], ("pair", name)
    known = source.names("map")
    for key in ("agonist", "antagonist"):
        named = getattr(entry, key)
        if named is not None and named not in known:
            yield source.refuse((*keys, key), named, choices(named, known))
    maps = [study.maps.get(each) for each in (entry.agonist, entry.antagonist or entry.agonist)]
    found = [each for each in maps if each is not None]
    low = max((each.contraction[0] for each in found), default=CONTRACTION_LIMITS[0])
    high = min((each.contraction[-1] for each in found), default=CONTRACTION_LIMITS[1])
    if not low <= entry.contraction <= high:
        allowed = f"{low:g} to {high:g}, where the maps are"
        yield source.refuse((*keys, "contraction"), entry.contraction, allowed)
    if len(entry.angle) < 2:
        yield source.refuse((*keys, "angle"), list(entry.angle), "at least 2 values (degree)")
    for pressures in entry.pressure:
        for made, pressure in zip(maps, pressures, strict=True):
            if made is not None and not made.pressure[0] <= pressure <= made.pressure[-1]:
                allowed = f"{made.pressure[0]:g} to {made.pressure[-1]:g} MPa, where the map is"
                yield source.refuse((*keys, "pressure"), list(pressures), allowed)
                break
