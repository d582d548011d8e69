"""How large the forces of a scene are beside those of the curves that were measured.

An error is judged against the largest force of its own curve. A scene that begins at 10 % of
contraction has smaller forces than a curve from 0, so the same error in newtons is a larger share.
"""

from solver import net
from workflow.plan.effect_costs import MeasuredEffects
from workflow.study.contents import StudiedMuscle, Study
from workflow.study.schema import Scene

EQ_1 = 2624.0  # N/MPa, of the muscles that were measured, at their initial length
WALL = 2 * 20  # mm2, thickness times diameter of the wall of the normal condition
LEAST = 0.05  # share of Eq. (1) that a force is at least taken for
EVERYTHING = "all but pressure on the net"


def error_factor(study: Study, scene: Scene, measured: MeasuredEffects, regime: str) -> float:
    """By how much more an error weighs in a scene than in the analysis of effects; 1 under a load.

    Errors in newtons are taken to go with the size of Eq. (1) and, at constant pressure, with the
    pressure; the largest force is Eq. (1) less what rubber and threads have taken from it in the
    study.
    """
    assert scene.path is not None  # a scene without has no curves
    effect = measured[regime, scene.kind, EVERYTHING]
    if scene.kind == "isotonic":
        return 1.0
    found = []
    for name in scene.muscles:
        muscle = study.muscles[name]
        for held in scene.held:
            if scene.kind == "isobaric":
                contraction, pressure = min(scene.swept, key=abs), held
                loads = held / effect.held
            else:
                contraction, pressure, loads = held, max(scene.swept), 1.0
            error = effect.largest * loads * _size(muscle)
            found.append(
                error / _force(muscle, pressure, contraction, effect.force * effect.largest)
            )
    return max(found)


def _size(muscle: StudiedMuscle) -> float:
    """Of Eq. (1), as a multiple of the muscles that were measured; 1 for a bare tube."""
    return _eq_1(muscle, 1.0, 0.0) / EQ_1 if muscle.thread else 1.0


def _eq_1(muscle: StudiedMuscle, pressure: float, contraction: float) -> float:
    return abs(float(net.force(muscle.muscle, pressure, contraction)))


def _force(muscle: StudiedMuscle, pressure: float, contraction: float, taken: float) -> float:
    """About the largest force [N]: of what is ``taken`` by 15 % of contraction, 0.4 are at 0."""
    if not muscle.thread or not pressure:
        return EQ_1 * max(pressure, 0.1)
    ideal = _eq_1(muscle, pressure, contraction)
    wall = muscle.muscle.wall_thickness * muscle.muscle.inner_diameter / WALL
    if muscle.rubber.shear_modulus < 0.2:
        wall /= 1.5  # measured at 3 mm
    share = 0.4 + 0.6 * min(abs(contraction) / 0.15, 1.0)
    return max(ideal - share * taken * wall, LEAST * ideal)
