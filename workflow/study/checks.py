"""What must fit together in a study before anything runs, and what of it is unusual."""

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from geometry.braid import Braid, Kind
from geometry.muscle import Muscle
from geometry.refusal import Refusal
from solver import net
from solver.case import DYNAMIC
from solver.load_path import ZERO_FORCE, LoadPath
from solver.record import SLEEVED
from workflow.study import figure_needs, in_time, units
from workflow.study.contents import StudiedMuscle, Study
from workflow.study.errors import StudyError, choices, shown
from workflow.study.limits import HIGHEST
from workflow.study.schema import (
    FORCE_MAPS,
    HELD_KEY,
    OF_TIME,
    QUANTITIES,
    SHAPES,
    SHEET,
    SWEPT_KEY,
    TIMED,
    CalibrationEntry,
    Scene,
    StudyFile,
)
from workflow.study.source import Keys, Source

EA = "thread_stiffness"
FORCES = {"load": "force"}  # in figures the same quantity
MOST_CURVES = 10_000  # of a scene: more is a typing error in a grid
SHORTEST, LONGEST = 0.02, 1e4  # length / inner diameter
THINNEST, THICKEST = 1e-3, 10.0  # wall / inner diameter
ANGLES = (0.25, 89.75)  # degrees; beyond, threads lie along the axis or around it
WEAK = 1.0  # stiffness of all threads along their length, as a share of the rubber's
FEEBLE, HUGE = 1e-3, 10.0  # load as a share of Eq. (1)


def scene(study: Study, name: str) -> Iterator[StudyError]:
    """Names that exist, the factors that the path takes and no others, and their values."""
    source, asked, keys = study.source, study.scenes[name], ("scenes", name)
    yield from _names(source, keys, asked)
    lacking = list(figure_needs.lacking(name, asked))
    for key, value, allowed in lacking:
        yield source.refuse((*keys, key), value, allowed)
    if asked.path is None:
        yield from _without_path(source, keys, asked)
        return
    if "path" in {key for key, _, _ in lacking}:
        return
    yield from _figure(study, keys, asked)
    yield from _effects_of_time(study, keys, asked)
    if asked.in_time:
        yield from _in_time(source, keys, asked)
        return
    yield from _factors(source, keys, asked)
    yield from _frequency(study, keys, asked)
    for quantity in asked.quantities:
        allowed = _quantity(asked, quantity)
        if allowed:
            yield source.refuse((*keys, "quantities"), quantity, allowed)
    factors = HELD_KEY[asked.path], SWEPT_KEY[asked.path]
    if all(getattr(asked, key) is not None for key in factors):
        yield from _values(source, keys, asked)


def _names(source: Source, keys: Keys, asked: Scene) -> Iterator[StudyError]:
    """Muscles and variants that there are."""
    for key in ("muscles", "variants"):
        known = dict.fromkeys(["default"] * (key == "variants") + source.names(key))
        for named in getattr(asked, key):
            if named not in known:
                allowed = choices(named, known)
                allowed = source.choices(key, named) if key == "muscles" else allowed
                yield source.refuse((*keys, key), named, allowed)


def _without_path(source: Source, keys: Keys, asked: Scene) -> Iterator[StudyError]:
    """A scene that solves nothing; the first key that it has no use for."""
    unused = (
        *("pressure", "contraction", "load", "models", "effects", "tolerance", "quantities"),
        *("cycle", "transient", "figure"),
    )
    for key in [key for key in unused if getattr(asked, key)][:1]:
        value = _as_written(getattr(asked, key))
        value = "a mapping" if key in ("cycle", "transient", "figure") else value
        yield source.refuse((*keys, key), value, "this key is not used without a path")


