"""Tests of a rubber and the law that was fitted to them."""

import numpy as np
from matplotlib.figure import Figure

from workflow.data.rubber_fit import Fit
from workflow.data.rubber_tests import KINDS, RubberTest
from workflow.figures.style import FULL, SOFT, labelled, legend, panels, series

POINTS = 200  # of a curve


def draw(found: Fit, tests: list[RubberTest], title: str) -> Figure:
    """Stress against stretch of each kind of test, all and close to rest; the law beside it."""
    figure, axes = panels(FULL, 3.0, 1, 2, gap=(0.55, 0.28))
    high = max(float(test.stretch.max()) for test in tests)
    used = {test.kind: test for test in found.tests}
    measured = {test.kind: test for test in tests}
    for ax, end in zip(axes.flat, (high, min(high, 2.0)), strict=True):
        top = 0.0
        for number, kind in enumerate(KINDS):
            look = series(number)
            last = float(measured[kind].stretch.max()) if kind in measured else end
            stretch = np.linspace(1.0, min(end, last), POINTS)
            stress = found.stress(kind, stretch)
            line = {"color": look["color"], "linestyle": "-" if kind in used else (0, (4, 2))}
            word = "the law" if kind in used else "the law, not fitted to"
            ax.plot(stretch, stress, **line, label=f"{kind}, {word}")
            if kind in measured:
                points = measured[kind]
                here = points.stretch <= end * (1 + 1e-9)
                marks = {"color": look["color"], "marker": look["marker"], "linestyle": ""}
                at, nominal = points.stretch[here], points.stress[here]
                ax.plot(at, nominal, **marks, label=f"{kind}, measured", clip_on=False)
                top = max(top, float(nominal.max(initial=0)))
        if top:
            ax.set_ylim(0, 1.1 * top)
        ax.set_xlim(1, end)
        ax.set_xlabel("stretch")
    axes[0, 0].set_ylabel("nominal stress [MPa]")
    axes[0, 0].set_title(title)
    axes[0, 1].set_title("near rest")
    for ax in axes.flat:
        if found.span[1] < ax.get_xlim()[1]:
            ax.axvline(found.span[1], color=SOFT, linewidth=0.8, zorder=0)
    legend(figure, labelled(axes))
    return figure
