"""A hypercube of any muscles: tubes in sleeves with gaps, from 1 mm of bore, of five laws.

Sizes, threads and paths go as those of the other hypercube, with stiffnesses of threads by the
square of the size; meshes are those that a study has by default. A sleeve whose threads have no
room, or would have to stretch by more than a tenth to bear the pressure, is drawn again: it holds
no tube.
"""

import math

import numpy as np
from scipy.stats import qmc

from geometry.muscle import LayeredBraid, Muscle
from solver import rubber
from solver.numerics import Spread
from solver.rubber.rubber_law import RubberLaw
from workflow.analyses.random_muscles import Ranges, numbers
from workflow.study import fit

SEED = 20260914
LIMITS: Ranges = {
    "inner_diameter": (1, 50, True),  # mm
    "wall": (0.06, 0.35, False),  # of the diameter
    "length": (5, 40, False),  # of the diameter
    "gap": (0, 0.3, False),  # of the outer radius
    "angle": (12, 52, False),  # degrees
    "threads": (8, 60, False),  # of a family
    "stiffness": (0.1, 20, True),  # N, of a thread, by the square of the diameter in mm
    "modulus": (0.05, 2, True),  # MPa, initial shear modulus
    "law": (0, 5, False),  # which, by LAWS; within one how much it stiffens
    "pressure": (0.01, 0.8, False),  # MPa
    "path": (0, 5, False),  # 0 to 3 isobaric, to 4 isometric, to 5 isotonic
}
MOST_STRAIN = 0.1  # of threads that bear all of the pressure
Sample = dict[str, float]


def points(count: int) -> np.ndarray:
    """Points of the unit cube, the same every time."""
    return np.asarray(qmc.LatinHypercube(len(LIMITS), seed=SEED).random(count))


def values(point: np.ndarray) -> Sample:
    """Numbers of a point."""
    return numbers(LIMITS, point)


def muscle(sample: Sample) -> Muscle | None:
    """A tube in a sleeve; None where the threads have no room, or bear the pressure in no way."""
    diameter, threads = sample["inner_diameter"], round(sample["threads"])
    wall = sample["wall"] * diameter
    radius = (diameter / 2 + wall) * (1 + sample["gap"])
    angle = math.radians(sample["angle"])
    width = fit.diameter(stiffness(sample), Spread().modulus)
    if 2 * math.pi * radius * math.cos(angle) / threads <= width:
        return None
    # both families bear p R around the muscle: n EA s sin^2 a / (pi R cos a) = p R
    tension = sample["pressure"] * math.pi * radius**2 * math.cos(angle) / math.sin(angle) ** 2
    if tension > MOST_STRAIN * threads * stiffness(sample):
        return None
    braid = LayeredBraid(
        kinds=("sleeve",),
        layer_diameters=(2 * radius,),
        leads=(2 * math.pi * radius / math.tan(angle),),
        threads=(threads,),
        senses=(0,),
        stiffness_shares=(1.0,),
    )
    length = sample["length"] * diameter
    return Muscle(
        inner_diameter=diameter,
        wall_thickness=wall,
        length=length,
        braid=braid,
        cap_length=4 * wall,
    )


def stiffness(sample: Sample) -> float:
    """EA of a thread [N]."""
    return sample["stiffness"] * sample["inner_diameter"] ** 2


def law(sample: Sample) -> RubberLaw:
    """A rubber of a modulus at rest, by one of five laws with a shape."""
    mu, (shape, which) = sample["modulus"], math.modf(min(sample["law"], 4.999999))
    lock = 3 + 2 * shape  # chain stretch at which rubber locks
    ratio = 1 + sum(
        factor / lock ** (2 * k)
        for k, factor in enumerate((3 / 5, 99 / 175, 513 / 875, 42039 / 67375), start=1)
    )
    made = (
        {"law": "neo_hooke", "c10": mu / 2},
        {"law": "yeoh", "c1": mu / 2, "c2": -0.02 * mu * shape, "c3": 0.002 * mu},
        {
            "law": "ogden",
            "convention": "textbook",
            "mu": [mu * 2 * 0.95 / 1.3, mu * 2 * 0.002 / 5, -mu * 2 * 0.048 * shape / 2],
            "alpha": [1.3, 5, -2],
        },
        {"law": "gent", "mu": mu, "jm": 10 + 80 * shape},
        {"law": "arruda_boyce", "mu": mu / ratio, "lambda_m": lock},
    )[int(which)]
    return rubber.from_dict(made)
