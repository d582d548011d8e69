"""Measured forces of a muscle in time, and those of a model whose rubber has the fitted memory."""

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from workflow.figures.style import FULL, labelled, legend, panels, percent

Array = NDArray[np.float64]
HELD = 1e-3  # a contraction that varies less is held
DEGREE = 5  # of the mean curve that is taken off, or a loop is as thin as a line


def draw(
    times: Array, pressure: Array, contraction: Array, measured: Array, fitted: Array, title: str
) -> Figure:
    """Force less its mean curve against what was swept, or force against time; what is left."""
    figure, axes = panels(FULL, 3.0, 1, 2, gap=(0.55, 0.66))
    force, left = axes[0]
    points = {"color": "0.45", "marker": ".", "markersize": 3, "linestyle": ""}
    if np.ptp(contraction) > HELD:
        x, name = contraction, "contraction [%]"
        percent(force.xaxis)
    elif np.ptp(pressure) > HELD:
        x, name = pressure, "pressure [MPa]"
    else:
        x, name = times, "time [s]"
    mean = np.zeros_like(x)
    if x is not times:
        mean = np.polynomial.Polynomial.fit(x, measured, min(DEGREE, len(np.unique(x)) - 1))(x)
    force.plot(x, measured - mean, label="measured", **points)
    force.plot(x, fitted - mean, color="black", label="model with memory, and a curve")
    force.set(xlabel=name, ylabel="force [N]" if x is times else "force less its mean curve [N]")
    force.set_title(title)
    left.plot(times, measured - fitted, **points)
    left.axhline(0, color="black", linewidth=0.8)
    left.set(xlabel="time [s]", ylabel="measured less model [N]")
    left.set_title("what is left")
    legend(figure, labelled(axes))
    return figure
