"""A study file: read, checked as a whole, and turned into muscles, variants and scenes.

Nothing is read from a study file anywhere else. ``base`` and ``angle_of`` of muscles are resolved
here, and every muscle is built, so that what cannot be built is refused before anything runs.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from decimal import Decimal
from functools import partial
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from geometry.muscle import Braid, Muscle
from solver.effects import Effects
from solver.material import MooneyRivlin, Thread
from solver.numerics import KINDS, Numerics
from workflow.study import fit
from workflow.study.errors import choices
from workflow.study.limits import Limits
from workflow.study.schema import (
    HELD_KEY,
    QUANTITIES,
    SWEPT_KEY,
    CalibrationEntry,
    MuscleEntry,
    Scene,
    StudyFile,
    VariantEntry,
)
from workflow.study.source import Keys, Source

CAP_PER_WALL = 4  # length in the fitting by wall thickness, unless given (docs/decisions/0004)
SHAPE_KEYS = ("inner_diameter", "wall_thickness", "length", "cap_length")
EA = "thread_stiffness"
OF_THREAD = (EA, "thread_diameter", "thread_strength")
BRAID_KEYS = ("layer_depths", "lead", "angle", "angle_of", *OF_THREAD)
ANGLE_KEYS = ("lead", "angle", "angle_of")  # exactly one of them
# What may change while a muscle stays the one that was measured: nobody has measured these.
NOT_MEASURED = (*OF_THREAD, "reference")


@dataclass(frozen=True, kw_only=True)
class StudiedMuscle:
    """A muscle of the study with its materials."""

    muscle: Muscle
    material: str
    rubber: MooneyRivlin
    thread: Thread | None
    limits: Limits = field(default_factory=Limits)  # of its materials
    reference: tuple[str, ...] = ()  # names of the force maps that are of this muscle


@dataclass(frozen=True, kw_only=True)
class Variant:
    """A set of effects and numerics."""

    effects: Effects
    numerics: Numerics


@dataclass(frozen=True, kw_only=True)
class Study:
    """What a study file says, by name."""

    source: Source
    muscles: dict[str, StudiedMuscle]
    variants: dict[str, Variant]
    scenes: dict[str, Scene]
    calibration: dict[str, CalibrationEntry]
    wall_time: int  # s, of one case
    memory: int  # MB, of one case


def load(path: Path | str) -> Study:
    """Read a study file.

    Raises
    ------
    StudyError
        Naming file, line, key, value and what is allowed.
    """
    source = Source.read(Path(path))
    try:
        file = StudyFile.model_validate(source.plain)
    except ValidationError as errors:
        raise source.refusal_of(errors) from None
    source.check_values()
    rubbers = {
        name: source.checked(
            ("materials", name), MooneyRivlin, entry.model_dump(exclude={"stretch_limit"})
        )
        for name, entry in file.materials.items()
    }
    limits = {
        name: source.checked(
            ("materials", name), Limits, entry.model_dump(include={"stretch_limit"})
        )
        for name, entry in file.materials.items()
    }
    variants = {"default": VariantEntry()} | file.variants
    modulus = _variant(source, file, "default", variants["default"]).numerics.spread.modulus
    muscles = _Muscles(source, file.muscles, rubbers, limits, modulus)
    study = Study(
        source=source,
        muscles={name: muscles.built(name) for name in file.muscles},
        variants={name: _variant(source, file, name, v) for name, v in variants.items()},
        scenes=file.scenes,
        calibration=file.calibration,
        wall_time=file.limits.wall_time,
        memory=file.limits.memory,
    )
    for name, scene in study.scenes.items():
        _check_scene(source, study, ("scenes", name), scene)
    for name, entry in study.calibration.items():
        _check_calibration(source, study, ("calibration", name), entry)
    return study


class _Muscles:
    """Resolves ``base`` and ``angle_of`` among the muscles of a file."""

    def __init__(
        self,
        source: Source,
        entries: Mapping[str, MuscleEntry],
        rubbers: Mapping[str, MooneyRivlin],
        limits: Mapping[str, Limits],
        modulus: float,
    ) -> None:
        self.source, self.entries, self.rubbers = source, entries, rubbers
        self.limits, self.modulus = limits, modulus
        self._complete: dict[str, dict[str, Any]] = {}
        self._built: dict[str, StudiedMuscle] = {}

    def complete(self, name: str, heirs: tuple[str, ...] = ()) -> dict[str, Any]:
        """The entry of a muscle with what it inherits."""
        if name not in self._complete:
            own = self.entries[name].model_dump(exclude_none=True)
            inherited: dict[str, Any] = {}
            if "base" in own:
                self._check_reference(("muscles", name, "base"), own["base"], (*heirs, name))
                inherited = dict(self.complete(own.pop("base"), (*heirs, name)))
            if any(key in own for key in ANGLE_KEYS):
                inherited = {k: v for k, v in inherited.items() if k not in ANGLE_KEYS}
            if own.get("threads") == "none":
                inherited = {k: v for k, v in inherited.items() if k not in BRAID_KEYS}
            measured = {k: v for k, v in own.items() if k not in NOT_MEASURED}
            if any(value != inherited.get(key) for key, value in measured.items()):
                inherited.pop("reference", None)  # the maps are of the other muscle
            self._complete[name] = inherited | own
        return self._complete[name]

    def built(self, name: str, askers: tuple[str, ...] = ()) -> StudiedMuscle:
        """The muscle of a name, with its materials; ``askers`` need it for their angle."""
        if name not in self._built:
            values, keys = self.complete(name), ("muscles", name)
            bare = values.get("threads") == "none"
            self._check_keys(keys, values, BRAID_KEYS if bare else ())
            cap_length = CAP_PER_WALL * values["wall_thickness"]
            shape = {"cap_length": cap_length} | {k: values[k] for k in SHAPE_KEYS if k in values}
            checked = self.source.checked
            tube = checked(keys, Muscle, shape | {"braid": None})
            muscle = tube if bare else replace(tube, braid=self._braid(name, values, askers))
            thread, room = None, ""
            if muscle.braid is not None:
                thread = checked(keys, Thread, {"stiffness": values[EA]}, {"stiffness": EA})
                threads = muscle.braid, thread, values.get("thread_diameter")
                checked(keys, partial(fit.check, *threads), {})
                room = fit.note(*threads, self.modulus)
            self._built[name] = StudiedMuscle(
                muscle=muscle,
                material=values["material"],
                rubber=self.rubbers[values["material"]],
                thread=thread,
                limits=checked(
                    keys,
                    partial(replace, self.limits[values["material"]]),
                    {"thread_strength": values.get("thread_strength"), "room": room},
                ),
                reference=values.get("reference", ()),
            )
        return self._built[name]

    def _check_keys(self, keys: Keys, values: dict[str, Any], unused: Sequence[str]) -> None:
        needed = ["inner_diameter", "wall_thickness", "length", "threads", "material"]
        for key in needed if unused else [*needed, "layer_depths", EA]:
            if key not in values:
                raise self.source.refuse((*keys, key), None, "this key must be given")
        for key in unused:
            if key in values:
                raise self.source.refuse((*keys, key), values[key], "not with threads: none")
        if values["material"] not in self.rubbers:
            allowed = choices(values["material"], self.rubbers)
            raise self.source.refuse((*keys, "material"), values["material"], allowed)

    def _braid(self, name: str, values: dict[str, Any], askers: tuple[str, ...]) -> Braid:
        keys = ("muscles", name)
        given = [key for key in ANGLE_KEYS if key in values]
        if len(given) != 1:
            raise self.source.refuse(
                (*keys, given[1] if given else "lead"),
                values[given[1]] if given else None,
                f"exactly one of {', '.join(ANGLE_KEYS)}",
            )
        diameters = self._layer_diameters(keys, values)
        common = {"threads": values["threads"], "layer_diameters": diameters}
        checked = self.source.checked
        if given == ["angle"]:
            return checked(keys, Braid.from_angle, common | {"angle": values["angle"]})
        if given == ["lead"]:
            return checked(keys, Braid, common | {"lead": values["lead"]})
        other = values["angle_of"]
        self._check_reference((*keys, "angle_of"), other, (*askers, name))
        braid = self.built(other, (*askers, name)).muscle.braid
        if braid is None:
            raise self.source.refuse((*keys, "angle_of"), other, "a muscle with a braid")
        lead = braid.lead * sum(diameters) / sum(braid.layer_diameters)
        return checked(keys, Braid, common | {"lead": lead})

    def _layer_diameters(self, keys: Keys, values: dict[str, Any]) -> tuple[float, float]:
        """Inner diameter plus twice the depths, in exact decimals."""
        inner, outer = values["layer_depths"]
        if not 0 < inner < outer < values["wall_thickness"]:
            raise self.source.refuse(
                (*keys, "layer_depths"),
                list(values["layer_depths"]),
                "two rising depths, more than 0 and less than the wall thickness of "
                f"{values['wall_thickness']:g} (mm)",
            )
        d0, d1, d2 = (Decimal(str(v)) for v in (values["inner_diameter"], inner, outer))
        return float(d0 + 2 * d1), float(d0 + 2 * d2)

    def _check_reference(self, keys: Keys, other: str, seen: tuple[str, ...]) -> None:
        if other not in self.entries:
            raise self.source.refuse(keys, other, choices(other, self.entries))
        if other in seen:
            raise self.source.refuse(keys, other, "no circle: " + " -> ".join((*seen, other)))


def _variant(source: Source, file: StudyFile, name: str, entry: VariantEntry) -> Variant:
    """Defaults, then the study's numerics, then the variant's own."""
    own = ("variants", name, "numerics")
    parts = {}
    for kind, build in KINDS.items():
        values: dict[str, Any] = {}
        for entries in (file.numerics, entry.numerics):
            part = getattr(entries, kind)
            values |= part.model_dump(exclude_none=True) if part else {}
        keys = (*own, kind) if getattr(entry.numerics, kind) else ("numerics", kind)
        parts[kind] = source.checked(keys, build, values)
    effects = Effects(**dict(entry.effects))
    return Variant(effects=effects, numerics=Numerics(**parts))


def _check_scene(source: Source, study: Study, keys: Keys, scene: Scene) -> None:
    """Names that exist, and the factors that the path takes and no others."""
    for key, known in (("muscles", study.muscles), ("variants", study.variants)):
        for name in getattr(scene, key):
            if name not in known:
                raise source.refuse((*keys, key), name, choices(name, known))
    factors = [HELD_KEY[scene.path], SWEPT_KEY[scene.path]] if scene.path else []
    for key in ("pressure", "contraction", "load"):
        value = getattr(scene, key)
        if (value is None) == (key in factors):
            place = f"on an {scene.path} path" if scene.path else "without a path"
            needed = "must be given" if value is None else "is not used"
            raise source.refuse((*keys, key), value, f"this key {needed} {place}")
    for key in ("models", "effects", "tolerance") if scene.path is None else ():
        if getattr(scene, key):
            raise source.refuse((*keys, key), getattr(scene, key), "left out without a path")
    for quantity in scene.quantities:
        _check_quantity(source, (*keys, "quantities"), scene, quantity)


def _check_calibration(source: Source, study: Study, keys: Keys, entry: CalibrationEntry) -> None:
    """A muscle with threads, and bounds within which something can be fitted."""
    if entry.muscle not in study.muscles:
        raise source.refuse((*keys, "muscle"), entry.muscle, choices(entry.muscle, study.muscles))
    if study.muscles[entry.muscle].thread is None:
        raise source.refuse((*keys, "muscle"), entry.muscle, "a muscle with a braid")
    for key, (low, high) in entry.bounds:
        if not 0 < low < high:
            allowed = "two rising numbers > 0"
            raise source.refuse((*keys, "bounds", key), [low, high], allowed)
    for key in ("fit_pressure", "report_pressure"):
        if min(getattr(entry, key)) <= 0:
            raise source.refuse((*keys, key), list(getattr(entry, key)), "pressures > 0")


def _check_quantity(source: Source, keys: Keys, scene: Scene, quantity: str) -> None:
    only_on = {"threshold_pressure": "isometric", "free_contraction": "isobaric"}
    path = only_on.get(quantity, scene.path)
    if scene.path is None or path != scene.path:
        raise source.refuse(keys, quantity, f"this quantity only on an {path or 'y'} path")
    for model in scene.models or ():
        if model not in QUANTITIES[quantity]:
            allowed = f"this quantity only by {', '.join(QUANTITIES[quantity])}; not {model}"
            raise source.refuse(keys, quantity, allowed)
