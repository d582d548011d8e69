"""From a study to its cases: pure, no file is read or written.

A scene asks for curves. Curves of equal content (muscle, materials, model, effects, numerics, path
and held value) are one case, with the stops of all scenes that ask for it; so every state is
solved once, however many figures show it.
"""

import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product
from pathlib import Path
from typing import Any

from geometry import section
from geometry.grading import UnbuildableMesh
from geometry.muscle import Muscle
from solver.case import Case, canonical, digest
from solver.load_path import ZERO_FORCE, LoadPath, PathKind
from solver.models import MODELS
from workflow.plan import model_choice
from workflow.plan.judged import of_scene
from workflow.plan.mesh_error import twice_as_fine
from workflow.plan.promise import Promise
from workflow.plan.sheet_stops import stops_to
from workflow.study import in_time
from workflow.study.contents import Study, Variant
from workflow.study.errors import Findings, StudyError
from workflow.study.schema import HELD_KEY, MEASURED, SHEET, SWEPT_KEY, Scene
from workflow.study.study import load

FIELDS = {"stress", "deformed_shape"}
WITHIN = "_within_"  # in the name of a variant, after its own, while its climb has not ended
NOT_PROVED = "not proved"  # how what is known of a curve begins whose tolerance is not


@dataclass(frozen=True, order=True)
class Place:
    """Where a curve stands in the dataset.

    Attributes
    ----------
    kind : of its path, where the group does not say it: in time
    scene : that it is of, if it is in time
    period : of its cycles [s], 0 if there are none
    """

    group: str
    muscle: str
    model: str
    variant: str
    held: float
    kind: str = ""
    scene: str = ""
    period: float = 0.0

    def __str__(self) -> str:
        """As in messages: ``dmsp20 solid isobaric 0.3 MPa``."""
        held = PathKind(self.kind or self.group).held.text(self.held)
        variant = "" if self.variant == "default" else f" {self.variant}"
        period = f", {self.period:g} s" if self.period else ""
        scene = f" ({self.scene}{period})" if self.scene else ""
        return f"{self.muscle} {self.model}{variant} {self.group} {held}{scene}"


def mesh_file(case: Case) -> str | None:
    """File name of the mesh of a case, None for a model without."""
    spec = case.mesh_spec()
    return f"{digest(spec)}.{MODELS[case.model].suffix}" if spec else None


@dataclass(frozen=True)
class PlannedCase:
    """A case, the places that it fills and the scenes that ask for it; both sorted.

    With a ``promise`` it is the first case of a climb; which one fills the places is known when the
    climb has ended (workflow/data/settled.py). Without a place it is there for the error of another
    one, which is called ``of``.
    """

    case: Case
    places: tuple[Place, ...]
    scenes: tuple[str, ...]
    promise: Promise | None = None
    of: str = ""

    @cached_property
    def key(self) -> str:
        """Of the case, or of the climb."""
        return self.promise.key if self.promise else self.case.key

    @property
    def label(self) -> str:
        """What a user calls this case."""
        if not self.places:
            return f"{self.of}, twice as fine"
        others = len(self.places) - 1
        return f"{self.places[0]}{f' (and {others} more)' if others else ''}"

    @cached_property
    def mesh(self) -> str | None:
        """File name of the mesh, None for a model without and of a climb, which makes its own."""
        return None if self.promise else mesh_file(self.case)


@dataclass(frozen=True)
class Kept:
    """What a climb has promised of a curve.

    Attributes
    ----------
    tolerance : that was asked for, a share of the largest value along the curve
    error : of model and mesh together, which it is not expected to exceed
    by : how that is known, and whether it proves the tolerance
    """

    tolerance: float
    error: float
    by: str


