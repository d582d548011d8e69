"""One periodic cell of the braid: single threads, no end caps."""

from solver.case import Case
from solver.effects import Twist
from solver.models.model import Model


def flags(case: Case) -> dict[str, str | float]:
    """Flags of cell_parameters.idp."""
    from geometry.cell import Box

    box = Box(case.muscle)
    return {
        "kappa": case.rubber.kappa,
        "mean_radius": box.mean_radius,
        "sectors": box.sectors,
        "axial_spacing": box.spacing,
        "cell_length": box.spacing * case.numerics.cell.repeats,
        "thread_radius": case.numerics.spread.radius_of(case.thread) if case.thread else 1.0,
        "twist_free": int(case.effects.twist is Twist.FREE),
    }


def composition(case: Case) -> list[str]:
    """Includes by the effects."""
    return [f"cell_layers_{case.effects.layers if case.muscle.braid else 'none'}.idp"]


MODEL = Model(
    name="cell",
    rank=5,
    label="FE cell of the braid",
    mesh="cell",
    braids="one lead",
    switches=("threads", "layers", "twist"),
    effects=(
        "rubber",
        "wall_thickness",
        "thread_stretch",
        "slackening",
        "twist",
        "compressibility",
        "discrete_threads",
    ),
    numerics=("newton", "cell"),
    frame="periodic",
    compressible=True,
    quantities=(
        "force",
        "contraction",
        "inner_diameter",
        "outer_diameter",
        "thread_stretch",
        "volume",
        "stiffness",
        "twist",
        "stress",
        "deformed_shape",
    ),
    fields={"corners": slice(0, 6), "stress": slice(6, 12), "threads": slice(12, 16)},
    flags=flags,
    composition=composition,
    fuller="membrane",
    lacks="end_caps",
    only_for="discrete_threads",
)
