"""Two muscles that pull against each other on a pulley: torque and stiffness of the joint, by maps.

A positive angle is the one to which the agonist turns the joint, getting shorter by r phi while the
antagonist is drawn out by as much. The torque is r (F - F'), the stiffness -dM/dphi =
r^2 (-dF/de/L - dF'/de'/L') at the pressures that valves hold.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from geometry.files import atomic_write
from geometry.readable import plain
from workflow.answers.maps.table import FORCE, Map
from workflow.figures import style
from workflow.figures.style import FULL, SERIES, labelled, legend, panels
from workflow.study.schema import PairEntry

FINE = 121  # angles of a line
METRE = 1e3  # mm
Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Pair:
    """A pair.

    Attributes
    ----------
    radius : of the pulley [mm]
    contraction : of both muscles where the angle is 0
    """

    agonist: Map
    antagonist: Map
    radius: float
    contraction: float

    def contractions(self, angle: ArrayLike) -> tuple[Array, Array]:
        """Of agonist and antagonist at an angle [rad]."""
        way = self.radius * np.asarray(angle, float)
        shorter = self.contraction + way / self.agonist.length
        return shorter, self.contraction - way / self.antagonist.length

    def torque(self, angle: ArrayLike, pressure: float, against: float) -> Array:
        """[N m], with the pressure of the agonist and ``against`` it; NaN beyond a map."""
        first, second = self.contractions(angle)
        pull = self.agonist(FORCE, pressure, first) - self.antagonist(FORCE, against, second)
        return np.asarray(self.radius * pull / METRE)

    def stiffness(self, angle: ArrayLike, pressure: float, against: float) -> Array:
        """[N m/rad] at constant pressures; NaN beyond a map."""
        first, second = self.contractions(angle)
        by = self.agonist(FORCE, pressure, first, by="contraction") / self.agonist.length
        by = by + self.antagonist(FORCE, against, second, by="contraction") / self.antagonist.length
        return np.asarray(-(self.radius**2) * by / METRE)

    def rest(self, pressure: float, against: float) -> float:
        """The angle without a torque [rad]; NaN if there is none within the maps."""
        low, high = self.reach
        angles = np.linspace(low, high, FINE)
        torque = self.torque(angles, pressure, against)
        falls = np.flatnonzero((torque[:-1] >= 0) & (torque[1:] < 0))
        if not falls.size:
            return math.nan
        from scipy.optimize import brentq

        ends = angles[falls[0]], angles[falls[0] + 1]
        return float(brentq(lambda a: float(self.torque(a, pressure, against)), *ends, xtol=1e-12))

    @property
    def reach(self) -> tuple[float, float]:
        """Angles at which both muscles are within their maps [rad]."""
        ends = []
        for made, sign in ((self.agonist, 1), (self.antagonist, -1)):
            edges = sign * (made.contraction[[0, -1]] - self.contraction) * made.length
            ends.append(np.sort(edges / self.radius))
        return float(max(e[0] for e in ends)), float(min(e[1] for e in ends))


def of_entry(entry: PairEntry, maps: Mapping[str, Map]) -> Pair:
    """The pair of an entry, of maps by name."""
    second = maps[entry.antagonist or entry.agonist]
    return Pair(maps[entry.agonist], second, entry.radius, entry.contraction)


def report(name: str, pair: Pair, entry: PairEntry) -> list[str]:
    """Where the joint comes to rest, and how stiff it is there, in lines."""
    lines = []
    for pressure, against in entry.pressure:
        rest = pair.rest(pressure, against)
        said = "no angle without a torque within the maps"
        if math.isfinite(rest):
            stiff = float(pair.stiffness(rest, pressure, against))
            said = (
                f"rests at {plain(math.degrees(rest), 3)} degrees, {plain(stiff, 4)} N m/rad stiff"
            )
        lines.append(f"{name} at {pressure:g} and {against:g} MPa: {said}")
    return lines


def table(pair: Pair, entry: PairEntry) -> pd.DataFrame:
    """One row per pair of pressures and angle; NaN beyond a map."""
    frames = []
    angles = np.radians(entry.angle)
    for pressure, against in entry.pressure:
        first, second = pair.contractions(angles)
        columns = {
            "pressure of the agonist [MPa]": pressure,
            "pressure of the antagonist [MPa]": against,
            "angle [degree]": entry.angle,
            "contraction of the agonist [1]": first,
            "contraction of the antagonist [1]": second,
            "torque [N m]": pair.torque(angles, pressure, against),
            "stiffness [N m/rad]": pair.stiffness(angles, pressure, against),
            "angle without a load [degree]": math.degrees(pair.rest(pressure, against)),
        }
        frames.append(pd.DataFrame(columns))
    return pd.concat(frames, ignore_index=True)


def draw(pair: Pair, entry: PairEntry) -> Figure:
    """Torque and stiffness against the angle, one line for each pair of pressures."""
    figure, axes = panels(FULL, 3.2, 1, 2, gap=(0.7, 0.3))
    torque, stiffness = axes[0]
    fine = np.radians(np.linspace(entry.angle[0], entry.angle[-1], FINE))
    for number, (pressure, against) in enumerate(entry.pressure):
        color = SERIES[number % len(SERIES)]["color"]
        label = f"{pressure:g} and {against:g} MPa"
        for ax, values in (
            (torque, pair.torque(fine, pressure, against)),
            (stiffness, pair.stiffness(fine, pressure, against)),
        ):
            ax.plot(np.degrees(fine), values, color=color, label=label)
        rest = pair.rest(pressure, against)
        if fine[0] <= rest <= fine[-1]:
            torque.plot([math.degrees(rest)], [0.0], "o", color=color, markersize=4)
            there = pair.stiffness(rest, pressure, against)
            stiffness.plot([math.degrees(rest)], [there], "o", color=color, markersize=4)
    torque.axhline(0, color="black", linewidth=0.7)
    torque.set_ylabel("torque [N m]")
    stiffness.set_ylabel("stiffness [N m/rad]")
    stiffness.set_title("dots: without a load")
    for ax in axes[0]:
        ax.set_xlabel("angle [degree]")
    legend(figure, labelled(axes))
    return figure


def write(pair: Pair, entry: PairEntry, output: Path) -> None:
    """Write ``output`` with the endings .csv, .png and .svg, each whole or not at all."""
    with atomic_write(output.with_suffix(".csv")) as beside:
        table(pair, entry).to_csv(beside, index=False, float_format="%.8g")
    figure = draw(pair, entry)
    for suffix in (".svg", ".png"):
        style.save(figure, output.with_suffix(suffix))