@dataclass(frozen=True)
class Plan:
    """What there is to do.

    Attributes
    ----------
    cases : by key, sorted by place
    meshes : specification by file name
    scenes : of every scene that has cases, the key of the case at each of its places
    shown : specification of the whole muscles that scenes without cases show, by name
    finer : by case the one on a mesh twice as fine by which its errors are measured
    meshes_by : by case that a climb has come to, the keys of its curve on the next finer and the
        next coarser mesh of its model, where the climb has had them; else empty
    kept : what climbs that have ended have promised, by place
    """

    study: Study
    cases: dict[str, PlannedCase]
    meshes: dict[str, str]
    scenes: dict[str, dict[Place, str]]
    shown: dict[str, str]
    finer: dict[str, str] = field(default_factory=dict)
    meshes_by: dict[str, tuple[str, str]] = field(default_factory=dict)
    kept: dict[Place, Kept] = field(default_factory=dict)

    @property
    def promises(self) -> dict[str, Promise]:
        """Climbs by key."""
        return {key: asked.promise for key, asked in self.cases.items() if asked.promise}

    def cases_of(self, scene: str) -> dict[str, PlannedCase]:
        """The cases of a scene by key, and those by which their errors are measured."""
        own = {*self.scenes.get(scene, {}).values()}
        more = {self.finer[key] for key in own if key in self.finer}
        return {key: self.cases[key] for key in sorted(own | more)}

    def digest(self, scene: str | None = None) -> str:
        """Digest of all that a scene (None: the dataset) takes from the study but its cases."""
        names = self.scenes if scene is None else [scene]
        places = sorted({entry for name in names for entry in self.scenes.get(name, {}).items()})
        muscles = {place.muscle for place, _ in places}
        asked = None if scene is None else self.study.scenes[scene]
        muscles.update(asked.muscles if asked else ())
        made_of = [
            (name, self.study.muscles[name], self.study.muscles[name].files())
            for name in sorted(muscles)
        ]
        return digest(repr((places, made_of, asked)))


@dataclass
class _Wish:
    """What scenes want of one curve."""

    case: Case
    promise: Promise | None = None
    stops: set[float] = field(default_factory=set)
    fields_at: set[float] = field(default_factory=set)
    frequencies: set[float] = field(default_factory=set)
    zero_force: bool = False
    places: set[Place] = field(default_factory=set)
    scenes: set[str] = field(default_factory=set)

    def add(self, scene: str, place: Place, case: Case) -> None:
        self.stops.update(case.path.stops)
        self.fields_at.update(case.fields_at)
        self.frequencies.update(case.frequencies)
        self.zero_force |= case.path.zero_force
        self.places.add(place)
        self.scenes.add(scene)

    def planned(self) -> PlannedCase:
        path = self.case.path
        stops = path.stops if path.by_way else tuple(sorted(self.stops))
        case = self.case  # most often that of its only scene
        found: dict[str, Any] = {
            name: tuple(sorted(getattr(self, name))) for name in ("fields_at", "frequencies")
        }
        known = path.stops, path.zero_force, case.fields_at, case.frequencies
        if (stops, self.zero_force, *found.values()) != known:
            path = replace(path, stops=stops, zero_force=self.zero_force)
            case = replace(case, path=path, **found)
        promise = self.promise
        if promise is not None:
            promise = promise.with_stops(path.stops, zero_force=path.zero_force)
        return PlannedCase(case, tuple(sorted(self.places)), tuple(sorted(self.scenes)), promise)


def read(path: Path | str, *checks: Callable[[Study], Iterable[StudyError]]) -> Plan:
    """The plan of a study file.

    Parameters
    ----------
    checks : what else to look at, for a caller that knows more than a plan does

    Raises
    ------
    StudyError
        With all that is wrong with the file, in its entries and in the cases that they make.
    """
    findings = Findings()
    study = load(path, findings)
    made = plan(study, findings)
    for check in checks:
        findings.no_more(check(study))
    findings.say()
    return made


def plan(study: Study, findings: Findings | None = None) -> Plan:
    """The cases of a study; errors are noted in ``findings``, if that is given.

    Raises
    ------
    StudyError
        If scenes ask for cases that cannot be solved.
    """
    found = Findings() if findings is None else findings
    wishes: dict[str, _Wish] = {}
    places: dict[str, dict[Place, str]] = {}
    by_place: dict[Place, str] = {}
    for name, scene in study.scenes.items():
        if not study.muscles.keys() >= {*scene.muscles}:
            continue  # one of them was refused
        if not study.variants.keys() >= {*scene.variants}:
            continue
        with found.gathering():
            for place, case, promise in _curves(study, name, scene, found):
                curve = _identity(case, promise)
                if by_place.setdefault(place, curve) != curve:
                    allowed = f"names that no scene's effects or mesh make: {place} is two curves"
                    keys = ("scenes", name, "variants")
                    raise study.source.refuse(keys, list(scene.variants), allowed)
                wishes.setdefault(curve, _Wish(case, promise)).add(name, place, case)
                places.setdefault(name, {})[place] = curve
    if findings is None:
        found.say()
    planned = {curve: wish.planned() for curve, wish in wishes.items()}
    ordered = sorted(planned.values(), key=lambda entry: entry.places)
    cases = {entry.key: entry for entry in ordered}
    finer = dict(_finer(study, ordered))
    for entry in finer.values():
        cases.setdefault(entry.key, entry)
    return Plan(
        study=study,
        cases=cases,
        meshes={e.mesh: spec for e in cases.values() if e.mesh and (spec := e.case.mesh_spec())},
        finer={key: entry.key for key, entry in finer.items()},
        scenes={
            name: {place: planned[curve].key for place, curve in sorted(found.items())}
            for name, found in places.items()
        },
        shown={
            name: _whole(study.muscles[name].muscle)
            for scene in study.scenes.values()
            if scene.path is None
            for name in scene.muscles
            if name in study.muscles
        },
    )


