"""A study file: read, checked as a whole, and turned into muscles, variants and scenes.

Nothing is read from a study file anywhere else. Every muscle is built
(workflow/study/muscles.py), so that what cannot be built is refused before anything runs.
"""

from collections.abc import Collection, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from geometry.refusal import Refusal
from solver.effects import Effects
from solver.memory import Memory
from solver.numerics import KINDS, Numerics, Spread
from solver.rubber import LAWS
from solver.rubber.rubber_law import LEAST_KAPPA, RubberLaw
from workflow.study import checks, design, figure_needs, in_time, maps, sweep, units
from workflow.study.contents import StudiedMuscle, Study, Variant
from workflow.study.errors import AlreadyRefused, Findings, StudyError, choices, shown
from workflow.study.folders import DEFAULT
from workflow.study.installation import Installation
from workflow.study.judged_quantities import VARIABLES
from workflow.study.limits import Limits
from workflow.study.muscles import Muscles
from workflow.study.schema import (
    QUANTITIES,
    CalibrationEntry,
    MaterialEntry,
    Scene,
    StudyFile,
    VariantEntry,
)
from workflow.study.source import Keys, Source

SETTINGS = ("study", "batches")  # of --config
MOST_BATCHES = 10**6


def given_settings(given: Mapping[str, object]) -> tuple[str, int]:
    """The study file of a run and its number of batches, from Snakemake's ``--config``.

    Raises
    ------
    StudyError
        If another key is given, or what is no path.
    """
    for key in given:
        if key not in SETTINGS:
            raise StudyError(f"--config {key}: no such key\n  allowed: {choices(key, SETTINGS)}")
    study = given.get("study", str(DEFAULT))
    if not isinstance(study, str):
        allowed = f"the path of a study file (of one that is called so: ./{study})"
        raise StudyError(f"--config study = {shown(study)} is refused\n  allowed: {allowed}")
    batches = given.get("batches", 1)
    if type(batches) is not int or not 1 <= batches <= MOST_BATCHES:
        allowed = f"a whole number from 1 to {MOST_BATCHES}"
        raise StudyError(f"--config batches = {shown(batches)} is refused\n  allowed: {allowed}")
    # one that begins with a dash would be an option
    return f"./{study}" if study.startswith("-") else study, batches


def load(path: Path | str, findings: Findings | None = None, also: Collection[str] = ()) -> Study:
    """Read a study file; ``also`` names muscles of the library to take beside those it names.

    With ``findings`` errors are noted there, and the study has what can be used in spite of them.

    Raises
    ------
    StudyError
        With all errors, each naming file, line, key, value and what is allowed.
    """
    return _of(Source.read(Path(path), also), findings)


@cache
def load_library() -> Study:
    """The muscles of the library (workflow/study/library.py)."""
    return _of(Source.of_library(), None)


def _of(source: Source, findings: Findings | None) -> Study:
    """The study of a source."""
    found = Findings() if findings is None else findings
    source, file = sweep.spread(source, source.validated(found), found)
    rubbers: dict[str, RubberLaw] = {}
    limits: dict[str, Limits] = {}
    memories: dict[str, Memory] = {}
    weights: dict[str, Installation] = {}
    for name, material in file.materials.items():
        with found.gathering():
            if material.memory is not None:
                keys = ("materials", name, "memory")
                memories[name] = in_time.memory(source, keys, material.memory)
        with found.gathering():
            rubbers[name] = _rubber(source, found, name, material)
        with found.gathering():
            values = material.model_dump(include={"stretch_limit", "fitted_range"})
            limits[name] = source.checked(("materials", name), Limits, values)
            values = material.model_dump(include={"density"})
            weights[name] = source.checked(("materials", name), Installation, values)
    variants: dict[str, Variant] = {}
    for name, variant in ({"default": VariantEntry()} | file.variants).items():
        with found.gathering():
            variants[name] = _variant(source, found, file, name, variant)
    spread = variants["default"].numerics.spread if "default" in variants else Spread()
    of_materials = rubbers, limits, weights
    resolved = Muscles(source, found, file.muscles, *of_materials, spread.modulus)
    muscles: dict[str, StudiedMuscle] = {}
    for name in [name for name in file.muscles if name not in source.groups]:
        with found.gathering():
            made = resolved.built(name)
            if made.material not in memories and file.materials[made.material].memory is not None:
                raise AlreadyRefused
            muscles[name] = replace(made, memory=memories.get(made.material))
    study = Study(
        source=source,
        muscles=muscles,
        variants=variants,
        scenes={name: _with_shown(scene) for name, scene in file.scenes.items()},
        calibration=file.calibration,
        rubbers=rubbers,
        design=file.design,
        maps=file.map,
        pairs=file.pair,
        promise=file.promise,
        wall_time=file.limits.wall_time,
        memory=file.limits.memory,
        warnings=tuple(checks.unusual(source, file, muscles)),
    )
    study = replace(study, calibration={n: _fit(study, n) for n in study.calibration})
    study = replace(
        study,
        scenes={n: s for n, s in study.scenes.items() if found.no_more(checks.scene(study, n))},
        calibration={
            n: c
            for n, c in study.calibration.items()
            if found.no_more(checks.calibration(study, n))
        },
        design={n: d for n, d in study.design.items() if found.no_more(design.check(study, n))},
        maps={n: m for n, m in study.maps.items() if found.no_more(maps.check(study, n))},
        pairs={n: p for n, p in study.pairs.items() if found.no_more(maps.check_pair(study, n))},
    )
    if findings is None:
        found.say()
    return study


