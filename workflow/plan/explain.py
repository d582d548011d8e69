"""What ``muscle explain`` says of every scene: its wishes, what it gets, and why."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from math import isfinite, isnan, nan
from typing import Any

from geometry.readable import plain
from solver.case import Case
from solver.effects import EFFECTS
from solver.load_path import PathKind
from solver.models import MODELS
from workflow.plan import effect_costs, like_effects, like_muscles, model_choice, worth
from workflow.plan.judged import FOLLOWS, ZERO, of_scene
from workflow.plan.like_muscles import COVERAGE, Guess
from workflow.plan.model_choice import Choice, Estimate
from workflow.plan.plan import Place, Plan, PlannedCase
from workflow.plan.promise import Promise
from workflow.plan.worth import Known, Measured
from workflow.study.schema import HELD_KEY, SWEPT_KEY, Scene

Outcomes = Callable[[str], Mapping[str, Any] | None]  # how a climb has ended, by its key


def lines(
    plan: Plan, outcome: Outcomes = lambda _: None, known: Known = lambda _: None
) -> Iterator[str]:
    """The whole text, line by line.

    ``outcome`` is asked for climbs that have ended, ``known`` for the records that there are.
    """
    yield f"effects: {effect_costs.origin()}; of like muscles: {like_effects.origin()}"
    if plan.promises:
        yield f"like muscles: {like_muscles.origin()}"
    for name, places in plan.scenes.items():
        scene = plan.study.scenes[name]
        choice = model_choice.choose(plan.study, scene)
        cases: dict[str, list[Case]] = {}
        for place, key in places.items():
            cases.setdefault(place.model, []).append(plan.cases[key].case)
        yield ""
        yield f"{name}: {_counted(len(set(places.values())), 'case')}"
        yield f"  wants    {_wish(scene, choice)}"
        if scene.in_time:
            yield from _memories(plan, scene)
            yield from _not_known_in_time(scene)
        climbs = {key: plan.cases[key] for key in places.values() if key in plan.promises}
        if climbs:
            for key, climbed in climbs.items():
                yield from _climb(climbed, outcome(key))
            yield from _worth(plan, scene, places, outcome, known)
            continue
        yield f"  regimes  {', '.join(model_choice.regimes(plan.study, scene))}"
        yield from _models(scene, choice, model_choice.estimates(plan.study, scene))
        for model, own in cases.items():
            yield from _effects(model, own, scene)
        if not scene.in_time:
            yield from _worth(plan, scene, places, outcome, known)
        yield from _cases(plan, name, places)


def _wish(scene: Scene, choice: Choice) -> str:
    assert scene.path is not None
    swept = scene.swept
    usual = PathKind(scene.kind).follows
    held = ", ".join(f"{value:g}" for value in scene.held)
    given = "" if scene.tolerance else " (if not said otherwise)"
    forced = "".join(f", {effect} {state}" for effect, state in sorted(scene.effects.items()))
    return (
        f"{', '.join(scene.quantities) or usual}; {scene.path}, {HELD_KEY[scene.kind]} {held}, "
        f"{SWEPT_KEY[scene.kind]} {swept[0]:g} to {swept[-1]:g} {_course(scene)}; "
        f"within {100 * choice.tolerance:g} %{given}{forced}"
    )


def _course(scene: Scene) -> str:
    """How the swept control goes."""
    if scene.cycle is not None:
        asked = scene.cycle
        wave = "table" if asked.table else asked.wave
        times = asked.period or (asked.table or ((0.0, 0.0),))[-1][:1]
        periods = ", ".join(f"{time:g}" for time in times)
        return (
            f"and back ({wave}), {_counted(asked.cycles, 'cycle')} of {periods} s in "
            f"{asked.samples} steps, {asked.start} at first"
        )
    if scene.transient is not None:
        given = scene.transient
        valve = " through a valve" if given.valve else ""
        return (
            f"of the supply{valve}, {given.duration:g} s in steps of {given.step:g} s, "
            f"mass {given.mass:g} kg, {given.start} at first"
        )
    return f"in {_stops(len(scene.swept))}"


def _memories(plan: Plan, scene: Scene) -> Iterator[str]:
    """What the rubbers of a scene in time remember."""
    for name in scene.muscles:
        memory = plan.study.muscles[name].memory
        if memory is None:
            said = "none; its material has no memory, so without mass and valve nothing is lost"
        else:
            said = (
                f"{len(memory.times)} branches of {memory.times[0]:g} to {memory.times[-1]:g} s, "
                f"{plain(100 * sum(memory.shares), 3)} % of the long-term stiffness"
            )
        if scene.effects.get("memory") == "off":
            said = "left out by the scene"
        yield f"  memory   {name}: {said}"
        friction = plan.study.muscles[name].friction
        if friction is not None and scene.effects.get("friction") != "off":
            yield (
                f"  friction {name}: coefficient {friction.coefficient:g}, of crossings with a "
                f"radius of {friction.contact:g} mm"
            )


def _not_known_in_time(scene: Scene) -> Iterator[str]:
    """What nothing is promised of."""
    yield (
        "  in time  nothing is promised: how far models and meshes are off in widths of loops, "
        "rates and damping was not measured"
    )
    more = "samples" if scene.cycle is not None else "steps"
    yield (
        f"{'':11}a curve whose steps are too long for its energies to balance is unbalanced; how "
        f"far its numbers change with more {more} only more {more} say"
    )


def _models(scene: Scene, choice: Choice, estimates: Sequence[Estimate]) -> Iterator[str]:
    """The ladder with expected errors and costs; what was taken is marked."""
    chosen = choice.chosen.rung.name if choice.chosen else None
    how = "cheapest that is exact enough" if chosen else "named by the scene"
    if choice.chosen and not choice.chosen.error <= choice.tolerance:
        how = "the best there is"
    if {"stress", "deformed_shape"} & set(scene.quantities):
        how += "; errors are those of the force, fields are not measured"
    how += "; errors are those of the paper's muscle"
    if scene.in_time:
        how += "; errors and seconds are those of the curve at rest"
    yield f"  models   {how}"
    for estimate in estimates:
        rung = estimate.rung
        taken = rung.name == chosen or (chosen is None and rung.name in choice.models)
        yield f"    {'>' if taken else ' '} {rung.name:15} {_estimate(estimate)}"
    weighed = {estimate.rung.model for estimate in estimates}
    for model in choice.models:
        if model not in weighed:
            yield f"    > {model:15} not weighed"


def _estimate(estimate: Estimate) -> str:
    if estimate.refused:
        return estimate.refused
    if isnan(estimate.error):
        return "not measured"
    lost = "; some states are lost or not measured" if estimate.missing else ""
    return f"error {plain(100 * estimate.error, 2)} %, {plain(estimate.seconds, 2)} s a curve{lost}"


def _climb(asked: PlannedCase, end: Mapping[str, Any] | None) -> Iterator[str]:
    """What like muscles say of every rung; and what was measured, if the climb has ended."""
    promise = asked.promise
    assert promise is not None
    called = {FOLLOWS: asked.case.path.kind.follows, ZERO: asked.case.path.kind.zero_force}
    judged = ", ".join(called.get(name, name).replace("_", " ") for name in promise.judged)
    yield (
        f"  climb    {asked.label}: {judged} within {100 * promise.tolerance:g} % of the largest "
        "value along the curve, of every state that a refined solid has"
    )
    for name, known in promise.guesses.items():
        mark = ">" if name == (end["rung"] if end else promise.start) else " "
        lacks = ", ".join(_left_out(promise, name))
        without = f"; leaves out {lacks}" if lacks else ""
        said = _not_guessed(promise, name, called) if known is None else _guessed(known)
        yield f"    {mark} {name:15} {said}{without}"
        if end and (found := end["verdicts"][name])["by"].startswith("measured"):
            yield f"      {'':15} {found['by']}: {_share(found['error'])}"
    if end is None:
        yield f"    begins on {promise.start}, and climbs until it is proved"
        return
    held = "is proved" if end["holds"] else "is the best there is, and not proved"
    error = "" if isnan(end["error"]) else f"{_share(end['error'])}, "
    yield f"    {end['rung']} {held}: {error}{end['by']}"
    tried = ", ".join(f"{name} at {_counted(count, 'state')}" for name, count in end["tried"])
    cost = sum(end["seconds"].values())
    spent = "what that took is not known" if isnan(cost) else f"{plain(cost, 2)} s of the processor"
    yield f"    solved {tried or 'nothing, its record was there'}; {spent}"


def _not_guessed(promise: Promise, name: str, called: Mapping[str, str]) -> str:
    """Why nothing is said of the error of a rung."""
    case = promise.rungs[name]
    unknown = [each for each in promise.judged if like_muscles.guess(case, name, (each,)) is None]
    if FOLLOWS in unknown:
        return "no muscles of the table are like it"
    names = ", ".join(called.get(each, each).replace("_", " ") for each in unknown)
    return f"of like muscles the error of {names} is not known"


def _left_out(promise: Promise, name: str) -> list[str]:
    """Effects that better models of a curve carry and this one does not."""
    carried = set(promise.rungs[name].active_effects)
    names = list(promise.rungs)
    better = {e for n in names[names.index(name) :] for e in promise.rungs[n].active_effects}
    return [effect for effect in EFFECTS if effect in better - carried]


def _guessed(known: Guess) -> str:
    lost = f", states lost on {100 * known.lost:.0f} % of those nearest" if known.lost else ""
    return (
        f"error {_share(known.median)}, {100 * COVERAGE:g} % of {known.count} like muscles at most "
        f"{_share(known.high)}{lost}; {plain(known.seconds, 2)} s a curve"
    )


def _share(error: float) -> str:
    return (
        f"{plain(100 * error, 2)} %" if isfinite(error) else "not known" if isnan(error) else "lost"
    )


def _worth(
    plan: Plan, scene: Scene, places: Mapping[Place, str], outcome: Outcomes, known: Known
) -> Iterator[str]:
    """What leaving out each effect is worth on these curves: by like muscles, and measured here."""
    curves: dict[tuple[str, float], dict[str, Case]] = {}
    carried: set[str] = set()
    for place, key in places.items():
        asked, end = plan.cases[key], outcome(key)
        rungs = asked.promise.rungs if asked.promise else {"": asked.case}
        curves.setdefault((place.muscle, place.held), {}).update({c.key: c for c in rungs.values()})
        taken = (end["rung"] if end else asked.promise.start) if asked.promise else ""
        carried.update(rungs[taken].active_effects)
    more: dict[tuple[str, float], list[str]] = {curve: [] for curve in curves}
    for key, asked in plan.cases.items():  # of these curves, in all scenes
        end = outcome(key) if asked.promise else {"seconds": [key]}
        for place in asked.places:
            if end and place.group == scene.kind and (place.muscle, place.held) in more:
                more[place.muscle, place.held].extend(end["seconds"])
    judged = [name for name in of_scene(scene.quantities) if name != ZERO]
    follows = PathKind(scene.kind).follows
    about = " or ".join(follows if name == FOLLOWS else name.replace("_", " ") for name in judged)
    most = f", the most of {len(curves)} curves" if len(curves) > 1 else ""
    yield f"  effects  change of {about} by leaving one out, of the largest{most}; > is carried"
    cases = [list(of.values()) for of in curves.values()]
    found = [
        worth.measured(list(of.values()), known, judged, more[curve])
        for curve, of in curves.items()
    ]
    for effect in dict.fromkeys(e for each in cases for e in worth.effects_of(each[0])):
        guesses = [like_effects.guess(each[0], effect, judged) for each in cases]
        measured = [each[effect] for each in found if effect in each]
        mark = ">" if effect in carried else " "
        said = _guessed_effect(guesses, effect, scene.kind, follows)
        yield f"    {mark} {effect:17} {said}; {_measured_effect(measured, effect, len(cases))}"


def _guessed_effect(
    guesses: Sequence[like_effects.Guess | None], effect: str, path: str, follows: str
) -> str:
    """By like muscles, of the curve where it is most."""
    there = [each for each in guesses if each is not None]
    if not there:
        of_paper = effect_costs.load().get(("normal", path, effect))
        value = getattr(of_paper, follows, nan)
        more = "" if isnan(value) else f" (on the paper's muscle {_share(value)})"
        return f"not known of like muscles{more}"
    most = max(there, key=lambda each: each.high)
    where = "" if len(there) == len(guesses) else f", known on {len(there)} of them"
    return (
        f"median {_share(most.median)} of {most.count} like muscles, {100 * COVERAGE:g} % of them "
        f"at most {_share(most.high)}{where}"
    )


def _measured_effect(measured: Sequence[Measured], effect: str, curves: int) -> str:
    """By records of this curve, of the one where it is most."""
    if not measured:
        return "not measured here"
    most = max(measured, key=lambda each: each.change)
    others = [other for other in most.effects if other != effect]
    together = f" with {', '.join(others)}" if others else ""
    where = f" on {len(measured)} of them" if curves > len(measured) else ""
    lost = f", {_counted(most.lost, 'state')} lost" if most.lost else ""
    by = most.by[0] if most.by[0] == most.by[1] else f"{most.by[1]} against {most.by[0]}"
    return f"measured{where}{together} {_share(most.change)} ({by}{lost})"


def _effects(model: str, cases: Sequence[Case], scene: Scene) -> Iterator[str]:
    """Which effects are on in a model, in any of some cases, and why the others are off."""
    on = list(dict.fromkeys(effect for case in cases for effect in case.active_effects))
    carried = [name for name in EFFECTS if name in MODELS[model].effects]
    off = [
        f"{name} ({'by the scene' if name in scene.effects else 'by its switch'})"
        for name in carried
        if name not in on
    ]
    yield f"  {model:16} on: {', '.join(on) or 'none'}"
    if off:
        yield f"{'':18} off: {', '.join(off)}"


def _cases(plan: Plan, name: str, places: dict[Place, str]) -> Iterator[str]:
    for place, key in places.items():
        case = plan.cases[key]
        others = [scene for scene in case.scenes if scene != name]
        stops = _stops(len(case.case.path.stops))
        yield f"  {key}  {place}, {stops}" + (f"; also {', '.join(others)}" if others else "")


def _stops(count: int) -> str:
    return _counted(count, "stop")


def _counted(count: int, what: str) -> str:
    """``1 case``, ``2 cases``."""
    return f"{count} {what}{'s' * (count != 1)}"
