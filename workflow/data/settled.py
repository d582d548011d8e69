"""Plans in which climbs have ended: the record of the rung that each has come to fills its places.

results/promises/<key>.json is written by the job of a climb (workflow/run/climbs.py); its keys are
those of ``Outcome`` (workflow/plan/promise.py), ``seconds`` of the processor by record, and
``whole``, the rungs of which the climb had all states: those on other meshes of the model that it
took say how far that one's mesh is off.
"""

import json
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from workflow.plan.model_choice import RUNGS
from workflow.plan.plan import NOT_PROVED, WITHIN, Kept, Place, Plan, PlannedCase
from workflow.plan.promise import Promise
from workflow.study.folders import PROMISES


def outcome(key: str) -> dict[str, Any] | None:
    """How a climb has ended; None if it has not."""
    try:
        return dict(json.loads((PROMISES / f"{key}.json").read_text()))
    except (OSError, ValueError):
        return None


def settled(plan: Plan) -> Plan:
    """The plan with cases in place of climbs that have ended; others stay as they are."""
    found = {key: end for key in plan.promises if (end := outcome(key))}
    if not found:
        return plan
    cases = {key: asked for key, asked in plan.cases.items() if key not in found}
    scenes = {
        name: {place: key for place, key in places.items() if key not in found}
        for name, places in plan.scenes.items()
    }
    taken = {place for asked in cases.values() for place in asked.places}
    meshes: dict[str, tuple[str, str]] = {}
    kept: dict[Place, Kept] = {}
    for key, end in found.items():
        asked = plan.cases[key]
        assert asked.promise is not None
        case = asked.promise.rungs[end["rung"]]
        moved = {place: _moved(place, end["rung"], taken) for place in asked.places}
        taken |= set(moved.values())
        kept |= dict.fromkeys(moved.values(), _kept(asked.promise, end))
        finer, coarser = _meshes_by(asked.promise, end)
        known = meshes.get(case.key, ("", ""))
        meshes[case.key] = finer or known[0], coarser or known[1]
        own = PlannedCase(case, tuple(sorted(moved.values())), asked.scenes)
        cases[case.key] = _joined(cases.get(case.key), own)
        for name in asked.scenes:
            of_scene = plan.scenes[name]
            scenes[name] |= {moved[p]: case.key for p, of in of_scene.items() if of == key}
    return replace(
        plan,
        cases=dict(sorted(cases.items(), key=lambda entry: entry[1].places)),
        scenes={name: dict(sorted(places.items())) for name, places in scenes.items()},
        meshes_by={key: by for key, by in sorted(meshes.items()) if any(by)},
        kept=kept,
    )


def _kept(promise: Promise, end: Mapping[str, Any]) -> Kept:
    by = end["by"] if end["holds"] else f"{NOT_PROVED}; {end['by']}"
    return Kept(promise.tolerance, end["error"], by)


def _meshes_by(promise: Promise, end: Mapping[str, Any]) -> tuple[str, str]:
    """Keys of a curve on the next finer and coarser mesh of its model, of those that are known."""
    model, whole = promise.rungs[end["rung"]].model, end.get("whole", ())
    meshes = [name for name, case in promise.rungs.items() if case.model == model]
    at = meshes.index(end["rung"])
    beside = ["", *meshes, ""][at : at + 3 : 2]  # coarser, finer
    coarser, finer = (promise.rungs[n].key if n in whole else "" for n in beside)
    return finer, coarser


def _moved(place: Place, rung: str, taken: set[Place]) -> Place:
    """Where a curve stands when its model is known: as if a scene had named it.

    Where another curve stands there already it keeps its tolerance in the name of its variant.
    """
    found = RUNGS[rung]
    variant = place.variant.rpartition(WITHIN)[0]
    variant += f"_{found.mesh}" if found.mesh != "default" else ""
    moved = replace(place, model=found.model, variant=variant)
    return moved if moved not in taken else replace(moved, variant=place.variant)


def _joined(there: PlannedCase | None, own: PlannedCase) -> PlannedCase:
    """Two that are the same case."""
    if there is None:
        return own
    places = tuple(sorted({*there.places, *own.places}))
    return replace(there, places=places, scenes=tuple(sorted({*there.scenes, *own.scenes})))
