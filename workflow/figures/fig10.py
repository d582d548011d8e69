"""Force against contraction for two diameters, by Eq. (1) and by finite elements (claim C7).

The thread number decides how the forces compare: with 60 threads in a layer the 40 mm muscle is
half as densely reinforced as that of 20 mm, with 120 as densely.
"""

from typing import Any

import pandas as pd

from workflow.data.scene_data import DIAMETER, THREADS
from workflow.figures import force_contraction
from workflow.figures.force_contraction import draw

__all__ = ["draw", "table"]


def table(data: Any) -> pd.DataFrame:
    """States of the muscles, told apart by diameter and thread number."""
    return force_contraction.table(data, [DIAMETER, THREADS])
