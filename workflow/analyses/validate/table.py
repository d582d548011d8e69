"""Predictions against measured muscles: uncalibrated, after one fit at one pressure, and of others.

Of every muscle of the library with a force map. A fit is that of EA and of the rubber's C10 at
0.3 MPa to one map: what draws, and what resists. With its values that map is predicted at other
pressures, and other maps of its muscle; with those of the muscle that most is known of, muscles of
other lengths and sizes too. What a row never saw is said in it.

Candidates for what the model lacks are in ``validate_fits``: the fitting (how far forces move where
ends are free to widen), threads of another construction, and the maker's tolerance. For muscles of
another width EA goes by construction too: threads of the material of those of BASE, which lie as
close to each other as these do, so that a wider muscle has thicker ones.
"""

import math
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from solver.effects import Effects, End
from workflow.analyses.analysis import Solved
from workflow.analyses.calibration.calibrate import rounded
from workflow.analyses.calibration.fit import Fitted, Parameter, fit
from workflow.analyses.calibration.forward_model import ForwardModel
from workflow.data import reference
from workflow.data.reference import ForceMap, largest_force
from workflow.study.contents import StudiedMuscle, Study
from workflow.study.schema import BOUNDS
from workflow.study.study import load_library

MODEL = "solid"
FITTED_AT = 0.3  # MPa
PRESSURES = (0.2, 0.3, 0.4, 0.6)  # MPa
CONTRACTIONS = tuple(np.linspace(0, 0.2, 9).round(3).tolist())
TOLERANCE = 10.0  # % of the force, that the maker states
EA, RUBBER = "thread_stiffness", "c10"
BASE = "dmsp_20_300"  # muscle whose fits are tried on all others
OF_BASE, BUILT = "EA of DMSP-20-300", "EA by construction"
NONE = "nothing"  # in place of what was fitted

Array = NDArray[np.float64]
Source = tuple[str, str]  # muscle and map


def tables(_study: Study, _solved: Sequence[Solved]) -> dict[str, pd.DataFrame]:
    """Fit every source, and predict it and others."""
    library = load_library()
    muscles = {name: made for name, made in library.muscles.items() if made.reference}
    maps = reference.load({name for made in muscles.values() for name in made.reference})
    found = [(name, each) for name, made in muscles.items() for each in made.reference]
    with tempfile.TemporaryDirectory() as folder:
        forward = {n: ForwardModel(library, made, Path(folder)) for n, made in muscles.items()}
        fits = {source: _fit(forward[source[0]], maps[source[1]]) for source in found}
        rows = [
            row
            for source in found
            for fitted, built in _bases(found, source, muscles)
            for row in _rows(forward[source[0]], maps, muscles, fitted, fits, source, built=built)
        ]
        table = pd.DataFrame(rows)
        summary = [_summary(table, fits[s], forward[s[0]], maps[s[1]], s) for s in found]
    return {"validate": table, "validate_fits": pd.DataFrame(summary)}


def _bases(
    found: Sequence[Source], source: Source, muscles: Mapping[str, StudiedMuscle]
) -> list[tuple[Source | None, bool]]:
    """What a prediction may have been fitted to: nothing, itself, others of its muscle or BASE.

    And whether EA goes by the construction of the muscle then.
    """
    others = [other for other in found if other[0] in (source[0], BASE)]
    one, base = muscles[source[0]], muscles[BASE]
    apart = by_construction(base, one) != 1
    built = [other for other in others if other[0] == BASE] if apart else []
    return [(None, False), *((other, False) for other in others), *((each, True) for each in built)]


def by_construction(base: StudiedMuscle, other: StudiedMuscle) -> float:
    """EA of a thread by that of another muscle, of one material and as close to its neighbours.

    Threads that cover a given share of their circumference have diameters as this by their number;
    EA goes with the square of these.
    """
    width = []
    for each in (base, other):
        braid = each.muscle.braid
        assert braid is not None  # a measured muscle has threads
        width.append(braid.mean_diameter * math.cos(braid.angle) / braid.threads_each)
    return round((width[1] / width[0]) ** 2, 12)


def _fit(forward: ForwardModel, found: ForceMap) -> list[Fitted]:
    """EA and C10 that are nearest to a map at the pressure of the fit."""
    thread = forward.muscle.thread
    assert thread is not None  # a measured muscle has threads
    stops = _stops(found, FITTED_AT)
    expected = found.force(stops, FITTED_AT)

    def residuals(values: Mapping[str, float]) -> Array:
        force = forward.forces(values, MODEL, FITTED_AT, stops)
        return np.nan_to_num(force - expected, nan=float(np.max(np.abs(expected))))

    start = {EA: ("N", thread.stiffness), RUBBER: ("MPa", forward.muscle.rubber.values()[RUBBER])}
    return fit([Parameter(key, *each, *BOUNDS[key]) for key, each in start.items()], residuals)


def _values(fitted: Sequence[Fitted]) -> dict[str, float]:
    return rounded((each.parameter.name, each.value) for each in fitted)


def _stops(found: ForceMap, pressure: float) -> Array:
    """Contractions at which a map is compared at a pressure."""
    stops = np.array(CONTRACTIONS)
    return stops[found.inside(stops, pressure)]


def _errors(
    forward: ForwardModel, found: ForceMap, values: Mapping[str, float], pressure: float
) -> Array:
    """(F - Fref) / Fmax along a curve [%]; NaN where there is no valid state."""
    stops = _stops(found, pressure)
    if not stops.size:
        return stops
    force = forward.forces(values, MODEL, pressure, stops)
    off = force - found.force(stops, pressure)
    return np.asarray(100 * off / largest_force(found, pressure))


