"""A membrane of finite wall thickness along its meridian, with end caps."""

import math

import numpy as np
from numpy.typing import NDArray

from solver.case import Case
from solver.models.model import Model

STEEPEST = 0.3  # z' of the inner line; below it the force is off by some per cent


def remarks(case: Case, states: dict[str, NDArray[np.float64]]) -> list[str]:
    """Of states whose wall stands steeper than a membrane without bending stiffness is good for."""
    one = np.ones(1)
    ends = math.isfinite(case.rubber.margin(one, 1.0, 0 * one))
    what = "z', or what is left to the end of the rubber's law," if ends else "z'"
    return [
        f"the membrane stands steep, {what} = {slope:.2g} at its lowest: below {STEEPEST:g} it is "
        "not exact, take solid"
        if slope < STEEPEST
        else ""
        for slope in states["margin"]
    ]


def composition(case: Case) -> list[str]:
    """Includes by the effects."""
    return [f"membrane_wall_{case.effects.wall}.idp"]


MODEL = Model(
    name="membrane",
    rank=3,
    label="FE membrane",
    mesh="meridian",
    braids="mirrored",
    switches=("threads", "wall"),
    effects=("rubber", "wall_thickness", "thread_stretch", "slackening", "end_caps"),
    numerics=("newton", "meridian"),
    frame="biaxial",
    quantities=(
        "force",
        "contraction",
        "inner_diameter",
        "outer_diameter",
        "thread_stretch",
        "contact_pressure",
        "volume",
        "stiffness",
        "deformed_shape",
        "dynamic_stiffness",
    ),
    fields={"meridian": slice(0, 4)},
    composition=composition,
    remarks=remarks,
    in_time=True,
    crumples=True,
    fuller="solid",
    lacks="cap_geometry",
)
