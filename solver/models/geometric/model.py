"""Eq. (1) of the paper at the bore."""

from solver.case import Case
from solver.models.model import Model
from solver.record import Solution


def solve(case: Case) -> Solution:
    """Eq. (1) at every stop of a path."""
    from solver import net

    return net.solve(case)


MODEL = Model(
    name="geometric",
    rank=0,
    label="Eq. (1)",
    parts=(),
    unread=("wall_thickness", "length"),
    needs_braid=True,
    braids="one angle",
    threshold=False,  # its force is 0 at no pressure but 0
    quantities=("force", "contraction", "inner_diameter"),
    solve=solve,
    fuller="cylinder",
    lacks="all but pressure on the net",
)