def _rows(
    forward: ForwardModel,
    maps: Mapping[str, ForceMap],
    muscles: Mapping[str, StudiedMuscle],
    fitted: Source | None,
    fits: Mapping[Source, Sequence[Fitted]],
    source: Source,
    *,
    built: bool = False,
) -> Iterator[dict[str, Any]]:
    """A prediction at every pressure of a map; EA by construction, if ``built``."""
    muscle, name = source
    thread, rubber = muscles[muscle].thread, muscles[muscle].rubber.values()
    assert thread is not None
    values = {EA: thread.stiffness, RUBBER: rubber[RUBBER]}
    values |= _values(fits[fitted]) if fitted else {}
    if built:
        values[EA] = float(f"{values[EA] * by_construction(muscles[BASE], muscles[muscle]):.6g}")
    for pressure in PRESSURES:
        errors = _errors(forward, maps[name], values, pressure)
        if not errors.size:
            continue
        reached = errors[np.isfinite(errors)]
        spread = _spread(maps, muscles[muscle].reference, name, pressure)
        yield {
            "muscle": muscle,
            "reference": name,
            "fitted to": _basis(fitted, built=built),
            "EA [N]": values[EA],
            "C10 [MPa]": values[RUBBER],
            "pressure [MPa]": pressure,
            "never saw": never_saw(fitted, source, pressure),
            "states": len(errors),
            "states reached": len(reached),
            "mean error [%]": float(np.mean(reached)) if reached.size else np.nan,
            "mean |error| [%]": float(np.mean(np.abs(reached))) if reached.size else np.nan,
            "largest |error| [%]": float(np.max(np.abs(reached))) if reached.size else np.nan,
            "mean spread [%]": float(np.mean(spread)) if spread.size else np.nan,
            "largest spread [%]": float(np.max(spread)) if spread.size else np.nan,
        }


def _basis(fitted: Source | None, *, built: bool = False) -> str:
    """What a prediction was fitted to, in words."""
    if fitted is None:
        return NONE
    return f"{fitted[1]} of {fitted[0]}" + f", {BUILT}" * built


def never_saw(fitted: Source | None, source: Source, pressure: float) -> str:
    """Which of the data that it is compared with a prediction has not been fitted to."""
    if fitted is None:
        return "any measured force"
    if fitted == source:
        if pressure == FITTED_AT:
            return "-, it is the fit itself"
        return f"{source[1]} at any pressure but {FITTED_AT:g} MPa"
    if fitted[0] == source[0]:
        return f"{source[1]}, another source on the same muscle"
    return f"{source[1]}, and any force of {source[0]}"


def _spread(maps: Mapping[str, ForceMap], names: Sequence[str], own: str, pressure: float) -> Array:
    """How far other maps of the muscle are from this one, where both say something [%]."""
    stops = _stops(maps[own], pressure)
    size = largest_force(maps[own], pressure)
    found = [
        100 * np.abs(maps[name].force(stops, pressure) - maps[own].force(stops, pressure)) / size
        for name in names
        if name != own
    ]
    every = np.concatenate(found) if found else np.array([])
    return np.asarray(every[np.isfinite(every)])


def _summary(
    table: pd.DataFrame,
    fitted: Sequence[Fitted],
    forward: ForwardModel,
    found: ForceMap,
    source: Source,
) -> dict[str, Any]:
    """A fit, what other pressures say of it, and what another end would change."""
    ends = ForwardModel(load_library(), forward.muscle, forward.folder)
    ends.variant = replace(ends.variant, effects=Effects(end=End.SLIDING))
    own = _errors(forward, found, _values(fitted), FITTED_AT)
    free = _errors(ends, found, _values(fitted), FITTED_AT)
    after = _worst(table, source, source)
    return {
        "muscle": source[0],
        "reference": source[1],
        **{
            f"{said} [{each.parameter.unit}]": value
            for each, name in zip(fitted, ("EA", "C10"), strict=True)
            for said, value in (
                (name, each.value),
                (f"{name} low 95 %", each.low),
                (f"{name} high 95 %", each.high),
            )
        },
        "stopped by a bound": any(each.at_bound for each in fitted),
        "largest |error| of the fit [%]": float(np.nanmax(np.abs(own))),
        "largest |error| elsewhere, nothing fitted [%]": _worst(table, None, source),
        "largest |error| elsewhere [%]": after,
        **_as_built(table, source),
        "within the maker's 10 %": after <= TOLERANCE,
        "largest change by free ends [%]": float(np.nanmax(np.abs(free - own))),
    }


def _as_built(table: pd.DataFrame, source: Source) -> dict[str, float]:
    """Largest errors at all pressures by the fits of BASE, as they are and by construction [%]."""
    here = table[(table["muscle"] == source[0]) & (table["reference"] == source[1])]
    of_base = here["fitted to"].str.contains(f" of {BASE}", regex=False)
    built = here["fitted to"].str.endswith(BUILT)
    if not built.any():  # of the same construction
        return dict.fromkeys((f"largest |error|, {said} [%]" for said in (OF_BASE, BUILT)), np.nan)
    errors = here["largest |error| [%]"]
    return {
        f"largest |error|, {OF_BASE} [%]": float(errors[of_base & ~built].max()),
        f"largest |error|, {BUILT} [%]": float(errors[built].max()),
    }


def _worst(table: pd.DataFrame, fitted: Source | None, source: Source) -> float:
    """Largest error at the pressures that were not fitted [%]."""
    basis = _basis(fitted)
    chosen = table[
        (table["muscle"] == source[0])
        & (table["reference"] == source[1])
        & (table["fitted to"] == basis)
        & (table["pressure [MPa]"] != FITTED_AT)
    ]
    return float(chosen["largest |error| [%]"].max())
