"""Force at one contraction and pressure against wall thickness, by rubber (claim C8)."""

from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from workflow.data.scene_data import CONTRACTION, FORCE
from workflow.figures import walls


def table(data: Any) -> pd.DataFrame:
    """Force of every muscle."""
    return walls.table(data, "force")


def draw(table: pd.DataFrame) -> Figure:
    """One curve per rubber."""
    figure, ax = walls.draw(table, FORCE, CONTRACTION)
    ax.set_ylabel("force [N]")
    return figure
