"""Eq. (1) of the paper at the mean diameter of the layers."""

from solver.case import Case
from solver.models.model import Model
from solver.record import Solution


def solve(case: Case) -> Solution:
    """Eq. (1) at every stop of a path."""
    from solver import net

    assert case.muscle.braid is not None
    return net.solve(case, case.muscle.braid.mean_diameter)


MODEL = Model(
    name="geometric_layers",
    rank=1,
    label="Eq. (1) at the layers",
    parts=(),
    unread=("wall_thickness", "length"),
    needs_braid=True,
    braids="one angle",
    threshold=False,  # its force is 0 at no pressure but 0
    quantities=("force", "contraction", "inner_diameter"),
    solve=solve,
)
