"""Which model, effects and mesh a scene gets: the cheapest that is exact enough for it.

Pure: no files but the measured effects and errors (effect_costs.csv, mesh_error.csv,
like_muscles.csv) are read, and nothing is solved. The models form a ladder; going down it leaves
out one effect after the other, and the error of a step is what leaving that effect out has changed
in the analysis of effects, in the regimes that the scene touches. A scene that names its ``models``
gets those; its ``effects`` hold for it all the same.

The mesh alone may take a quarter of the tolerance (mesh_error.csv), so the mesh is the coarsest
that does; the default meshes are those for the default tolerance.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from math import inf, isnan
from typing import Any

from geometry.braid import Kind
from solver.effects import EFFECTS, KINDS, Effects, active
from solver.load_path import PathKind
from solver.models import MODELS
from solver.models.model import BRAIDS
from solver.numerics import Numerics
from solver.refusal import UnsolvableCase
from workflow.plan import like_muscles
from workflow.plan.effect_costs import MESHES, MeasuredEffect, MeasuredEffects, load
from workflow.plan.force_scale import error_factor
from workflow.plan.mesh_error import share_of
from workflow.study.contents import Study, Variant
from workflow.study.schema import QUANTITIES, Scene

TOLERANCE = 0.01  # share of the curve's largest value, where a scene names none
SHORTEST = 20 / 300  # diameter / length of the muscles that were measured: caps act in proportion
CAPS = ("end_caps", "cap_geometry")
OF_GAP = 0.2  # error of the membrane by gap of a sleeve / outer radius: 4.5 of 98 N at 0.24
OF_MESH = 0.25  # share of the tolerance that the mesh may take
ORDER = 3  # a mesh twice as fine leaves a third of the difference, or less (second order)


@dataclass(frozen=True)
class Rung:
    """A model on a mesh; ``step`` is what it leaves out of ``above``, as in effect_costs.csv."""

    name: str
    model: str
    mesh: str
    above: str | None
    step: str
    only_for: str = ""  # effect that must be asked for


def _rungs() -> Iterator[Rung]:
    """The weighed models, cheapest first; the fullest on coarser and finer meshes too."""
    for name, model in MODELS.items():
        if not model.lacks:
            continue
        if model.fuller:
            yield Rung(name, name, "default", model.fuller, model.lacks, model.only_for)
            continue
        finer = f"{name}, finer"
        yield Rung(f"{name}, coarser", name, "coarser", finer, f"coarse {model.lacks}")
        yield Rung(name, name, "default", finer, model.lacks)
        yield Rung(finer, name, "finer", None, model.lacks)


RUNGS = {rung.name: rung for rung in _rungs()}
NO_CLIMB = {"stress", "deformed_shape", "sheet", "dynamic_stiffness"}
DISCRETE = "discrete_threads"
SMEARED = "isobaric", DISCRETE  # path and effect: measured at constant pressure only


@dataclass(frozen=True)
class Estimate:
    """What a rung would give a scene."""

    rung: Rung
    error: float  # expected, share of the largest value; NaN if never measured
    mesh_error: float  # what of it is the mesh's, as the analysis of accuracy has found; NaN if not
    seconds: float  # of one curve of the analysis of effects
    missing: bool  # whether it loses states somewhere in these regimes
    refused: str = ""  # why it cannot serve, whatever the error


@dataclass(frozen=True)
class Choice:
    """What a scene gets.

    Attributes
    ----------
    models : names, one if chosen
    variants : by the label they have in the dataset
    estimates, chosen : none where the scene names its models
    """

    models: tuple[str, ...]
    variants: dict[str, Variant]
    tolerance: float
    estimates: tuple[Estimate, ...]
    chosen: Estimate | None


def choose(study: Study, scene: Scene, measured: MeasuredEffects | None = None) -> Choice:
    """The models and variants of a scene with a path; what it names itself is not weighed."""
    tolerance = TOLERANCE if scene.tolerance is None else scene.tolerance
    weighed: tuple[Estimate, ...] = ()
    chosen = None
    if scene.models is None:
        weighed = estimates(study, scene, measured)
        able = [e for e in weighed if not e.refused]
        good = [e for e in able if not e.missing and is_enough(e, tolerance)]
        best = sorted(able, key=lambda e: (e.missing, isnan(e.error), e.error))
        chosen = next(iter(good or best), None)
    models = scene.models or ((chosen.rung.model,) if chosen else ())
    variants = {
        label: made
        for name in scene.variants
        for label, made in [
            _variant(study.variants[name], name, scene, chosen.rung.mesh if chosen else "default")
        ]
    }
    return Choice(models, variants, tolerance, weighed, chosen)


def estimates(
    study: Study, scene: Scene, measured: MeasuredEffects | None = None
) -> tuple[Estimate, ...]:
    """What every weighed model would give a scene."""
    measured = load() if measured is None else measured
    touched = tuple(regimes(study, scene))
    return tuple(_estimate(study, scene, rung, touched, measured) for rung in RUNGS.values())


def steps(rung: str) -> list[str]:
    """What a rung leaves out of the ones above it, and the mesh of the fullest."""
    found, at = [], RUNGS.get(rung)
    while at is not None:
        found.append(at.step)
        at = RUNGS[at.above] if at.above else None
    return found


def smearing(study: Study, scene: Scene) -> float:
    """What smeared threads are expected to change, as a share of the largest value."""
    measured = load()
    return max(
        _of_smearing(study, scene, measured, regime, error_factor(study, scene, measured, regime))
        for regime in regimes(study, scene)
    )


def is_enough(estimate: Estimate, tolerance: float) -> bool:
    """Whether a rung is exact enough, and its mesh fine enough."""
    return estimate.error <= tolerance and estimate.mesh_error <= OF_MESH * tolerance


def promised(study: Study, scene: Scene) -> dict[str, tuple[Rung, ...]]:
    """Of a scene that leaves its model open the rungs that each muscle may climb, cheapest first.

    It may climb those whose errors on muscles like it are known (workflow/plan/like_muscles.py).
    Empty where there is no climb: models are named, curves are in time, fields or sheets are asked
    for, an effect is forced that one rung alone has. There the choice is ``choose``'s.
    """
    if scene.models is not None or scene.path is None or scene.in_time or scene.frequency:
        return {}
    if NO_CLIMB & set(scene.quantities):
        return {}
    known = like_muscles.rungs()
    asked = [
        rung for rung in RUNGS.values() if rung.name in known and not refusal(rung.model, scene)
    ]
    found = {name: tuple(r for r in asked if _may_be(study, name, r)) for name in scene.muscles}
    return found if all(len(rungs) > 1 for rungs in found.values()) else {}


def _may_be(study: Study, name: str, rung: Rung) -> bool:
    """Whether a rung can be of a muscle at all."""
    made, model = study.muscles[name], MODELS[rung.model]
    if made.muscle.braid is None:
        return not model.needs_braid
    if model.frame and not made.rubber.has_frame(model.frame):
        return False
    return not BRAIDS[model.braids](made.muscle.braid)


def on_rung(study: Study, scene: Scene, name: str, rung: Rung) -> tuple[str, Variant]:
    """A variant of a scene on a rung, and its label in the dataset."""
    return _variant(study.variants[name], name, scene, rung.mesh)


def switched(effects: Effects, wanted: Mapping[str, str]) -> Effects:
    """Some effects with others of the vocabulary forced on or off, as far as switches do that."""
    moves: dict[str, Any] = {}
    for name, state in wanted.items():
        effect = EFFECTS[name]
        is_off = getattr(effects, effect.switch) in effect.off
        if state == "off" and not is_off:
            moves[effect.switch] = effect.off[0]
        if state == "on" and is_off:
            moves[effect.switch] = next(v for v in KINDS[effect.switch] if v not in effect.off)
    return replace(effects, **moves)


def readable(model: str, effects: Effects) -> Effects:
    """The same effects with the switches that a model does not read as they are by default."""
    own = {name: getattr(effects, name) for name in MODELS[model].switches}
    return Effects(**own)


def regimes(study: Study, scene: Scene) -> Iterator[str]:
    """The regimes of the analysis of effects that a scene touches."""
    found = [study.muscles[name] for name in scene.muscles]
    soft = [m.rubber.shear_modulus < 0.2 for m in found]
    stiff = [m.thread is not None and m.thread.stiffness > 2000 for m in found]
    if not all(s or t for s, t in zip(soft, stiff, strict=True)):
        yield "normal"
    if any(soft):
        yield "thick silicone"
    if any(stiff):
        yield "stiff threads"
    assert scene.path is not None
    lowest = min(scene.held) if scene.kind == "isobaric" else max(scene.swept)
    if lowest < 0.15:
        yield "low pressure"
    shortest = {
        "isobaric": max(scene.swept) > 0.15,
        "isometric": scene.kind == "isometric" and max(scene.held) > 0.15,
        "isotonic": scene.kind == "isotonic" and min(scene.held) < 100,
    }[scene.kind]
    if shortest:
        yield "high contraction"


def _estimate(
    study: Study, scene: Scene, rung: Rung, touched: tuple[str, ...], measured: MeasuredEffects
) -> Estimate:
    assert scene.path is not None
    refused = refusal(rung.model, scene)
    bare = any(study.muscles[name].thread is None for name in scene.muscles)
    if bare and MODELS[rung.model].needs_braid:
        refused = refused or "needs a braid"
    for name in scene.muscles:
        braid = study.muscles[name].muscle.braid
        instead = BRAIDS[MODELS[rung.model].braids](braid) if braid else ""
        refused = refused or (f"is of no braid as that of {name}" if instead else "")
    if rung.only_for and scene.effects.get(rung.only_for) != "on":
        refused = refused or f"only where {rung.only_for} is on"
    errors, seconds, missing = [], [], False
    for regime in touched:
        error, lost = _error(study, scene, rung, regime, measured)
        errors.append(error)
        missing |= lost
        if rung.only_for:
            seconds.append(measured[(regime, *SMEARED)].seconds_with)
            continue
        last = measured[regime, scene.kind, rung.step]
        seconds.append(last.seconds_without if rung.above else last.seconds_with)
    mesh_error = share_of(rung.model, Effects(), replace(Numerics(), **MESHES[rung.mesh]))
    return Estimate(rung, max(errors), mesh_error, max(seconds), missing, refused)


def _error(
    study: Study, scene: Scene, rung: Rung, regime: str, measured: MeasuredEffects
) -> tuple[float, bool]:
    """Expected error of a rung: the sum of the steps down to it; and whether states are lost."""
    assert scene.path is not None
    factor = error_factor(study, scene, measured, regime)
    total = _of_smearing(study, scene, measured, regime, factor) if not rung.only_for else 0.0
    missing = False
    gap = max(_gap(study, name) for name in scene.muscles)
    at: Rung | None = rung
    while at is not None:
        effect = measured[regime, scene.kind, at.step]
        change = _change(study, scene, effect, factor)
        if at.above is None:
            total += change / ORDER
        else:
            total += change
        if at.step == "cap_geometry":
            total += OF_GAP * gap
        missing |= at.above is not None and effect.missing > 0
        at = RUNGS[at.above] if at.above else None
    return total, missing


def _of_smearing(
    study: Study, scene: Scene, measured: MeasuredEffects, regime: str, factor: float
) -> float:
    """What smeared threads change; of a contraction the same share as of the force."""
    if not any(study.muscles[name].thread for name in scene.muscles):
        return 0.0
    effect = measured[(regime, *SMEARED)]
    return _change(study, scene, replace(effect, contraction=effect.force), factor)


def _change(study: Study, scene: Scene, effect: MeasuredEffect, factor: float) -> float:
    """What leaving out an effect changes in a scene; ``factor`` is by force_scale.py."""
    if effect.effect in scene.effects:  # forced on or off: no error
        return 0.0
    change = max(
        (
            value * (factor if name == "force" else 1)
            for name in _judged(scene)
            if not isnan(value := getattr(effect, name))
        ),
        default=inf,
    )
    if effect.effect in CAPS:
        change *= max(_stoutness(study, name) for name in scene.muscles)
    return change


def _judged(scene: Scene) -> list[str]:
    """Columns of effect_costs.csv that tell the error of what a scene wants."""
    assert scene.path is not None
    names = [PathKind(scene.kind).follows]
    if {"inner_diameter", "outer_diameter", "volume"} & set(scene.quantities):
        names.append("diameter")
    if "threshold_pressure" in scene.quantities:
        names.append("threshold")
    return names


def _gap(study: Study, name: str) -> float:
    """Widest gap between tube and sleeve, as a share of the tube's outer radius."""
    tube = study.muscles[name].muscle
    gaps = (layer.radius - layer.carrier for layer in tube.layers if layer.kind is Kind.SLEEVE)
    return max([0.0, *gaps]) / tube.outer_radius