def _effects_of_time(study: Study, keys: Keys, asked: Scene) -> Iterator[StudyError]:
    """Effects that need time, and muscles that have them."""
    made = [study.muscles[name] for name in asked.muscles if name in study.muscles]
    for effect in OF_TIME:
        state = asked.effects.get(effect)
        if state is not None and not asked.in_time:
            allowed = "effects of a curve out of time: this one is only in time"
            yield study.source.refuse((*keys, "effects", effect), state, allowed)
        if state == "on" and any(getattr(each, effect) is None for each in made):
            allowed = "off; a muscle of the scene has none"
            yield study.source.refuse((*keys, "effects", effect), state, allowed)


def _factors(source: Source, keys: Keys, asked: Scene) -> Iterator[StudyError]:
    """The factors that a path out of time takes, and no others."""
    assert asked.path is not None
    for key in ("cycle", "transient"):
        if getattr(asked, key) is not None:
            allowed = f"this key is not used on an {asked.path} path"
            yield source.refuse((*keys, key), "a mapping", allowed)
    factors = [HELD_KEY[asked.path], SWEPT_KEY[asked.path]]
    for key in ("pressure", "contraction", "load"):
        value = _as_written(getattr(asked, key))
        if key == "load" and SHEET in asked.quantities and key not in factors:
            if asked.load is not None and not (len(asked.load) == 1 and asked.load[0] > 0):
                yield source.refuse((*keys, key), value, "one load > 0 (N), of the sheet")
            continue
        if (value is None) == (key in factors):
            needed = "must be given" if value is None else "is not used"
            yield source.refuse((*keys, key), value, f"this key {needed} on an {asked.path} path")
    of_sheet = asked.contraction if SHEET in asked.quantities else None
    if asked.path == "isobaric" and of_sheet and of_sheet[-1] <= 0:
        allowed = "contractions up to about where it pulls no more, for a sheet"
        yield source.refuse((*keys, "contraction"), _as_written(of_sheet), allowed)


def _figure(study: Study, keys: Keys, asked: Scene) -> Iterator[StudyError]:
    """Quantities that a figure shows, which its scene must have; two of them."""
    source, figure = study.source, asked.figure
    if figure is None:
        return
    made = [study.muscles[name].muscle for name in asked.muscles if name in study.muscles]
    sleeved = any(layer.kind is Kind.SLEEVE for muscle in made for layer in muscle.layers)
    for axis, name in (("x", figure.x), ("y", figure.y)):
        able = QUANTITIES.get(name or "", asked.models or ())
        allowed = ""
        if name in TIMED and not asked.in_time:
            allowed = f"a quantity of states out of time, on an {asked.path} path"
        elif name in SLEEVED and made and not sleeved:
            allowed = "a quantity of a tube alone; no muscle of the scene has a sleeve"
        elif asked.models and not set(able) & set(asked.models):
            allowed = f"a quantity of {', '.join(asked.models)}; this is only by {', '.join(able)}"
        if allowed:
            yield source.refuse((*keys, "figure", axis), name, allowed)
    if asked.in_time and getattr(asked, str(asked.path)) is None:
        return
    x, y = figure_needs.axes(asked)
    if FORCES.get(x, x) == FORCES.get(y, y):
        axis, other = ("y", x) if figure.y else ("x", y)
        same = "" if x == y else ", of which a load is one"
        allowed = f"another quantity than {other}, which the other axis shows{same}"
        yield source.refuse((*keys, "figure", axis), getattr(figure, axis), allowed)


def _frequency(study: Study, keys: Keys, asked: Scene) -> Iterator[StudyError]:
    """Frequencies where vibrations are asked for, of rubbers with a memory."""
    source, wanted = study.source, DYNAMIC in asked.quantities
    if wanted and asked.frequency is None:
        yield source.refuse((*keys, "frequency"), None, f"this key must be given with {DYNAMIC}")
    if not wanted and asked.frequency is not None:
        allowed = f"this key is only used with the quantity {DYNAMIC}"
        yield source.refuse((*keys, "frequency"), list(asked.frequency), allowed)
    low = [value for value in asked.frequency or () if value <= 0]
    if low:
        yield source.refuse((*keys, "frequency"), low[0], "frequencies > 0 (Hz)")
    for name in asked.muscles if wanted else ():
        made = study.muscles.get(name)
        if made is not None and made.memory is None:
            allowed = f"this quantity of rubbers with a memory; {made.material} of {name} has none"
            yield source.refuse((*keys, "quantities"), DYNAMIC, allowed)