def _finer(study: Study, planned: Iterable[PlannedCase]) -> Iterator[tuple[str, PlannedCase]]:
    """By case the one by which its errors are measured, where a scene asks for that."""
    for entry in planned:
        asking = [name for name in entry.scenes if study.scenes[name].errors == MEASURED]
        finer = twice_as_fine(entry.case) if asking and not entry.promise else None
        if finer is not None:
            yield entry.key, PlannedCase(finer, (), tuple(asking), of=entry.label)


def _whole(muscle: Muscle) -> str:
    """Specification of a muscle in three dimensions, for ``python -m geometry``."""
    return json.dumps({"kind": "whole", "muscle": muscle.as_dict()}, sort_keys=True)


def _curves(
    study: Study, name: str, scene: Scene, findings: Findings
) -> Iterator[tuple[Place, Case, Promise | None]]:
    """What one scene asks for; curves that cannot be solved are noted."""
    if scene.path is None:
        return
    if rungs := model_choice.promised(study, scene):
        yield from _climbs(study, name, scene, rungs, findings)
        return
    choice = model_choice.choose(study, scene)
    _check_models(study, name, scene, choice)
    for muscle in scene.muscles:
        for model in choice.models:
            for label, variant in choice.variants.items():
                for held in scene.held:
                    for place, path in _paths(study, name, scene, muscle, model, label, held):
                        with findings.gathering():
                            yield place, _case(study, name, scene, place, variant, path), None


def _climbs(
    study: Study,
    name: str,
    scene: Scene,
    rungs: Mapping[str, tuple[model_choice.Rung, ...]],
    findings: Findings,
) -> Iterator[tuple[Place, Case, Promise]]:
    """The curves of a scene that leaves its model open, on every rung that they may climb."""
    tolerance = model_choice.TOLERANCE if scene.tolerance is None else scene.tolerance
    judged = of_scene(scene.quantities)
    for muscle, variant, held in product(scene.muscles, scene.variants, scene.held):
        with findings.gathering():
            cases, labels = {}, {}
            for rung in rungs[muscle]:
                label, made = model_choice.on_rung(study, scene, variant, rung)
                for place, path in _paths(study, name, scene, muscle, rung.model, label, held):
                    cases[rung.name] = _case(study, name, scene, place, made, path)
                    labels[rung.name] = place
            promise = Promise(tolerance, judged, cases)
            start = promise.start
            more = "".join(f"_{each}" for each in judged[1:])
            of_no_mesh = replace(rungs[muscle][0], mesh="default")
            own, _ = model_choice.on_rung(study, scene, variant, of_no_mesh)
            pending = f"{own}{WITHIN}{tolerance:g}{more}"
            yield replace(labels[start], variant=pending), cases[start], promise


def _paths(
    study: Study, name: str, scene: Scene, muscle: str, model: str, label: str, held: float
) -> Iterator[tuple[Place, LoadPath]]:
    """Paths of a scene at a held value: one, or in time one for every period."""
    assert scene.path is not None
    if scene.in_time:
        for period, path in in_time.paths(scene, held).items():
            yield Place(scene.path, muscle, model, label, held, scene.kind, name, period), path
        return
    place = Place(scene.path, muscle, model, label, held)
    has_zero = MODELS[model].threshold or place.group == "isobaric"
    stops, wanted = scene.swept, set(scene.quantities)
    if SHEET in wanted:
        stops = tuple(sorted({*stops, *stops_to(stops[-1])}))
    values = {
        "kind": scene.path,
        "held": held,
        "stops": stops,
        "zero_force": has_zero and bool({*ZERO_FORCE, SHEET} & wanted),
    }
    named = {"held": HELD_KEY[scene.path], "stops": SWEPT_KEY[scene.path]}
    yield place, study.source.checked(("scenes", name), LoadPath, values, named)


