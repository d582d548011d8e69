"""Scenes in time: from their keys to the paths that they ask for, and what is refused of them."""

from collections.abc import Iterator
from typing import Any

from geometry.refusal import Refusal, build
from solver.history import (
    MOST_STEPS,
    History,
    Start,
    Valve,
    Wave,
    sampled,
    through,
    with_jumps,
)
from solver.load_path import LoadPath, PathKind
from solver.memory import Memory
from solver.refusal import UnsolvableCase
from workflow.study.errors import StudyError
from workflow.study.schema import HELD_KEY, SWEPT_KEY, MemoryEntry, Scene
from workflow.study.source import Keys, Source

FEWEST_SAMPLES = 4  # of a wave
WHOLE = 1e-6  # share of a duration by which steps may miss it: thirds are no decimals
FLAT, LISTED = ("per_decade", "from", "to"), ("shares", "times")


def memory(source: Source, keys: Keys, entry: MemoryEntry) -> Memory:
    """The memory of a material: a flat spectrum, or a list of shares and times."""
    given = entry.model_dump(by_alias=True, exclude_none=True)
    of = LISTED if any(key in given for key in LISTED) else FLAT
    for key in (*FLAT, *LISTED):
        if key in given and key not in of:
            allowed = f"{' and '.join(FLAT)}, or {' and '.join(LISTED)}"
            raise source.refuse((*keys, key), given[key], allowed)
        if key in of and key not in given:
            raise source.refuse((*keys, key), None, "this key must be given")
    if of is LISTED:
        return source.checked(keys, Memory, given)
    names = {"from": "start", "to": "end"}
    values = {names.get(key, key): value for key, value in given.items()}
    return source.checked(keys, Memory.flat, values)


def paths(scene: Scene, held: float) -> dict[float, LoadPath]:
    """The paths of a scene in time at a held value, by their period (0 where there is none).

    Raises
    ------
    UnsolvableCase
        If there can be no such path.
    """
    kind = PathKind(scene.kind)
    if scene.cycle is not None:
        entry = scene.cycle
        remembered: dict[str, Any] = {"start": Start(entry.start), "preload": entry.preload}
        if entry.table is not None:
            period = entry.table[-1][0]
            even = [float(f"{period * k / entry.samples:.12g}") for k in range(entry.samples + 1)]
            once = with_jumps(even, entry.table)
            values = through(entry.table, once)
            closed = int(values[-1] == values[0])  # else it jumps back where a cycle ends
            times, stops = once, values
            for number in range(1, entry.cycles):
                later = (float(f"{number * period + time:.12g}") for time in once[closed:])
                times, stops = (*times, *later), stops + values[closed:]
            history = History(times=times, period=period, **remembered)
            return {period: LoadPath(kind=kind, held=held, stops=stops, history=history)}
        found = {}
        for period in entry.period or ():
            low, high = scene.swept
            times, stops = sampled(Wave(entry.wave), low, high, period, entry.cycles, entry.samples)
            history = History(times=times, period=period, **remembered)
            found[period] = LoadPath(kind=kind, held=held, stops=stops, history=history)
        return found
    assert scene.transient is not None
    given = scene.transient
    count = max(round(given.duration / given.step), 1)
    if abs(count * given.step - given.duration) > WHOLE * given.duration:
        allowed = f"a whole number of steps; {count} of them are {count * given.step:g} s"
        raise UnsolvableCase("duration", given.duration, allowed)
    if count > MOST_STEPS:
        raise UnsolvableCase("step", given.step, f"at most {MOST_STEPS} steps, not {count}")
    times = tuple(float(f"{given.step * k:.12g}") for k in range(count + 1))
    valve = None
    if given.valve is not None:
        valve = build(Valve, given.valve.model_dump(), UnsolvableCase, "valve")
    else:
        times = with_jumps(times, given.supply)
        if given.load is not None and not given.mass:
            times = with_jumps(times, given.load)
    loads = through(given.load, times) if given.load is not None else None
    history = History(
        times=times,
        start=Start(given.start),
        preload=given.preload,
        held=loads,
        mass=given.mass,
        valve=valve,
    )
    stops = through(given.supply, times)
    return {0.0: LoadPath(kind=kind, held=held, stops=stops, history=history)}


def check(source: Source, keys: Keys, scene: Scene) -> Iterator[StudyError]:
    """What is missing or too much in a scene in time, and paths that cannot be."""
    own = "cycle" if scene.path == "cycle" else "transient"
    other = "transient" if own == "cycle" else "cycle"
    if getattr(scene, other) is not None:
        yield source.refuse((*keys, other), "a mapping", f"this key is not used on a {own} path")
        return
    entry: Any = getattr(scene, own)
    if entry is None:
        yield source.refuse((*keys, own), None, f"this key must be given on a {own} path")
        return
    held, swept = HELD_KEY[scene.kind], SWEPT_KEY[scene.kind]
    waved = own == "cycle" and entry.table is None
    needed = [held, swept] if waved else [held]
    wrong = False
    for key in ("pressure", "contraction", "load"):
        value = getattr(scene, key)
        if (value is None) == (key in needed):
            said = "must be given" if value is None else "is not used"
            given = None if value is None else list(value)
            yield source.refuse((*keys, key), given, f"this key {said} on this {own} path")
            wrong = True
    if own == "cycle" and waved and entry.period is None:
        yield source.refuse((*keys, own, "period"), None, "this key must be given; or a table")
        wrong = True
    if own == "cycle" and not waved and entry.period is not None:
        allowed = "none with a table, whose last time it is"
        yield source.refuse((*keys, own, "period"), list(entry.period), allowed)
        wrong = True
    low = [period for period in (entry.period or () if own == "cycle" else ()) if period <= 0]
    if low:
        yield source.refuse((*keys, own, "period"), low[0], "periods > 0 (s)")
        wrong = True
    if waved and (entry.samples < FEWEST_SAMPLES or entry.samples % 2):
        allowed = f"an even number >= {FEWEST_SAMPLES}: others miss where a wave turns"
        yield source.refuse((*keys, own, "samples"), entry.samples, allowed)
        wrong = True
    if own == "transient" and entry.step > entry.duration:
        allowed = f"at most duration, {entry.duration:g} (s)"
        yield source.refuse((*keys, own, "step"), entry.step, allowed)
        wrong = True
    if waved and not wrong and len(getattr(scene, swept)) != 2:
        given = list(getattr(scene, swept))
        yield source.refuse((*keys, swept), given, "two values, between which the cycle goes")
        wrong = True
    if own == "transient" and entry.load is not None and scene.kind != "isotonic":
        yield source.refuse((*keys, own, "load"), "a table", "none where no load is held")
        wrong = True
    if wrong:
        return
    table = entry.load if own == "transient" else None
    others = [load for load in scene.load or () if table and load != table[0][1]]
    if table is not None and others:
        allowed = f"a table that begins with the load that is held at first, {others[0]:g} (N)"
        yield source.refuse((*keys, own, "load"), list(table[0]), allowed)
        return
    for value in getattr(scene, held):
        try:
            paths(scene, value)
        except Refusal as refusal:
            named = {"held": held, "stops": swept if waved else "table"}
            key = named.get(refusal.field, refusal.field)
            place = (*keys, key) if key in (held, swept) else (*keys, own, key)
            yield source.refuse(place, refusal.value, refusal.allowed)
            return
