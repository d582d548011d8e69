"""How wide friction makes the loop of a muscle whose threads lie in a sleeve, by a formula.

Where threads of both layers cross they are pressed on each other and turn. With a friction mu and
the radius r_c of a contact, half the width of the loop of force is about

    2/3 mu r_c p 2 pi r lz 2 cos(a0) / sin(a)

It is no result of a model: embedded threads, as those of the paper's muscle, do not slip.
"""

import math

from geometry.muscle import Muscle

FRICTION, CONTACTS = 0.2, (0.2, 0.4)  # 1, mm
MEASURED = 12.7  # N, half width of a 10 mm muscle (Hunt 2017), 15.6 kPa


def width(
    muscle: Muscle, pressure: float, contraction: float, radius: float, contact: float
) -> float:
    """Of the whole loop [N]; ``radius`` is that of the net [mm]."""
    braid = muscle.braid
    assert braid is not None
    stretch = 1 - contraction
    turned = math.atan(2 * math.pi * radius / (braid.lead * stretch))
    around = 2 * math.pi * radius * stretch * 2 * math.cos(braid.angle) / math.sin(turned)
    return 2 * 2 / 3 * FRICTION * contact * pressure * around
