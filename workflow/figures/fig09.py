"""Force against contraction for two braid angles, by Eq. (1) and by finite elements (claim C6)."""

from typing import Any

import pandas as pd

from workflow.data.scene_data import ANGLE
from workflow.figures import force_contraction
from workflow.figures.force_contraction import draw

__all__ = ["draw", "table"]


def table(data: Any) -> pd.DataFrame:
    """States of the muscles, told apart by braid angle."""
    return force_contraction.table(data, [ANGLE])