def _with_shown(scene: Scene) -> Scene:
    """A scene whose models are to be chosen, for what its figure shows as well."""
    if scene.figure is None or scene.models is not None or scene.path is None or scene.in_time:
        return scene
    axes = figure_needs.axes(scene)
    wanted = {*scene.quantities, *(name for name, shown in VARIABLES.items() if shown in axes)}
    return scene.model_copy(update={"quantities": tuple(q for q in QUANTITIES if q in wanted)})


def _fit(study: Study, name: str) -> CalibrationEntry:
    """A calibration with its forces: where none are named, the first map of the muscle itself."""
    entry = study.calibration[name]
    made = study.muscles.get(entry.muscle)
    if entry.reference is not None:
        return entry.model_copy(update={"reference": study.source.file(entry.reference)})
    if made is None or not made.reference:
        return entry
    return entry.model_copy(update={"reference": made.reference[0]})


def _rubber(source: Source, found: Findings, name: str, entry: MaterialEntry) -> RubberLaw:
    """The rubber of an entry; a bulk modulus that was left out is not to blame."""
    keys = ("materials", name)
    unread = {"stretch_limit", "fitted_range", "density", "law", "memory"}
    law, values = LAWS[entry.law], entry.model_dump(exclude=unread)
    refused = list(law.out_of_range(values))
    for refusal in refused:
        found.add(source.refuse((*keys, refusal.field), refusal.value, refusal.allowed))
    if refused:
        raise AlreadyRefused
    try:
        return law(**values)
    except Refusal as refusal:
        blamed, allowed = refusal.field, refusal.allowed
        names = [parameter.name for parameter in law.parameters()]
        unusual = [key for key in names if units.guess(key, values[key])]
        if blamed == "kappa" and (unusual or not source.has((*keys, "kappa"))):
            blamed = unusual[0] if unusual else _stiffest(law, values)
            kappa = values["kappa"]
            allowed = (
                f"an initial shear modulus up to {kappa / LEAST_KAPPA:g} MPa "
                f"at a kappa of {kappa:g} MPa"
            )
        raise source.refuse((*keys, blamed), values[blamed], allowed) from None


def _stiffest(law: type[RubberLaw], values: Mapping[str, Any]) -> str:
    """The parameter that has the largest stress."""
    stress = {p.name: np.max(values[p.name]) for p in law.parameters() if p.unit == "MPa"}
    return max(stress, key=stress.__getitem__)


def _variant(
    source: Source, found: Findings, file: StudyFile, name: str, entry: VariantEntry
) -> Variant:
    """Defaults, then the study's numerics, then the variant's own."""
    parts = {}
    for kind, build in KINDS.items():
        values: dict[str, Any] = {}
        places: dict[str, Keys] = {}
        for keys, entries in (
            (("numerics", kind), file.numerics),
            (("variants", name, "numerics", kind), entry.numerics),
        ):
            part = getattr(entries, kind)
            given = part.model_dump(exclude_none=True) if part else {}
            values |= given
            places |= dict.fromkeys(given, keys)
        for key in values:
            with found.gathering():
                source.checked(places[key], build, {key: values[key]})
        try:
            parts[kind] = build(**values)
        except Refusal:
            continue
    if parts.keys() != KINDS.keys():
        raise AlreadyRefused
    effects = Effects(**dict(entry.effects))
    return Variant(effects=effects, numerics=Numerics(**parts))
