"""A study file: read, checked as a whole, and turned into muscles, variants and scenes.

Nothing is read from a study file anywhere else. Every material and every muscle is built
(materials.py, muscles.py), so that what cannot be built is refused before anything runs.
"""

from collections.abc import Collection, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

from geometry.refusal import Refusal
from solver.effects import Effects
from solver.numerics import KINDS, Numerics, Spread
from workflow.study import checks, design, figure_needs, maps, materials, sweep
from workflow.study.contents import StudiedMuscle, Study, Variant
from workflow.study.errors import AlreadyRefused, Findings, StudyError, choices, shown
from workflow.study.folders import DEFAULT
from workflow.study.judged_quantities import VARIABLES
from workflow.study.muscles import Muscles
from workflow.study.schema import (
    QUANTITIES,
    CalibrationEntry,
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
    made_of = materials.read(source, found, file.materials)
    variants: dict[str, Variant] = {}
    for name, variant in ({"default": VariantEntry()} | file.variants).items():
        with found.gathering():
            variants[name] = _variant(source, found, file, name, variant)
    spread = variants["default"].numerics.spread if "default" in variants else Spread()
    resolved = Muscles(source, found, file.muscles, made_of, spread.modulus)
    muscles: dict[str, StudiedMuscle] = {}
    for name in [name for name in file.muscles if name not in source.groups]:
        with found.gathering():
            made = resolved.built(name)
            memory = made_of.memories.get(made.material)
            if memory is None and file.materials[made.material].memory is not None:
                raise AlreadyRefused
            muscles[name] = replace(made, memory=memory)
    study = Study(
        source=source,
        muscles=muscles,
        variants=variants,
        scenes={name: _with_shown(scene) for name, scene in file.scenes.items()},
        calibration=file.calibration,
        rubbers=made_of.rubbers,
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
