"""A case: everything that can change a result, and nothing else.

Its canonical JSON is its identity. Settings that the model of a case does not read are not part of
it, so that scenes which differ only there share the solve.
"""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import Any

from geometry.braid import Kind, LayeredBraid
from geometry.muscle import Muscle
from geometry.plain import plain
from geometry.refusal import build, is_number
from solver import rubber
from solver.effects import (
    Effects,
    End,
    Layers,
    Rubber,
    Stretch,
    ThreadLaw,
    Twist,
    Volume,
    Wall,
    active,
    check_carried,
    switches,
)
from solver.friction import Friction, no_crossings
from solver.load_path import LoadPath, PathKind
from solver.material import Thread
from solver.memory import Memory
from solver.models import MODELS
from solver.models.model import BRAIDS
from solver.numerics import KINDS, Numerics
from solver.refusal import UnsolvableCase
from solver.rubber.rubber_law import RubberLaw

INCOMPRESSIBLE = {"kappa": 1e300}
ANY_THREAD = {"stiffness": 1}
MOST_FREQUENCIES = 1000
DYNAMIC = "dynamic_stiffness"  # of models that answer vibrations: quantity, and name of a field
ANY_MUSCLE = {"wall_thickness": 1e9, "length": 1.0}


@dataclass(frozen=True, kw_only=True)
class Case:
    """One curve of one muscle by one model.

    Attributes
    ----------
    fields_at : stops of the path at which fields (deformed shape, stress) are recorded too
    memory : of the rubber; only read where it can matter, in time or in a vibration
    friction : of the crossings of its sleeves; only read in time
    frequencies : of small vibrations, whose stiffness is found at every state of the path [Hz]
    numerics : what goes with the size of the muscle and was left out is filled in

    Raises
    ------
    UnsolvableCase
        If model, muscle and effects do not fit together.
    """

    muscle: Muscle
    rubber: RubberLaw
    thread: Thread | None
    path: LoadPath
    model: str
    effects: Effects = field(default_factory=Effects)
    numerics: Numerics = field(default_factory=Numerics)
    fields_at: tuple[float, ...] = ()
    memory: Memory | None = None
    friction: Friction | None = None
    frequencies: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "numerics", self.numerics.of(self.muscle))
        if self.model not in MODELS:
            raise UnsolvableCase("model", self.model, ", ".join(MODELS))
        self._check_braid()
        check_carried(self.model, self.effects)
        self._check_law()
        _check_sleeves(self.muscle, self.effects)
        if self.muscle.braid is None and self.effects.rubber is Rubber.NONE:
            raise UnsolvableCase("rubber", self.effects.rubber, "elastic in a bare tube")
        self._check_fields()
        if self.path.history is not None:
            self._check_history()
        if self.frequencies != ():
            self._check_frequencies()

    def _check_braid(self) -> None:
        """Refuse a braid without a thread, and one that the model has not."""
        model, braid = MODELS[self.model], self.muscle.braid
        if braid is not None and self.thread is None:
            raise UnsolvableCase("thread", None, "a thread, as the muscle has a braid")
        if braid is None and model.needs_braid:
            raise UnsolvableCase("model", self.model, "another model: Eq. (1) needs a braid")
        if braid is not None and (instead := BRAIDS[model.braids](braid)):
            raise UnsolvableCase("model", self.model, instead)

    def _check_law(self) -> None:
        """Refuse a law of rubber that the model cannot take."""
        frame, law = MODELS[self.model].frame, self.rubber
        if frame and not law.has_frame(frame):
            able = [m.name for m in MODELS.values() if m.frame != frame and "rubber" in m.parts]
            allowed = (
                f"{', '.join(able)}; {self.model} takes laws of the invariants only, and that of "
                f"the rubber, {law.law()}, needs principal stretches"
            )
            raise UnsolvableCase("model", self.model, allowed)

    def _check_fields(self) -> None:
        """Refuse fields at what is no stop, or of a model that has none."""
        if not isinstance(self.fields_at, tuple):
            raise UnsolvableCase("fields_at", self.fields_at, "a list of stops of the path")
        for stop in self.fields_at:
            if stop not in self.path.stops:
                raise UnsolvableCase("fields_at", stop, f"stops of the path, {self.path.stops}")
        if self.fields_at and not MODELS[self.model].fields:
            raise UnsolvableCase("fields_at", self.fields_at, f"none: {self.model} has no fields")

    def _check_history(self) -> None:
        """Refuse what no model can have in time, or this one cannot."""
        model, path = MODELS[self.model], self.path
        if not model.in_time:
            able = ", ".join(name for name in MODELS if MODELS[name].in_time)
            raise UnsolvableCase("model", self.model, f"in time {able}")
        if self.remembers and self.effects.twist is Twist.FREE:
            allowed = "held with a memory, whose branches have no shear"
            raise UnsolvableCase("twist", self.effects.twist, allowed)
        if self.friction is not None:
            self._check_friction()
        slack = path.kind is PathKind.ISOMETRIC and min(path.stops) <= 0
        if slack and model.crumples:
            allowed = f"pressures > 0 at a held contraction: without, {self.model} has no wall"
            raise UnsolvableCase("stops", min(path.stops), allowed)

    def _check_friction(self) -> None:
        """Refuse friction of what does not cross, or turns with the muscle."""
        if allowed := no_crossings(self.muscle.braid):
            raise UnsolvableCase("friction", plain(self.friction), allowed)
        if self.effects.twist is Twist.FREE:
            raise UnsolvableCase("twist", self.effects.twist, "held where a sleeve has friction")
        if self.effects.stretch is Stretch.RIGID:
            allowed = "elastic where a sleeve has friction"
            raise UnsolvableCase("stretch", self.effects.stretch, allowed)
        if self.hangs:
            allowed = "none of a sleeve that hangs from a collar of its own"
            raise UnsolvableCase("friction", plain(self.friction), allowed)

    def _check_frequencies(self) -> None:
        """Refuse vibrations that cannot be, or of a model that has none."""
        model, values = MODELS[self.model], self.frequencies
        able = ", ".join(name for name in MODELS if DYNAMIC in MODELS[name].quantities)
        if DYNAMIC not in model.quantities:
            raise UnsolvableCase("frequencies", values, f"none with {self.model}; with {able}")
        if not isinstance(values, tuple) or len(values) > MOST_FREQUENCIES:
            allowed = f"a list of at most {MOST_FREQUENCIES} numbers (Hz)"
            raise UnsolvableCase("frequencies", values, allowed)
        for value in values:
            if not (is_number(value) and value > 0):
                raise UnsolvableCase("frequencies", value, "finite numbers > 0 (Hz)")
        if self.memory is None:
            raise UnsolvableCase("frequencies", values, "none without a memory of the rubber")
        if self.path.history is not None:
            raise UnsolvableCase("frequencies", values, "none on a path in time")
        if self.effects.twist is Twist.FREE:
            allowed = "held with a memory, whose branches have no shear"
            raise UnsolvableCase("twist", self.effects.twist, allowed)
        if self.effects.stretch is Stretch.RIGID or self.effects.rubber is Rubber.NONE:
            allowed = "none of a rigid net or of no rubber"
            raise UnsolvableCase("frequencies", values, allowed)

    @property
    def remembers(self) -> bool:
        """Whether the memory of the rubber matters on the path."""
        has = self.memory is not None and self.effects.rubber is Rubber.ELASTIC
        return has and self.path.history is not None

    @property
    def rubs(self) -> bool:
        """Whether friction of sleeves matters on the path."""
        return self.friction is not None and self.path.history is not None

    @property
    def vibrates(self) -> bool:
        """Whether its answer to small vibrations is asked for."""
        return self.frequencies != ()

    @property
    def hangs(self) -> bool:
        """Whether a sleeve is crimped on a collar of its own, and the model has ends."""
        return any(layer.crimp for layer in self.muscle.layers) and self._has_ends

    @property
    def _has_ends(self) -> bool:
        return "end_caps" in MODELS[self.model].effects

    def as_dict(self) -> dict[str, Any]:
        """What the model reads, as plain values; ``from_dict`` reads it back."""
        muscle = self.muscle.as_dict()
        values: dict[str, Any] = {
            "model": self.model,
            "muscle": muscle,
            "path": self.path.as_dict(),
        }
        parts, braided = MODELS[self.model].parts, self.muscle.braid is not None
        if not self.clamped:
            del muscle["cap_length"]
        if braided and not self._has_ends:
            muscle["braid"].pop("crimp_radii", None)
        for name in MODELS[self.model].unread:
            del muscle[name]
        if "effects" in parts:
            read = switches(self.model, braided=braided)
            values["effects"] = {name: getattr(self.effects, name) for name in read}
        if "rubber" in parts and self.effects.rubber is Rubber.ELASTIC:
            values["rubber"] = self.rubber.as_dict()
            if not self.compressible:
                del values["rubber"]["kappa"]
        if "thread" in parts and braided and self.effects.stretch is Stretch.ELASTIC:
            assert self.thread is not None  # see __post_init__
            values["thread"] = plain(self.thread)
        if "numerics" in parts:
            read = self._read()
            values["numerics"] = {name: plain(getattr(self.numerics, name)) for name in read}
        if self.remembers or self.vibrates:
            assert self.memory is not None
            values["memory"] = plain(self.memory)
        if self.rubs:
            values["friction"] = plain(self.friction)
        if self.vibrates:
            values["frequencies"] = self.frequencies
        if self.fields_at:
            values["fields_at"] = self.fields_at
        return values

    @property
    def units(self) -> dict[str, str]:
        """Of the numbers that are of no part."""
        return {"fields_at": self.path.units["stops"], "frequencies": "Hz"}

    @property
    def active_effects(self) -> list[str]:
        """Names of the effects that are on (solver/effects.py), and of those in time."""
        found = active(self.model, self.effects, braided=self.muscle.braid is not None)
        history = self.path.history
        found += ["memory"] * self.remembers + ["friction"] * self.rubs
        if history is not None:
            found += ["mass"] * (history.mass > 0) + ["valve"] * (history.valve is not None)
        return found

    @property
    def compressible(self) -> bool:
        """Whether the bulk modulus matters."""
        return MODELS[self.model].compressible and self.effects.volume is Volume.COMPRESSIBLE

    @property
    def clamped(self) -> bool:
        """Whether the tube goes on into the fitting."""
        return "end" in MODELS[self.model].switches and self.effects.end is End.CLAMP

    def _read(self) -> list[str]:
        """The numerics that model and effects read."""
        effects, braided = self.effects, self.muscle.braid is not None
        model = MODELS[self.model]
        names = [*model.numerics]
        names += ["clamp"] * self.clamped
        slackens = effects.threads is ThreadLaw.TENSION_ONLY and effects.stretch is Stretch.ELASTIC
        names += ["slack"] * ("threads" in model.switches and braided and slackens)
        names += ["spread"] * ("layers" in model.switches and braided)
        return names

    def canonical(self) -> str:
        """Canonical JSON: sorted keys, shortest decimals, 20 for 20.0."""
        return canonical(self.as_dict())

    @cached_property
    def key(self) -> str:
        """Name of the case in files: the first 16 hexadecimal digits of its SHA-256."""
        return digest(self.canonical())

    def mesh_spec(self) -> str | None:
        """What shapes the mesh, as canonical JSON for ``python -m geometry``; None without one."""
        return self._mesh_spec

    @cached_property
    def _mesh_spec(self) -> str | None:
        kind = MODELS[self.model].mesh
        if kind is None:
            return None
        values = self.as_dict()
        muscle = values["muscle"]
        if kind == "cell":
            muscle["length"] = 1.0  # shapes no cell
        elif isinstance(self.muscle.braid, LayeredBraid):
            lines = self.muscle.braid.embedded_diameters  # all of it that shapes a section
            muscle["braid"] = plain(LayeredBraid.of_lines(lines)) if lines else None
        elif muscle["braid"] is not None:
            # lead and thread number shape no section: muscles that differ there share a mesh
            muscle["braid"] = {**muscle["braid"], "lead": 1.0, "threads": 1}
        spec = {"kind": kind, "muscle": muscle, "mesh": values["numerics"][kind]}
        if kind == "section":
            spec["end"] = self.effects.end
            if self.effects.end is End.CLAMP:
                spec["ramp"] = self.numerics.clamp.ramp
        if kind == "cell":
            spec["thread_radius"] = (
                self.numerics.spread.radius_of(self.thread) if self.thread is not None else None
            )
            spec["thread_lines"] = self.thread is not None and self.effects.layers is Layers.WIRE
        return canonical(spec)

    @classmethod
    def from_dict(cls, values: object) -> "Case":
        """The case of a plain mapping as ``as_dict`` makes it.

        Only what the model does not read may be left out; unknown keys are refused.
        """
        given = _filled(values)
        muscle = Muscle.from_dict(given.get("muscle"))
        parts: dict[str, Any] = {
            "path": LoadPath.from_dict(given.get("path")),
            "effects": build(Effects, given.get("effects"), UnsolvableCase, "effects"),
        }
        if "memory" in given:
            parts["memory"] = build(Memory, given["memory"], UnsolvableCase, "memory")
        if "friction" in given:
            parts["friction"] = build(Friction, given["friction"], UnsolvableCase, "friction")
        if "frequencies" in given:
            found = given["frequencies"]
            parts["frequencies"] = tuple(found) if isinstance(found, list) else found
        parts["rubber"] = rubber.from_dict(given.get("rubber"))
        if muscle.braid is None:
            parts["thread"] = None
        else:
            parts["thread"] = build(Thread, given.get("thread"), UnsolvableCase, "thread")
        fields_at = given["fields_at"]
        return cls(
            muscle=muscle,
            model=given["model"],
            numerics=_numerics(given["numerics"]),
            fields_at=tuple(fields_at) if isinstance(fields_at, list) else fields_at,
            **parts,
        )

    @classmethod
    def from_json(cls, text: str) -> "Case":
        """The case of its canonical JSON."""
        return cls.from_dict(json.loads(text))


