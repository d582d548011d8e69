"""A membrane of finite wall thickness along its meridian, with end caps."""

from solver.case import Case
from solver.models.model import Model


def composition(case: Case) -> list[str]:
    """Includes by the effects."""
    return [f"membrane_wall_{case.effects.wall}.idp"]


MODEL = Model(
    name="membrane",
    rank=3,
    label="FE membrane",
    mesh="meridian",
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
        "volume",
        "stiffness",
        "deformed_shape",
    ),
    fields={"meridian": slice(0, 4)},
    composition=composition,
    fuller="solid",
    lacks="cap_geometry",
)
