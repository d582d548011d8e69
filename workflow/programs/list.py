"""List what a study has: its muscles, its scenes, and the analyses that can be asked for."""

import argparse
import math
from collections import Counter
from collections.abc import Iterator

from geometry.muscle import LayeredBraid
from solver.rubber import default
from workflow.analyses.registry import ANALYSES
from workflow.data import records
from workflow.plan.plan import Plan
from workflow.programs import add_study, settled_plan_of
from workflow.study import library
from workflow.study.contents import StudiedMuscle
from workflow.study.study import load_library


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What it is told."""
    add_study(parser)


def run(given: argparse.Namespace) -> int:
    """Print it."""
    for line in lines(settled_plan_of(given)):
        print(line)
    return 0


def lines(plan: Plan) -> Iterator[str]:
    """The text, line by line."""
    yield "muscles"
    for name, muscle in plan.study.muscles.items():
        yield f"  {name:24} {_described(muscle)}"
    for section in library.SECTIONS:
        yield f"{section} of the library, which any study may name ({library.file(section)})"
        made = load_library().muscles if section == "muscles" else {}
        for name in library.names(section):
            known = library.about(section, name)
            what = _described(made[name]) if made else _material(name)
            yield f"  {name:24} {what}; {known['source']}"
            if "assumed" in known:
                yield f"  {'':24} assumed: {known['assumed']}"
    yield "scenes"
    for name, scene in plan.study.scenes.items():
        yield f"  {name:24} {scene.path or 'shows muscles'}; {_state(plan, name)}"
    yield "analyses (targets of run)"
    for each in ANALYSES.values():
        yield f"  {each.target or each.name}"


def _described(muscle: StudiedMuscle) -> str:
    shape, braid = muscle.muscle, muscle.muscle.braid
    tube = f"bore {shape.inner_diameter:g} mm, wall {shape.wall_thickness:g}, L {shape.length:g}"
    net = "no threads"
    if isinstance(braid, LayeredBraid):
        net = ", ".join(
            f"{kind} of {threads} threads at {math.degrees(angle):.3g} degrees"
            for kind, threads, angle in zip(
                braid.kinds, braid.threads, braid.layer_angles, strict=True
            )
        )
    elif braid:
        net = f"{braid.threads} threads a layer, lead {braid.lead:g} mm"
    return f"{tube}, {net}, {muscle.material}"


def _material(name: str) -> str:
    """A rubber of the library by its law, and how far to trust it."""
    law = library.values("materials", name).get("law", default().law())
    return f"{law}, mark {library.about('materials', name)['mark']}"


def _state(plan: Plan, scene: str) -> str:
    """How many of a scene's cases have which status."""
    keys = sorted(set(plan.scenes.get(scene, {}).values()))
    if not keys:
        return "no cases"
    found = Counter(records.status(key, plan.cases[key].label) for key in keys)
    return ", ".join(f"{count} {status}" for status, count in sorted(found.items()))