def _stoutness(study: Study, muscle: str) -> float:
    """Diameter to length, as a multiple of that of the muscles that were measured."""
    made = study.muscles[muscle].muscle
    return made.inner_diameter / made.length / SHORTEST


def refusal(model: str, scene: Scene) -> str:
    """Why a model cannot give what a scene wants; empty if it can."""
    for quantity in scene.quantities:
        if model not in QUANTITIES[quantity]:
            return f"gives no {quantity}"
    if scene.in_time and not MODELS[model].in_time:
        return "knows no time"
    try:
        effects = readable(model, switched(Effects(), scene.switches))
    except UnsolvableCase as error:
        return str(error)
    before = set(active(model, Effects(), braided=True))
    now = set(active(model, effects, braided=True))
    for name, state in scene.switches.items():
        if (name in now) != (state == "on"):
            return f"carries no {name}" if state == "on" else f"cannot leave out {name}"
    lost = before - now - set(scene.switches)
    if lost:
        return f"would leave out {', '.join(sorted(lost))} too"
    return ""


def _variant(variant: Variant, name: str, scene: Scene, mesh: str) -> tuple[str, Variant]:
    """A variant with what scene and planner add to it, and its label in the dataset."""
    label, effects, numerics = name, switched(variant.effects, scene.switches), variant.numerics
    if scene.effects:
        label += "".join(f"_{effect}_{state}" for effect, state in sorted(scene.effects.items()))
    if mesh != "default":
        label += f"_{mesh}"
        numerics = replace(numerics, **MESHES[mesh])
    return label, Variant(effects=effects, numerics=numerics)
