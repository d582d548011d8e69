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
from workflow.study.schema import (
    HELD_KEY,
    SWEPT_KEY,
    CycleEntry,
    MemoryEntry,
    Rows,
    Scene,
    TransientEntry,
)
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
        return _cycles(scene, scene.cycle, kind, held)
    assert scene.transient is not None
    return {0.0: _transient(scene.transient, kind, held)}


def _cycles(scene: Scene, entry: CycleEntry, kind: PathKind, held: float) -> dict[float, LoadPath]:
    """To and fro, by a table or by waves of some periods."""
    remembered: dict[str, Any] = {"start": Start(entry.start), "preload": entry.preload}
    found = {}
    if entry.table is not None:
        period = entry.table[-1][0]
        times, stops = _repeated(entry.table, entry.samples, entry.cycles)
        history = History(times=times, period=period, **remembered)
        return {period: LoadPath(kind=kind, held=held, stops=stops, history=history)}
    for period in entry.period or ():
        low, high = scene.swept
        times, stops = sampled(Wave(entry.wave), low, high, period, entry.cycles, entry.samples)
        history = History(times=times, period=period, **remembered)
        found[period] = LoadPath(kind=kind, held=held, stops=stops, history=history)
    return found


def _repeated(table: Rows, samples: int, cycles: int) -> tuple[tuple[float, ...], ...]:
    """Times and values of some cycles by a table, whose last time is the period."""
    period = table[-1][0]
    even = [float(f"{period * k / samples:.12g}") for k in range(samples + 1)]
    once = with_jumps(even, table)
    values = through(table, once)
    closed = int(values[-1] == values[0])  # else it jumps back where a cycle ends
    times, stops = once, values
    for number in range(1, cycles):
        later = (float(f"{number * period + time:.12g}") for time in once[closed:])
        times, stops = (*times, *later), stops + values[closed:]
    return times, stops


def _transient(given: TransientEntry, kind: PathKind, held: float) -> LoadPath:
    """What supply and load do."""
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
    history = History(
        times=times,
        start=Start(given.start),
        preload=given.preload,
        held=through(given.load, times) if given.load is not None else None,
        mass=given.mass,
        valve=valve,
    )
    stops = through(given.supply, times)
    return LoadPath(kind=kind, held=held, stops=stops, history=history)


def check(source: Source, keys: Keys, scene: Scene) -> Iterator[StudyError]:
    """What is missing or too much in a scene in time, and paths that cannot be."""
    own, other = ("cycle", "transient") if scene.path == "cycle" else ("transient", "cycle")
    if getattr(scene, other) is not None:
        yield source.refuse((*keys, other), "a mapping", f"this key is not used on a {own} path")
        return
    if getattr(scene, own) is None:
        yield source.refuse((*keys, own), None, f"this key must be given on a {own} path")
        return
    wrong = list(_factors(source, keys, scene))
    if scene.cycle is not None:
        wrong += _wrong_cycle(source, (*keys, own), scene.cycle)
    if scene.transient is not None:
        wrong += _wrong_transient(source, (*keys, own), scene, scene.transient)
    wrong = wrong or list(_wrong_ends(source, keys, scene))
    yield from wrong or _refused_paths(source, keys, scene)


def _is_wave(scene: Scene) -> bool:
    """Whether it goes between two values of the control that is swept."""
    return scene.cycle is not None and scene.cycle.table is None


def _factors(source: Source, keys: Keys, scene: Scene) -> Iterator[StudyError]:
    """The factors that it takes, and no others."""
    held, swept = HELD_KEY[scene.kind], SWEPT_KEY[scene.kind]
    needed = [held, swept] if _is_wave(scene) else [held]
    for key in ("pressure", "contraction", "load"):
        value = getattr(scene, key)
        if (value is None) == (key in needed):
            said = "must be given" if value is None else "is not used"
            given = None if value is None else list(value)
            on = "cycle" if scene.cycle is not None else "transient"
            yield source.refuse((*keys, key), given, f"this key {said} on this {on} path")


def _wrong_cycle(source: Source, keys: Keys, entry: CycleEntry) -> Iterator[StudyError]:
    """Its period and its samples; ``keys`` are those of the entry."""
    if entry.table is None and entry.period is None:
        yield source.refuse((*keys, "period"), None, "this key must be given; or a table")
    if entry.table is not None and entry.period is not None:
        allowed = "none with a table, whose last time it is"
        yield source.refuse((*keys, "period"), list(entry.period), allowed)
    low = [period for period in entry.period or () if period <= 0]
    if low:
        yield source.refuse((*keys, "period"), low[0], "periods > 0 (s)")
    if entry.table is None and (entry.samples < FEWEST_SAMPLES or entry.samples % 2):
        allowed = f"an even number >= {FEWEST_SAMPLES}: others miss where a wave turns"
        yield source.refuse((*keys, "samples"), entry.samples, allowed)


def _wrong_transient(
    source: Source, keys: Keys, scene: Scene, entry: TransientEntry
) -> Iterator[StudyError]:
    """Its step, and a load where none is held; ``keys`` are those of the entry."""
    if entry.step > entry.duration:
        allowed = f"at most duration, {entry.duration:g} (s)"
        yield source.refuse((*keys, "step"), entry.step, allowed)
    if entry.load is not None and scene.kind != "isotonic":
        yield source.refuse((*keys, "load"), "a table", "none where no load is held")


def _wrong_ends(source: Source, keys: Keys, scene: Scene) -> Iterator[StudyError]:
    """The two ends of a wave; and the load with which a transient begins, which is the held one."""
    swept = SWEPT_KEY[scene.kind]
    if _is_wave(scene) and len(given := getattr(scene, swept)) != 2:
        allowed = "two values, between which the cycle goes"
        yield source.refuse((*keys, swept), list(given), allowed)
    table = scene.transient.load if scene.transient is not None else None
    others = [load for load in scene.load or () if table and load != table[0][1]]
    if table is not None and others:
        allowed = f"a table that begins with the load that is held at first, {others[0]:g} (N)"
        yield source.refuse((*keys, "transient", "load"), list(table[0]), allowed)


def _refused_paths(source: Source, keys: Keys, scene: Scene) -> Iterator[StudyError]:
    """Why there is no such path at a held value; of the first where there is none."""
    held, swept = HELD_KEY[scene.kind], SWEPT_KEY[scene.kind]
    own = "cycle" if scene.cycle is not None else "transient"
    for value in getattr(scene, held):
        try:
            paths(scene, value)
        except Refusal as refusal:
            named = {"held": held, "stops": swept if _is_wave(scene) else "table"}
            key = named.get(refusal.field, refusal.field)
            place = (*keys, key) if key in (held, swept) else (*keys, own, key)
            yield source.refuse(place, refusal.value, refusal.allowed)
            return