def _check_sleeves(muscle: Muscle, effects: Effects) -> None:
    """Refuse effects that a braid of several layers, or a sleeve, has not."""
    braid = muscle.braid
    if not isinstance(braid, LayeredBraid):
        return
    if Kind.SLEEVE in braid.kinds and effects.threads is ThreadLaw.TWO_WAY:
        allowed = "tension_only: a sleeve lies on the wall, and cannot push or hold it"
        raise UnsolvableCase("threads", effects.threads, allowed)
    if effects.wall is Wall.ONE_RADIUS:
        allowed = "integrated, where layers have radii or angles of their own"
        raise UnsolvableCase("wall", effects.wall, allowed)


def canonical(values: dict[str, Any]) -> str:
    """Plain values as JSON: sorted keys, shortest decimals, 20 for 20.0."""
    return json.dumps(_canonical(values), sort_keys=True, allow_nan=False)


def digest(text: str) -> str:
    """First 16 hexadecimal digits of the SHA-256 of a text: the name of a case or a mesh."""
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def _filled(values: object) -> dict[str, Any]:
    """The mapping of a case with something that can be built in place of what its model ignores."""
    if not isinstance(values, Mapping):
        raise UnsolvableCase("case", values, "a mapping")
    known = [f.name for f in fields(Case)]
    for key in values:
        if key not in known:
            raise UnsolvableCase(key, values[key], f"no such key; there are {', '.join(known)}")
    name: Any = values.get("model")
    if name not in MODELS:
        raise UnsolvableCase("model", name, ", ".join(MODELS))
    model = MODELS[name]
    given: dict[str, Any] = {"effects": {}, "numerics": {}, "fields_at": ()} | dict(values)
    effects = given["effects"] if isinstance(given["effects"], Mapping) else {}
    if "rubber" not in model.parts or effects.get("rubber") == Rubber.NONE:
        given = {"rubber": rubber.anything() | INCOMPRESSIBLE} | given
    if "thread" not in model.parts or effects.get("stretch") == Stretch.RIGID:
        given = {"thread": ANY_THREAD} | given
    keeps_volume = not model.compressible or effects.get("volume") == Volume.INCOMPRESSIBLE
    if keeps_volume and isinstance(given.get("rubber"), Mapping):
        given["rubber"] = {**INCOMPRESSIBLE, **given["rubber"]}
    if isinstance(given.get("muscle"), Mapping):
        given["muscle"] = {**{key: ANY_MUSCLE[key] for key in model.unread}, **given["muscle"]}
    return given


def _numerics(values: object) -> Numerics:
    """The settings of a mapping; groups that are left out have their defaults."""
    if not isinstance(values, Mapping):
        raise UnsolvableCase("numerics", values, f"a mapping with the keys {', '.join(KINDS)}")
    for name in values:
        if name not in KINDS:
            raise UnsolvableCase(
                f"numerics.{name}", values[name], f"no such key; there are {', '.join(KINDS)}"
            )
    return Numerics(
        **{
            name: build(KINDS[name], entry, UnsolvableCase, f"numerics.{name}")
            for name, entry in values.items()
        }
    )


def _canonical(value: Any) -> Any:
    """The same plain value with whole numbers as integers, so that 20, 20.0 and 2e1 are one."""
    if isinstance(value, float):
        return int(value) if value.is_integer() else value
    if isinstance(value, dict):
        return {key: _canonical(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_canonical(entry) for entry in value]
    return value
