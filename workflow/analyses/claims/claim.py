"""What a claim is, what is found of it, and how its function reads the states."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from solver.load_path import PathKind
from workflow.data.reference import ForceMap
from workflow.data.states import GOOD, STOP, ZERO, Table

Array = NDArray[np.float64]
MUSCLE = "dmsp20"  # the normal condition
STEPS = (0.0, 0.05, 0.1, 0.15, 0.2)  # contractions of Table 1
PRESSURE = 0.3  # MPa, of the normal condition
GEOMETRIC = "geometric"


class Verdict(StrEnum):
    """What became of a claim."""

    REPRODUCED = "reproduced"
    PARTLY = "partly"
    NOT_REPRODUCED = "not reproduced"
    NOT_TESTABLE = "not testable"


class Missing(Exception):
    """There are no states of what a claim speaks of."""


@dataclass(frozen=True)
class Finding:
    """Our number, the verdict and one sentence of why."""

    value: float
    verdict: Verdict
    why: str


@dataclass(frozen=True)
class Data:
    """What the claims are judged by.

    Attributes
    ----------
    table : the states
    model : whose curves are judged
    maps : the force maps of the study's muscles, by name
    stress : what is left of the fields, one row per state (stress.py)
    threads : what single threads change of the force of silicone [N], by wall thickness [mm]
    """

    table: Table
    model: str
    maps: Mapping[str, ForceMap] = field(default_factory=dict)
    stress: pd.DataFrame | None = None
    threads: pd.Series | None = None

    def states(
        self, path: str, held: float, muscle: str = MUSCLE, model: str | None = None
    ) -> pd.DataFrame:
        """The states of a curve.

        Raises
        ------
        Missing
            If there is no such curve.
        """
        found = self.table.curve(path, muscle, model or self.model, "default", held)
        if found is None:
            raise Missing(f"there is no {self._named(path, held, muscle, model)}")
        return found

    def curve(
        self, path: str, quantity: str, held: float, muscle: str = MUSCLE, model: str | None = None
    ) -> pd.Series:
        """A quantity by the control that is swept; NaN where a state is not converged.

        Raises
        ------
        Missing
            If there is no such curve, or nothing of it has converged.
        """
        rows = self.states(path, held, muscle, model)
        rows = rows[rows["point"] == STOP].set_index(PathKind(path).swept.key)
        found = rows[quantity].where(rows["status"] == GOOD)
        if not np.isfinite(found).any():
            named = self._named(path, held, muscle, model)
            raise Missing(f"there is no converged {quantity} of {named}")
        return found

    def zero_force(self, path: str, held: float) -> float:
        """The swept value at which there is no force.

        Raises
        ------
        Missing
            If there is no such curve or state.
        """
        kind, rows = PathKind(path), self.states(path, held)
        found = rows.loc[rows["point"] == ZERO, kind.swept.key].dropna()
        if found.empty:
            raise Missing(f"there is no {kind.zero_force} of {self._named(path, held)}")
        return float(found.iloc[0])

    def _named(self, path: str, held: float, muscle: str = MUSCLE, model: str | None = None) -> str:
        """A curve in a sentence."""
        at = PathKind(path).held.text(held)
        return f"{path} curve of {muscle} at {at} by {model or self.model}"

    def forces(
        self,
        muscle: str = MUSCLE,
        pressure: float = PRESSURE,
        contractions: Sequence[float] = STEPS,
        model: str | None = None,
    ) -> Array:
        """Forces at some contractions and constant pressure [N]."""
        curve = self.curve("isobaric", "force", pressure, muscle, model)
        return values(curve, contractions)


@dataclass(frozen=True)
class Claim:
    """A claim of the paper: where it stands, its number, and what judges it."""

    name: str
    figure: str
    text: str
    unit: str
    paper: str
    judge: Callable[[Data], Finding]


class Claims(list[Claim]):
    """Claims in their order, each written above the function that judges it."""

    def add(
        self, name: str, figure: str, text: str, *, paper: str, unit: str = "1"
    ) -> Callable[[Callable[[Data], Finding]], Callable[[Data], Finding]]:
        """Add a claim; ``paper`` is its number or what it says, ``unit`` that of ours."""

        def added(judge: Callable[[Data], Finding]) -> Callable[[Data], Finding]:
            self.append(Claim(name, figure, text, unit, paper, judge))
            return judge

        return added


def values(curve: pd.Series, at: ArrayLike) -> Array:
    """Numbers of a curve at some stops.

    Raises
    ------
    Missing
        If one of them is not there or not converged.
    """
    stops = np.atleast_1d(at)
    found: Array = curve.reindex(stops).to_numpy(dtype=float)
    if not np.isfinite(found).all():
        missing = listed(stops[~np.isfinite(found)], "g")
        raise Missing(f"there is no converged state at {curve.index.name} {missing}")
    return found


def between(curve: pd.Series, low: float, high: float) -> pd.Series:
    """The converged states of a curve from one value of its control to another.

    Raises
    ------
    Missing
        If there are fewer than three.
    """
    found = curve.loc[low - 1e-9 : high + 1e-9].dropna()
    if found.size < 3:
        control = curve.index.name
        raise Missing(f"fewer than three converged states from {control} {low:g} to {high:g}")
    return found


def slope(curve: pd.Series, low: float, high: float) -> float:
    """Mean slope of a curve between two values of its control, as far as it is known there."""
    found = between(curve, low, high)
    return float((found.iloc[-1] - found.iloc[0]) / (found.index[-1] - found.index[0]))


def bend(x: ArrayLike, y: ArrayLike) -> float:
    """Largest distance from the chord between the ends, as a share of the range of y."""
    x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    chord = y[0] + (y[-1] - y[0]) * (x - x[0]) / (x[-1] - x[0])
    return float(np.max(np.abs(y - chord)) / np.ptp(y))


def graded(value: float, parts: Sequence[bool | np.bool_], why: str) -> Finding:
    """Reproduced if all parts hold, not reproduced if none does."""
    if all(parts):
        return Finding(value, Verdict.REPRODUCED, why)
    return Finding(value, Verdict.PARTLY if any(parts) else Verdict.NOT_REPRODUCED, why)


def within(value: float, off: float, close: float, far: float, why: str) -> Finding:
    """Reproduced if ``off``, a distance from the paper, is at most ``close``; partly to ``far``."""
    if off <= close:
        return Finding(value, Verdict.REPRODUCED, why)
    return Finding(value, Verdict.PARTLY if off <= far else Verdict.NOT_REPRODUCED, why)


def listed(numbers: ArrayLike, form: str = ".0f") -> str:
    """Numbers as a sentence has them."""
    return ", ".join(format(float(number), form) for number in np.ravel(numbers))


def percents(numbers: ArrayLike, digits: int = 1) -> str:
    """Shares as percent in a sentence, with their signs."""
    return listed(100 * np.asarray(numbers), f"+.{digits}f") + " %"