def _check_models(study: Study, name: str, scene: Scene, choice: model_choice.Choice) -> None:
    """Refuse effects that a named model, or every model, cannot have."""
    found = {model: model_choice.refusal(model, scene) for model in choice.models}
    if not choice.models:
        found = {e.rung.model: e.refused for e in choice.estimates}
    reasons = [f"{model} {reason}" for model, reason in found.items() if reason]
    if reasons:
        key = "effects" if scene.effects else "quantities" if scene.quantities else "models"
        allowed = f"what one model can have; here {'; '.join(reasons)}"
        raise study.source.refuse(("scenes", name, key), getattr(scene, key), allowed)


def _case(
    study: Study, name: str, scene: Scene, place: Place, variant: Variant, path: LoadPath
) -> Case:
    """The case that a scene asks for at a place."""
    muscle, effects = study.muscles[place.muscle], variant.effects
    if scene.effects:
        effects = model_choice.readable(place.model, effects)
    keys, checked = ("scenes", name), study.source.checked
    case = checked(
        keys,
        Case,
        {
            "muscle": muscle.muscle,
            "rubber": muscle.rubber,
            "thread": muscle.thread,
            "path": path,
            "model": place.model,
            "effects": effects,
            "numerics": variant.numerics,
            "fields_at": _fields_at(scene, place, path),
            "memory": None if scene.effects.get("memory") == "off" else muscle.memory,
            "friction": None if scene.effects.get("friction") == "off" else muscle.friction,
            "frequencies": scene.frequency or (),
        },
        {"model": "models", "stops": SWEPT_KEY[scene.kind]},
    )
    _check_mesh(study, place, variant)
    return case


def _fields_at(scene: Scene, place: Place, path: LoadPath) -> tuple[float, ...]:
    """Stops at which fields are recorded: all that the scene names; of a sheet the last."""
    if FIELDS & set(scene.quantities):
        return tuple(sorted(set(path.stops))) if scene.in_time else scene.swept
    wanted = SHEET in scene.quantities and bool(MODELS[place.model].fields)
    return path.stops[-1:] if wanted else ()


# What a study has written if it has not written the setting of the mesh that cannot be met
MESH_BY = {
    "cap_step": ("cap_length", "wall_thickness"),
    "growth": ("inner_diameter",),
    "body_step": ("length",),
}


def _check_mesh(study: Study, place: Place, variant: Variant) -> None:
    """Refuse a muscle that cannot be meshed so; named is the key that was written."""
    muscle = study.muscles[place.muscle].muscle
    kind = MODELS[place.model].mesh or ""
    try:
        if kind == "section":
            numerics, end = variant.numerics, variant.effects.end
            section.stations(muscle, numerics.section, end, numerics.clamp.ramp)
        elif kind == "meridian":
            variant.numerics.meridian.half_length_stations(muscle)
    except UnbuildableMesh as refusal:
        source, field = study.source, refusal.field
        names = [name for name in study.variants if place.variant.startswith(name)]
        places = [("variants", name, "numerics", kind, field) for name in names]
        written = [keys for keys in (*places, ("numerics", kind, field)) if source.has(keys)]
        if written:
            raise source.refuse(written[0], refusal.value, refusal.allowed) from None
        for key in MESH_BY.get(field, (field,)):
            keys = ("muscles", source.owner(place.muscle, key), key)
            if source.has(keys):
                break
        allowed = refusal.allowed
        if key != field:
            allowed = f"{allowed}, at a {field} of {refusal.value:g}"
        raise source.refuse(keys, getattr(muscle, key), allowed) from None


def _identity(case: Case, promise: Promise | None = None) -> str:
    """What a case, or a climb, has in common with all that can be merged with it."""
    if promise is not None:
        cases = [_identity(each) for each in promise.rungs.values()]
        return repr((promise.tolerance, promise.judged, cases))
    values = case.as_dict()
    values.pop("fields_at", None)
    if values.pop("frequencies", None):
        del values["memory"]
    stops = case.path.stops if case.path.by_way else ()
    values["path"] |= {"stops": stops, "zero_force": False}
    return canonical(values)
