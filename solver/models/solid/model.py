"""The axisymmetric section of the wall as a solid, held by the fittings."""

from solver.case import Case
from solver.effects import End
from solver.models.model import Model


def flags(case: Case) -> dict[str, str | float]:
    """Flags of solid_compressible.idp and ends_clamp.idp."""
    values: dict[str, str | float] = {}
    if case.compressible:
        values["kappa"] = case.rubber.kappa
    if case.effects.end is End.CLAMP:
        clamp = case.numerics.clamp
        assert clamp.thread_stiffness is not None
        assert clamp.inner_stiffness is not None
        values |= {
            "clamp_ramp": clamp.ramp * case.muscle.wall_thickness,
            "clamp_thread_stiffness": clamp.thread_stiffness,
            "clamp_inner_stiffness": clamp.inner_stiffness,
        }
    return values


def composition(case: Case) -> list[str]:
    """Includes by the effects."""
    return [f"ends_{case.effects.end}.idp", f"solid_{case.effects.volume}.idp"]


MODEL = Model(
    name="solid",
    rank=4,
    label="FE solid",
    mesh="section",
    suffix="msh",
    braids="mirrored, two lines",
    switches=("end", "threads", "volume"),
    effects=(
        "rubber",
        "wall_thickness",
        "thread_stretch",
        "slackening",
        "end_caps",
        "cap_geometry",
        "compressibility",
    ),
    numerics=("newton", "section"),
    frame="axisymmetric",
    compressible=True,
    quantities=(
        "force",
        "contraction",
        "inner_diameter",
        "outer_diameter",
        "thread_stretch",
        "contact_pressure",
        "volume",
        "stiffness",
        "stress",
        "deformed_shape",
        "dynamic_stiffness",
    ),
    fields={"corners": slice(0, 4), "stress": slice(4, 8)},
    flags=flags,
    composition=composition,
    in_time=True,
    lacks="mesh of solid",
)