def _in_time(source: Source, keys: Keys, asked: Scene) -> Iterator[StudyError]:
    """A scene in time, whose quantities are those of every state."""
    for quantity in asked.quantities:
        allowed = _quantity(asked, quantity)
        if quantity in ZERO_FORCE or quantity == DYNAMIC:
            allowed = f"this quantity only out of time, not on a {asked.path} path"
        if allowed:
            yield source.refuse((*keys, "quantities"), quantity, allowed)
    high = [p for p in asked.pressure or () if p > HIGHEST]
    if high:
        yield source.refuse((*keys, "pressure"), high[0], f"pressures up to {HIGHEST:g} (MPa)")
    yield from in_time.check(source, keys, asked)


def _as_written(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value


def _quantity(asked: Scene, quantity: str) -> str:
    """What is allowed in place of a quantity that cannot be had; empty if it can."""
    path = (ZERO_FORCE | {SHEET: "isobaric"}).get(quantity, asked.path)
    if path != asked.path:
        return f"this quantity only on an {path} path"
    for model in asked.models or ():
        if model not in QUANTITIES[quantity]:
            return f"this quantity only by {', '.join(QUANTITIES[quantity])}; not {model}"
    return ""


def _values(source: Source, keys: Keys, asked: Scene) -> Iterator[StudyError]:
    """Values of the factors that no state can have."""
    assert asked.path is not None
    held_key, swept_key = HELD_KEY[asked.path], SWEPT_KEY[asked.path]
    high = [p for p in asked.pressure or () if p > HIGHEST]
    if high:
        yield source.refuse((*keys, "pressure"), high[0], f"pressures up to {HIGHEST:g} (MPa)")
    curves = math.prod(map(len, (asked.muscles, asked.variants, asked.models or (1,), asked.held)))
    if curves > MOST_CURVES:
        allowed = f"at most {MOST_CURVES} curves in a scene, not {curves}"
        yield source.refuse((*keys, held_key), len(asked.held), allowed)
    for key, values in (
        (held_key, [(h, (0.0,)) for h in asked.held]),
        (swept_key, [(0.0, asked.swept)]),
    ):
        for held, stops in values:
            try:
                LoadPath(kind=asked.path, held=held, stops=stops)
            except Refusal as refusal:
                if refusal.value not in high:
                    yield source.refuse((*keys, key), refusal.value, refusal.allowed)
                break


def calibration(study: Study, name: str) -> Iterator[StudyError]:
    """A muscle with threads, bounds within which something can be fitted, and a name of forces.

    The forces themselves are looked at by ``workflow/data/bench.py``.
    """
    source, entry, keys = study.source, study.calibration[name], ("calibration", name)
    made, muscles = study.muscles.get(entry.muscle), source.names("muscles")
    if entry.muscle not in muscles:
        allowed = source.choices("muscles", entry.muscle)
        yield source.refuse((*keys, "muscle"), entry.muscle, allowed)
    elif group := source.groups.get(entry.muscle):
        allowed = f"one muscle; of {entry.muscle} there are {choices(entry.muscle, group)}"
        yield source.refuse((*keys, "muscle"), entry.muscle, allowed)
    elif made is not None and made.thread is None:
        yield source.refuse((*keys, "muscle"), entry.muscle, "a muscle with a braid")
    for key, (low, high) in entry.bounds:
        if not 0 < low < high:
            allowed = "two rising numbers > 0"
            yield source.refuse((*keys, "bounds", key), [low, high], allowed)
    positive = True
    for key in ("fit_pressure", "report_pressure"):
        given = getattr(entry, key)
        if given is not None and min(given) <= 0:
            positive = False
            yield source.refuse((*keys, key), list(given), "pressures > 0")
    if made is None or made.thread is None or not positive:
        return
    if entry.reference is None:
        allowed = f"{', '.join(FORCE_MAPS)} or a .csv file; {entry.muscle} has no map of its own"
        yield source.refuse((*keys, "reference"), None, allowed)
    yield from _fitted(source, keys, entry, made)


def _fitted(
    source: Source, keys: Keys, entry: CalibrationEntry, made: StudiedMuscle
) -> Iterator[StudyError]:
    """What the rubber does not have, and bounds up to which there is none."""
    shapes = SHAPES if isinstance(made.muscle.braid, Braid) else ()
    own = [EA, *(each.name for each in made.rubber.parameters() if each.bounds), *shapes]
    layers = source.plain["muscles"][source.owner(entry.muscle, "layers")].get("layers") or ()
    if EA in entry.fit and any({EA, "thread_modulus"} & set(layer) for layer in layers):
        allowed = f"of this muscle, {EA} where it is given once, for the muscle and not for a layer"
        yield source.refuse((*keys, "fit"), EA, allowed)
        return
    for key in entry.fit:
        if key not in own:
            allowed = f"of this muscle, {choices(key, own)}"
            yield source.refuse((*keys, "fit"), key, allowed)
            return
    yield from _tolerances(source, keys, entry, made)
    high = {key: getattr(entry.bounds, key)[1] for key in entry.fit if key not in (EA, *SHAPES)}
    try:
        replace(made.rubber, **high)
    except Refusal as refusal:
        widest = max(high, key=high.__getitem__)
        if min(high.values()) > 0:
            at, value = (*keys, "bounds", widest), list(getattr(entry.bounds, widest))
            yield source.refuse(
                at, value, f"bounds up to which {refusal.field} is {refusal.allowed}"
            )


def _tolerances(
    source: Source, keys: Keys, entry: CalibrationEntry, made: StudiedMuscle
) -> Iterator[StudyError]:
    """How well sizes are known: of those that are fitted, as far as there is such a muscle."""
    braid, wall = made.muscle.braid, made.muscle.wall_thickness
    off = {key: getattr(entry.tolerance, key) for key in SHAPES}
    for key, given in off.items():
        if given is None and key in entry.fit:
            yield source.refuse((*keys, "tolerance", key), None, "how well it is known")
        if given is not None and key not in entry.fit:
            yield source.refuse((*keys, "tolerance", key), given, f"only where {key} is fitted")
    if not isinstance(braid, Braid):
        return
    inner, outer = ((d - made.muscle.inner_diameter) / 2 for d in braid.layer_diameters)
    angle, moved = math.degrees(braid.angle), off["layer_radius"] or 0.0
    rooms = {
        "angle": min(angle - ANGLES[0], ANGLES[1] - angle),
        "layer_radius": min(inner, wall - outer),
        "wall_thickness": wall - outer - moved,
    }
    for key, room in rooms.items():
        if off[key] is not None and off[key] >= room:
            allowed = f"less than {room:.4g}, with which the layers are still in the wall"
            if key == "angle":
                allowed = f"less than {room:.4g} (degree)"
            yield source.refuse((*keys, "tolerance", key), off[key], allowed)
            return


def proportions(tube: Muscle) -> Iterator[tuple[str, str]]:
    """Key and what is allowed where lengths do not belong to one muscle."""
    d, t, length = tube.inner_diameter, tube.wall_thickness, tube.length
    for key, share, low, high in (
        ("length", length / d, SHORTEST, LONGEST),
        ("wall_thickness", t / d, THINNEST, THICKEST),
    ):
        if not low <= share <= high:
            blamed = "inner_diameter" if units.guess("inner_diameter", d) else key
            yield blamed, f"{key} / inner_diameter from {low:g} to {high:g}; here {share:.3g}"


def angle(radians: float) -> Iterator[str]:
    """What is allowed in place of an angle of threads at which they are no braid."""
    low, high = ANGLES
    degrees = math.degrees(radians)
    if not low <= degrees <= high:
        yield f"braid angles from {low:g} to {high:g} degrees; here {degrees:.3g}"


def unusual(source: Source, file: StudyFile, muscles: Mapping[str, StudiedMuscle]) -> Iterator[str]:
    """Values that can be used but look as if something else was meant, each in a line."""
    said: dict[Any, str] = {}  # once for each value of a line, of however many muscles of a sweep
    for keys, value in _written(file):
        guess = units.guess(keys[-1], value)
        if guess:
            text = f"{source.place(keys)} = {shown(value)} is unusual; perhaps {guess}"
            said.setdefault((source.line(keys), keys[-1], shown(value)), text)
    for name, made in muscles.items():
        for keys, text in _unusual_braid(source, name, made):
            said.setdefault((source.line(keys), made.thread), text)
    yield from said.values()
    for name, asked in file.scenes.items():
        if re.match(r"fig\w*\d", name, re.IGNORECASE) and not figure_needs.has_own(name):
            known_figures = choices(name, figure_needs.NEEDS)
            yield f"{source.place(('scenes', name))} has no figure of its own; {known_figures}"
        known = [muscles[m] for m in asked.muscles if m in muscles]
        yield from _unusual_load(source, ("scenes", name, "load"), asked, known)


def _written(file: StudyFile) -> Iterator[tuple[Keys, Any]]:
    """All values of entries, as they were written."""
    sections: dict[str, Mapping[str, Any]] = {
        "materials": file.materials,
        "muscles": file.muscles,
        "scenes": file.scenes,
        "calibration": file.calibration,
        "design": file.design,
        "map": file.map,
        "pair": file.pair,
    }
    for section, entries in sections.items():
        for name, entry in entries.items():
            for key in entry.model_fields_set:
                value = getattr(entry, key)
                if (section, key) == ("map", "tolerance"):
                    continue  # of a force, not a share
                if key == "layers":
                    for number, layer in enumerate(value or ()):
                        for own in layer.model_fields_set:
                            yield (section, name, key, number, own), getattr(layer, own)
                    continue
                yield (section, name, key), _as_written(value)
    for key in sorted(file.limits.model_fields_set):
        yield ("limits", key), getattr(file.limits, key)


def _unusual_braid(source: Source, name: str, made: StudiedMuscle) -> Iterator[tuple[Keys, str]]:
    braid, thread, tube = made.muscle.braid, made.thread, made.muscle
    if braid is None or thread is None:
        return
    area = math.pi * (tube.inner_diameter + tube.wall_thickness) * tube.wall_thickness
    key = "thread_stiffness"
    total = sum(layer.threads * thread.stiffness * layer.share for layer in tube.layers)
    share = total / (3 * made.rubber.shear_modulus * area)
    if share < WEAK:
        keys = "muscles", source.owner(name, key), key
        yield (
            keys,
            f"{source.place(keys)} = {thread.stiffness:g} is unusual; all threads are softer than "
            f"the rubber, {thread.stiffness:g} kN would be {1000 * thread.stiffness:g} N",
        )


def _unusual_load(
    source: Source, keys: Keys, asked: Scene, known: list[StudiedMuscle]
) -> Iterator[str]:
    """Loads that are nothing, or far too much, for the muscles of a scene."""
    loads = [abs(load) for load in asked.load or () if load]
    pulls = [
        abs(float(net.force(made.muscle, max(asked.pressure), 0.0)))
        for made in known
        if made.thread is not None and asked.pressure
    ]
    if not loads or not pulls or not min(pulls):
        return
    if min(loads) < FEEBLE * min(pulls):
        load = min(loads)
        yield f"{source.place(keys)} = {load:g} is unusual; {load:g} kN would be {1000 * load:g} N"
    if max(loads) > HUGE * max(pulls):
        load = max(loads)
        yield (
            f"{source.place(keys)} = {load:g} is unusual; Eq. (1) pulls with {max(pulls):.4g} N, "
            f"and {load:g} mN would be {load / 1000:g} N"
        )
