"""What a claim is, what is found of it, and how its function reads the dataset."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from solver.status import StateStatus

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
    """The dataset does not hold what a claim speaks of."""


@dataclass(frozen=True)
class Finding:
    """Our number, the verdict and one sentence of why."""

    value: float
    verdict: Verdict
    why: str


@dataclass(frozen=True)
class Data:
    """The dataset (workflow/data/dataset.py) and the model whose curves are judged."""

    tree: xr.DataTree
    model: str

    def curve(
        self, group: str, quantity: str, *, model: str | None = None, **at: str | float
    ) -> xr.DataArray:
        """A quantity along the swept control; NaN where a state is not converged.

        Raises
        ------
        Missing
            If there is no such curve.
        """
        place = {"muscle": MUSCLE, "model": model or self.model, "variant": "default"} | at
        try:
            data = self.tree[group].to_dataset().sel(place)
            found = data[quantity]
        except KeyError:
            raise Missing(f"the dataset has no {quantity} of {place}") from None
        if "status" in data and found.dims:
            found = found.where(data.status == StateStatus.CONVERGED.value)
        if not np.isfinite(found).any():
            raise Missing(f"the dataset has no converged {quantity} of {place}")
        return found

    def forces(
        self,
        muscle: str = MUSCLE,
        pressure: float = PRESSURE,
        contractions: Sequence[float] = STEPS,
        model: str | None = None,
    ) -> Array:
        """Forces at some contractions and constant pressure [N]."""
        curve = self.curve("isobaric", "force", muscle=muscle, pressure=pressure, model=model)
        return values(curve, contraction=contractions)


@dataclass(frozen=True)
class Claim:
    """A claim of the paper: where it stands, its number, and what judges it."""

    name: str
    figure: str
    text: str
    unit: str
    paper: str
    judge: Callable[[Data], Finding]


def values(curve: xr.DataArray, **at: ArrayLike) -> Array:
    """Numbers of a curve at some stops.

    Raises
    ------
    Missing
        If one of them is not there or not converged.
    """
    try:
        found = np.asarray(curve.sel({k: np.asarray(v) for k, v in at.items()}), dtype=float)
    except KeyError:
        raise Missing(f"the dataset has no state at {at}") from None
    if not np.isfinite(found).all():
        raise Missing(f"a state at {at} is not converged")
    return found


def between(curve: xr.DataArray, low: float, high: float) -> xr.DataArray:
    """The converged states of a curve from one value of its control to another.

    Raises
    ------
    Missing
        If there are fewer than three.
    """
    control = str(curve.dims[0])
    found = curve.sel({control: slice(low - 1e-9, high + 1e-9)}).dropna(control)
    if found.size < 3:
        raise Missing(f"fewer than three converged states from {control} {low:g} to {high:g}")
    return found


def slope(curve: xr.DataArray, low: float, high: float) -> float:
    """Mean slope of a curve between two values of its control, as far as it is known there."""
    found = between(curve, low, high)
    control = found[str(found.dims[0])].values
    return float((found.values[-1] - found.values[0]) / (control[-1] - control[0]))


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
