"""What the paper states in numbers of its figures, and of which muscle: marks beside its curves."""

import math
from collections.abc import Iterable

from geometry.braid import Braid
from workflow.study.contents import StudiedMuscle

MEAN_DEVIATION = -0.099  # Fig. 4: mean of its finite elements from the manufacturer's map
THRESHOLD, AT_CONTRACTION = 0.15, 0.1  # Fig. 6: MPa, at that contraction
EXCESS = 0.156  # Fig. 7: equivalent over inflated diameter, mean above the threshold pressure
RATIO, AT_RATIO, AT_PRESSURE = 34.5, 0.2, 0.3  # Fig. 11: at that contraction and pressure [MPa]
WIDE = 40.0  # mm, inner diameter of the muscle that Fig. 11 compares
SHAPE = (20.0, 2.0, 300.0)  # mm: inner diameter, wall, length of the normal condition
BRAID = (144.0, 60, 20.6, 21.8)  # lead [mm], threads, layer diameters [mm]
RUBBER = {"c10": 0.345083, "c01": 0.083805}  # MPa


def is_normal(studied: StudiedMuscle) -> bool:
    """Whether a muscle is the paper's normal condition, whatever a study calls it.

    The stiffness of its threads may be any, as the paper does not give their area.
    """
    return _is(studied, SHAPE[0])


def is_wide(studied: StudiedMuscle) -> bool:
    """Whether it is the paper's muscle of 40 mm, with as many threads at the same angle."""
    return _is(studied, WIDE)


def _is(studied: StudiedMuscle, diameter: float) -> bool:
    muscle, rubber = studied.muscle, studied.rubber
    if not isinstance(muscle.braid, Braid):
        return False
    lead, threads, *layers = BRAID
    wider = diameter - SHAPE[0]
    layers = [layer + wider for layer in layers]
    wanted = (
        *(diameter, *SHAPE[1:]),
        *(lead * sum(layers) / sum(BRAID[2:]), threads, *layers),
    )
    found = (
        *(muscle.inner_diameter, muscle.wall_thickness, muscle.length),
        *(muscle.braid.lead, muscle.braid.threads, *muscle.braid.layer_diameters),
    )
    values = rubber.values()
    same_law = values.keys() == RUBBER.keys()
    return same_law and _close([*found, *values.values()], [*wanted, *RUBBER.values()])


def _close(found: Iterable[float], wanted: Iterable[float]) -> bool:
    return all(math.isclose(a, b, rel_tol=1e-9) for a, b in zip(found, wanted, strict=True))
