"""The muscles of a study file, built from their entries with what these inherit."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from decimal import Decimal
from functools import partial
from typing import Any, TypeVar

from geometry.braid import Layer
from geometry.muscle import AnyBraid, Braid, Muscle
from geometry.refusal import Refusal
from solver.friction import Friction, no_crossings
from solver.material import Thread
from solver.rubber.rubber_law import RubberLaw
from workflow.study import checks, fit, layers
from workflow.study.contents import StudiedMuscle
from workflow.study.errors import LISTED, AlreadyRefused, Findings, StudyError, choices
from workflow.study.layers import Wound
from workflow.study.materials import Materials
from workflow.study.schema import MuscleEntry
from workflow.study.source import Source

T = TypeVar("T")
CAP_PER_WALL = 4  # length in the fitting by wall thickness, unless given (docs/decisions/0004)
SHAPE_KEYS = ("inner_diameter", "wall_thickness", "length", "cap_length")
EA = "thread_stiffness"
MODULUS = "thread_modulus"
OF_THREAD = (EA, MODULUS, "thread_diameter", "thread_strength", "thread_density")
BUILT_IN = ("fitting_length", "fitting_mass", "dead_volume", "ambient_pressure")
OF_INSTALLATION = (*BUILT_IN, "thread_density", "thread_diameter")
BRAID_KEYS = ("layer_depths", "layers", "lead", "angle", "angle_of", "friction", *OF_THREAD)
ANGLE_KEYS = ("lead", "angle", "angle_of")  # exactly one of them
OF_LAYERS = ("threads", *ANGLE_KEYS, EA, MODULUS, "thread_diameter")  # that layers may share
ALTERNATIVES = (("layers", "layer_depths"), (EA, MODULUS))  # of which there is one
# What may change while a muscle stays the one that was measured: nobody has measured these.
NOT_MEASURED = (*OF_THREAD, *BUILT_IN, "friction", "reference")
# Values beside which another one can be judged alone
ANY_SHAPE = {"inner_diameter": 1, "wall_thickness": 1, "length": 1, "cap_length": 0, "braid": None}


class Muscles:
    """Resolves ``base`` and ``angle_of`` among the muscles of a file.

    Chains of them are walked and not recursed into, so they may be of any length.
    """

    def __init__(
        self,
        source: Source,
        findings: Findings,
        entries: Mapping[str, MuscleEntry],
        materials: Materials,
        modulus: float,
    ) -> None:
        self.source, self.findings, self.entries = source, findings, entries
        self.materials, self.modulus = materials, modulus
        self._complete: dict[str, dict[str, Any]] = {}
        self._built: dict[str, StudiedMuscle] = {}
        self._tried: set[str] = set()
        self._lost: set[str] = set()  # that lead to a muscle that is not there, or in a circle

    def complete(self, name: str) -> dict[str, Any]:
        """The entry of a muscle with what it inherits."""
        if name in self._lost:
            raise AlreadyRefused
        chain = {name: None}  # in order
        last = name
        while last not in self._complete and (base := self.entries[last].base):
            self._check_reference("base", base, chain)
            chain[base] = None
            last = base
        for each in reversed(chain):
            if each not in self._complete:
                own = self.entries[each].model_dump(exclude_none=True)
                base = own.pop("base", None)
                inherited = dict(self._complete[base]) if base else {}
                if any(key in own for key in ANGLE_KEYS):
                    inherited = {k: v for k, v in inherited.items() if k not in ANGLE_KEYS}
                for one, other in ALTERNATIVES:
                    if one in own:
                        inherited.pop(other, None)
                    if other in own:
                        inherited.pop(one, None)
                if own.get("threads") == "none":
                    inherited = {k: v for k, v in inherited.items() if k not in BRAID_KEYS}
                measured = {k: v for k, v in own.items() if k not in NOT_MEASURED}
                if any(value != inherited.get(key) for key, value in measured.items()):
                    inherited.pop("reference", None)  # the maps are of the other muscle
                self._complete[each] = inherited | own
        return self._complete[name]

    def built(self, name: str) -> StudiedMuscle:
        """The muscle of a name, with its materials."""
        chain = {name: None}  # in order
        last = name
        while last not in self._built and (other := self._angle_source(last)):
            self._check_reference("angle_of", other, chain)
            chain[other] = None
            last = other
        for each in reversed(chain):
            if each in self._tried and each not in self._built:
                raise AlreadyRefused
            if each not in self._built:
                self._tried.add(each)
                self._built[each] = self._build(each)
        return self._built[name]

    def _angle_source(self, name: str) -> str | None:
        values = self.complete(name)
        return values.get("angle_of") if values.get("threads") != "none" else None

    def _build(self, name: str) -> StudiedMuscle:
        """The muscle of its complete entry; all that is wrong with it is noted."""
        values = self.complete(name)
        bare = values.get("threads") == "none"
        self._check_keys(name, values, BRAID_KEYS if bare else ())
        made: dict[str, Any] = {"thread": None}
        wound: list[Wound] = []
        parts: dict[str, Callable[[], Any]] = {
            "rubber": lambda: self._rubber(name, values),
            "muscle": lambda: self._muscle(name, values, bare, wound),
        }
        if not bare and "layers" in values:
            parts["thread"] = partial(_stiffest_thread, wound)
        elif not bare:
            parts["thread"] = lambda: self._thread(name, values)
        for part, make in parts.items():
            with self.findings.gathering():
                made[part] = make()
        if not parts.keys() <= made.keys() or (not bare and made["thread"] is None):
            raise AlreadyRefused
        limits = {"thread_strength": values.get("thread_strength"), "room": ""}
        for number, layer in enumerate(wound):
            threads = [layer.layer()], layer.stiffness, layer.thread_diameter
            self._check_fit(name, number, threads)
            limits["room"] = limits["room"] or fit.note(*threads, self.modulus)
        if not bare and not wound:
            every = made["muscle"].layers, made["thread"].stiffness, values.get("thread_diameter")
            self._checked(name, partial(fit.check, *every), {}, {})
            limits["room"] = fit.note(*every, self.modulus)
        material, known = values["material"], self.materials
        if material not in known.installations:
            raise AlreadyRefused
        return StudiedMuscle(
            material=material,
            limits=self._checked(name, partial(replace, known.limits[material]), limits, {}),
            installation=self._checked(
                name,
                partial(replace, known.installations[material]),
                {key: values[key] for key in OF_INSTALLATION if key in values},
                {},
            ),
            reference=tuple(map(self.source.file, values.get("reference", ()))),
            friction=self._friction(name, values, made["muscle"]),
            **made,
        )

    def _friction(self, name: str, values: dict[str, Any], muscle: Muscle) -> Friction | None:
        """Of the crossings of its sleeves."""
        if "friction" not in values:
            return None
        keys = ("muscles", self.source.owner(name, "friction"), "friction")
        friction = self.source.checked(keys, Friction, values["friction"])
        if allowed := no_crossings(muscle.braid):
            raise self._refuse(name, "friction", "a mapping", allowed)
        return friction

    def _rubber(self, name: str, values: dict[str, Any]) -> RubberLaw:
        material = values["material"]
        if material not in self.materials.rubbers:
            if material in self.source.names("materials"):
                raise AlreadyRefused
            allowed = self.source.choices("materials", material)
            raise self._refuse(name, "material", material, allowed)
        return self.materials.rubbers[material]

    def _thread(self, name: str, values: dict[str, Any]) -> Thread:
        """The thread of all layers."""
        stiffness, _, key, allowed = layers.thread(values)
        if key:
            raise self._refuse(name, key, values.get(key), allowed)
        return self._checked(name, Thread, {"stiffness": stiffness}, {}, {"stiffness": EA})

    def _muscle(self, name: str, values: dict[str, Any], bare: bool, wound: list[Wound]) -> Muscle:
        cap_length = CAP_PER_WALL * max(0, values["wall_thickness"])
        shape = {"cap_length": cap_length} | {k: values[k] for k in SHAPE_KEYS if k in values}
        tube = self._checked(name, Muscle, shape | {"braid": None}, ANY_SHAPE)
        for key, allowed in checks.proportions(tube):
            raise self._refuse(name, key, values[key], allowed)
        if "layers" in values and not bare:
            wound += self._layers(name, values, tube)
            return replace(tube, braid=layers.braid(wound))
        return tube if bare else replace(tube, braid=self._braid(name, values))

    def _layers(self, name: str, values: dict[str, Any], tube: Muscle) -> list[Wound]:
        """The layers of the list; all that is wrong with them is noted."""
        common = {key: values[key] for key in OF_LAYERS if key in values}
        if "angle_of" in common:
            other = self._built[values["angle_of"]].muscle.braid
            if other is None:
                raise self._refuse(name, "angle_of", values["angle_of"], "a muscle with a braid")
            common["angle_of"] = other.angle
        refuse = partial(self._refuse_layer, name)
        found = []
        for number, own in enumerate(values["layers"]):
            with self.findings.gathering():
                found.append(layers.resolved(number, own, common, tube, refuse))
        if len(found) < len(values["layers"]):
            raise AlreadyRefused
        held = [number for number, made in enumerate(found) if made.crimp]
        if len(held) > 1:
            said = values["layers"][held[1]]["crimp_radius"]
            allowed = "one sleeve of a muscle on a collar of its own"
            raise refuse(held[1], "crimp_radius", said, allowed)
        for key in common:
            same = (
                ANGLE_KEYS if key in ANGLE_KEYS else (EA, MODULUS) if key in (EA, MODULUS) else ()
            )
            everywhere = all(any(k in own for k in (key, *same)) for own in values["layers"])
            if everywhere and self.source.has(("muscles", name, key)):
                allowed = "not where every layer has its own"
                raise self._refuse(name, key, values[key], allowed)
        return found

    def _check_fit(
        self, name: str, number: int, threads: tuple[list[Layer], float, float | None]
    ) -> None:
        try:
            fit.check(*threads)
        except Refusal as refusal:
            at = refusal.field, refusal.value, refusal.allowed
            raise self._refuse_layer(name, number, *at) from None

    def _refuse_layer(
        self, name: str, number: int, key: str, value: object, allowed: str
    ) -> StudyError:
        """The error for a value of a layer, or for what that has from its muscle."""
        values, owner = self.complete(name), self.source.owner(name, "layers")
        if key in values["layers"][number] or key not in values:
            said = allowed if owner == name else f"in {name}: {allowed}"
            return self.source.refuse(("muscles", owner, "layers", number, key), value, said)
        return self._refuse(name, key, values[key], allowed)

    def _checked(
        self,
        name: str,
        build: Callable[..., T],
        values: dict[str, Any],
        beside: dict[str, Any],
        renamed: Mapping[str, str] | None = None,
    ) -> T:
        """``build(**values)``; what else is wrong, beside values that are right, is noted too."""
        try:
            return build(**values)
        except Refusal as refusal:
            for key in beside if len(values) > 1 else ():
                with self.findings.gathering():
                    self._checked(name, build, beside | {key: values[key]}, {}, renamed)
            key = (renamed or {}).get(refusal.field, refusal.field)
            raise self._refuse(name, key, refusal.value, refusal.allowed) from None

    def _check_keys(self, name: str, values: dict[str, Any], unused: Sequence[str]) -> None:
        needed = ["inner_diameter", "wall_thickness", "length", "material"]
        if "layers" not in values:
            needed.insert(3, "threads")
            needed += [] if unused else ["layer_depths"]
            needed += [] if unused or MODULUS in values else [EA]
        missing = [key for key in needed if key not in values]
        for key in missing:
            self.findings.add(self._refuse(name, key, None, "this key must be given"))
        extra = [key for key in unused if key in values]
        for key in extra:
            self.findings.add(self._refuse(name, key, values[key], "not with threads: none"))
        if "layers" in values and "layer_depths" in values:
            extra.append("layer_depths")
            allowed = "not beside layers, which have a depth each"
            self.findings.add(self._refuse(name, "layer_depths", values["layer_depths"], allowed))
        if missing or extra:
            raise AlreadyRefused

    def _braid(self, name: str, values: dict[str, Any]) -> Braid:
        given = [key for key in ANGLE_KEYS if key in values]
        if len(given) != 1:
            key = given[1] if given else "lead"
            allowed = f"exactly one of {', '.join(ANGLE_KEYS)}"
            raise self._refuse(name, key, values.get(key), allowed)
        diameters = self._layer_diameters(name, values)
        common = {"threads": values["threads"], "layer_diameters": diameters}
        renamed = {"layer_diameters": "layer_depths", "lead": given[0]}
        build: Callable[..., Braid] = Braid
        last = {given[0]: values[given[0]]}
        if given == ["angle"]:
            build = Braid.from_angle
        elif given == ["angle_of"]:
            other = self._built[values["angle_of"]].muscle.braid
            if other is None:
                raise self._refuse(name, "angle_of", values["angle_of"], "a muscle with a braid")
            last = _lead_at_angle_of(other, diameters)
        braid = self._checked(name, build, common | last, {}, renamed)
        for allowed in checks.angle(braid.angle):
            raise self._refuse(name, given[0], values[given[0]], allowed)
        return braid

    def _layer_diameters(self, name: str, values: dict[str, Any]) -> tuple[float, float]:
        """Inner diameter plus twice the depths, in exact decimals."""
        inner, outer = values["layer_depths"]
        if not 0 < inner < outer < values["wall_thickness"]:
            allowed = (
                "two rising depths, more than 0 and less than the wall thickness of "
                f"{values['wall_thickness']:g} (mm)"
            )
            depths = [(d - values["inner_diameter"]) / 2 for d in (inner, outer)]
            if 0 < depths[0] < depths[1] < values["wall_thickness"]:
                allowed += (
                    f"; these may be diameters, whose depths are {depths[0]:g}, {depths[1]:g}"
                )
            raise self._refuse(name, "layer_depths", [inner, outer], allowed)
        d0, d1, d2 = (Decimal(str(v)) for v in (values["inner_diameter"], inner, outer))
        return float(d0 + 2 * d1), float(d0 + 2 * d2)

    def _refuse(self, name: str, key: str, value: object, allowed: str) -> StudyError:
        """The error for a value of a muscle, at the place where it was written."""
        owner = self.source.owner(name, key)
        if owner != name:
            with self.findings.gathering():
                self.built(owner)
            if owner not in self._built and self.findings.found:
                raise AlreadyRefused
            allowed = f"in {name}: {allowed}"
        return self.source.refuse(("muscles", owner, key), value, allowed)

    def _check_reference(self, key: str, other: str, chain: dict[str, None]) -> None:
        """Refuse what the last muscle of a chain names if it is not there, or in the chain."""
        *_, last = chain
        group = self.source.groups.get(other)
        if group is not None and last not in group:
            if not group:
                raise AlreadyRefused
            allowed = f"one muscle; of {other} there are {choices(other, group)}"
            raise self.source.refuse(("muscles", last, key), other, allowed)
        if other in self.entries and other not in self._lost and other not in chain:
            return
        known = self.source.names("muscles")
        refused = other in self._lost or (other in known and other not in self.entries)
        self._lost.update(chain)
        if refused:
            raise AlreadyRefused
        allowed = self.source.choices("muscles", other)
        if other in chain:
            names = [*chain]
            circle = [*names[names.index(other) :], other]
            said = circle if len(circle) <= LISTED else [*circle[:LISTED], "...", other]
            allowed = "no circle: " + " -> ".join(said)
        raise self.source.refuse(("muscles", last, key), other, allowed)


def _stiffest_thread(wound: Sequence[Wound]) -> Thread:
    """The thread whose stiffness those of the layers are shares of."""
    if not wound:
        raise AlreadyRefused
    return Thread(stiffness=max(layer.stiffness for layer in wound))


def _lead_at_angle_of(other: AnyBraid, diameters: tuple[float, float]) -> dict[str, float]:
    """The lead that gives two layers the angle of another braid."""
    if isinstance(other, Braid):
        return {"lead": other.lead * sum(diameters) / sum(other.layer_diameters)}
    return {"lead": math.pi * sum(diameters) / 2 / math.tan(other.angle)}
