"""Contraction under one load and pressure against wall thickness, by rubber (claim C9)."""

from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from workflow.data.scene_data import CONTRACTION, FORCE
from workflow.figures import walls
from workflow.figures.style import percent


def table(data: Any) -> pd.DataFrame:
    """Contraction of every muscle; the force is the load."""
    return walls.table(data, "contraction")


def draw(table: pd.DataFrame) -> Figure:
    """One curve per rubber."""
    figure, ax = walls.draw(table, CONTRACTION, FORCE)
    ax.set_ylabel("contraction [%]")
    percent(ax.yaxis)
    return figure
