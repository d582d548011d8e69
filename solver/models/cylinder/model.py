"""A uniform cylinder: rubber, threads and twist, no end caps."""

from solver.case import Case
from solver.models.model import Model
from solver.record import Solution


def solve(case: Case) -> Solution:
    """The curve of a case."""
    from solver.models.cylinder import curve, in_time

    return curve.solve(case) if case.path.history is None else in_time.solve(case)


MODEL = Model(
    name="cylinder",
    rank=2,
    label="cylinder",
    switches=("threads", "twist", "wall", "stretch", "rubber"),
    effects=("rubber", "wall_thickness", "thread_stretch", "slackening", "twist"),
    quantities=(
        "force",
        "contraction",
        "inner_diameter",
        "outer_diameter",
        "thread_stretch",
        "contact_pressure",
        "volume",
        "stiffness",
        "twist",
        "dynamic_stiffness",
    ),
    in_time=True,
    solve=solve,
    fuller="membrane",
    lacks="end_caps",
)
