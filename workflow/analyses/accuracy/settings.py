"""What accuracy is measured by: the normal condition, meshes, steps, tolerances."""

from geometry.mesh_settings import CellMesh, MeridianMesh, SectionMesh
from workflow.plan.effect_costs import MESHES

MUSCLE = "dmsp20"  # of the study file
PRESSURE, CONTRACTION = 0.3, 0.1  # MPa, 1
LARGEST = 0.2  # contraction
STEP = 0.01
FAMILY = (1, 2, 3, 4, 6)  # refinements of the default meshes
BUTT_FAMILY, BUTT_LARGEST = (1, 2, 3, 4), 0.1  # beyond that its corner turns inside out
TUBE_FAMILY = (1, 2, 4, 8)
COARSE: dict[
    str, dict[str, MeridianMesh | SectionMesh]
] = {  # meshes that are no refinement of the default one
    "membrane": {
        "coarser": MeridianMesh(cap_step=1, growth=1.8, body_step=2),
        "coarsest": MeridianMesh(cap_step=3, growth=2.5, body_step=4),
    },
    "solid": {
        "coarser": MESHES["coarser"]["section"],  # as the planner uses it
        "coarsest": SectionMesh(cap_step=4, growth=3, body_step=4),
    },
}
CELLS = {  # only three, as each takes minutes; most of their error is that the cell has no caps
    "coarser": CellMesh(thread_size=1.5, body_size=0.4),
    "1/1": CellMesh(),
    "finer": CellMesh(thread_size=0.65, body_size=0.25),
}
STEPS = (0.1, 0.05, 0.02, 0.005)  # of contraction, to be compared with STEP
TOLERANCES = tuple(10.0**-k for k in range(3, 11))
