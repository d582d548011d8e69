"""C3 to C5, figures 6 to 8: what pressure does at constant length and under constant load."""

import itertools

import numpy as np
import pandas as pd

from workflow.analyses.claims.claim import (
    GEOMETRIC,
    Array,
    Claims,
    Data,
    Finding,
    Missing,
    bend,
    between,
    graded,
    listed,
    slope,
    values,
    within,
)
from workflow.data.paper import AT_CONTRACTION, EXCESS, THRESHOLD

STABLE, HIGHEST = 0.2, 0.4  # MPa: the diameter is stable from here on; the end of figure 7
LOADS = (100.0, 200.0, 300.0)  # N
PARTS = (0.0, 0.2, 0.4, 0.6)  # MPa: contraction is fastest in the middle part
START = 0.1  # MPa: below, the loaded muscle extends
CLAIMS = Claims()


@CLAIMS.add("C3a", "fig06", "threshold pressure at 10 %", paper=f"{THRESHOLD:g}", unit="MPa")
def threshold(data: Data) -> Finding:
    """C3a: the pressure of zero force."""
    found = _threshold(data)
    off = abs(found / THRESHOLD - 1)
    why = f"{100 * (found / THRESHOLD - 1):+.0f} % from the paper's, which is given to 0.05 MPa"
    return within(found, off, 0.1, 0.25, why)


@CLAIMS.add("C3b", "fig06", "force is negative below the threshold", paper="negative", unit="N")
def pushes_below(data: Data) -> Finding:
    """C3b: the sign of the force below the threshold."""
    force, limit = _isometric(data, "force"), _threshold(data)
    below = force.loc[1e-9 : limit - 1e-9].dropna()
    if not below.size:
        raise Missing("there is no converged state below the threshold")
    why = f"forces from {below.min():.1f} to {below.max():.1f} N in {below.size} states"
    return graded(float(below.min()), [bool((below < 0).all()), bool((below < 0).any())], why)


@CLAIMS.add("C3c", "fig06", "force is nonlinear there", paper="nonlinear")
def nonlinear_below(data: Data) -> Finding:
    """C3c: curvature below the threshold against that above."""
    force, limit = _isometric(data, "force"), _threshold(data)
    below, above = between(force, 0, limit), between(force, limit, HIGHEST)
    if below.index[0] > limit / 2:
        raise Missing("the curve of this model ends before half of the threshold pressure")
    ours, other = bend(below.index, below), bend(above.index, above)
    why = (
        f"the curve leaves its chord by {100 * ours:.0f} % of its range below the threshold "
        f"and by {100 * other:.1f} % above"
    )
    return graded(ours, [ours > max(0.1, 2 * other)], why)


@CLAIMS.add("C3d", "fig06", "Eq. (1) has no threshold", paper="positive", unit="N")
def no_threshold_in_equation(data: Data) -> Finding:
    """C3d: the force of Eq. (1) at the lowest pressures."""
    force = _isometric(data, "force", model=GEOMETRIC)
    pulling = force.loc[1e-9:].dropna()
    why = "Eq. (1) pulls at every pressure, in proportion to it"
    return graded(float(pulling.min()), [bool((pulling > 0).all())], why)


@CLAIMS.add(
    "C4a",
    "fig07",
    "the inner diameter rises sharply below 0.15 MPa and is nearly stable above 0.2",
    paper="sharp",
)
def sharp_then_stable(data: Data) -> Finding:
    """C4a: slope of the inflated diameter below 0.15 against that above 0.2 MPa."""
    diameter = _isometric(data, "inner_diameter_inflated")
    low, high = slope(diameter, 0, THRESHOLD), slope(diameter, STABLE, HIGHEST)
    first, last = values(diameter, [STABLE, HIGHEST])
    why = (
        f"{low:.0f} mm/MPa below 0.15 MPa and {high:.1f} above 0.2 MPa, where it grows by "
        f"{100 * (last / first - 1):.1f} %"
    )
    return graded(low / high, [low > 3 * high, last / first < 1.1], why)


@CLAIMS.add(
    "C4b", "fig07", "the equivalent diameter rises faster than the inflated one", paper="> 1"
)
def equivalent_is_faster(data: Data) -> Finding:
    """C4b: slope of the equivalent diameter against that of the inflated one."""
    ours = slope(_isometric(data, "inner_diameter_inflated"), STABLE, HIGHEST)
    other = slope(_equivalent(data), STABLE, HIGHEST)
    why = f"from 0.2 to 0.4 MPa {other:.1f} against {ours:.1f} mm/MPa"
    return graded(other / ours, [other > ours], why)


@CLAIMS.add(
    "C4c",
    "fig07",
    "the equivalent diameter is larger by, on average above the threshold",
    paper=f"{EXCESS:g}",
)
def mean_excess(data: Data) -> Finding:
    """C4c: by how much the equivalent exceeds the inflated diameter."""
    excess = _equivalent(data) / _isometric(data, "inner_diameter_inflated") - 1
    limit = _threshold(data)
    mean = float(between(excess, limit, HIGHEST).mean())
    upper = float(between(excess, STABLE, HIGHEST).mean())
    (last,) = values(excess, HIGHEST)
    why = (
        f"the mean depends on where it begins: {100 * mean:+.1f} % from the threshold on, where "
        f"the equivalent diameter is 0, {100 * upper:+.1f} % from 0.2 MPa on; at 0.4 MPa it is "
        f"{100 * last:+.1f} %"
    )
    off = min(abs(mean - EXCESS), abs(upper - EXCESS))
    return within(mean, off, 0.05, 0.15, why)


@CLAIMS.add(
    "C5a", "fig08", "under 100, 200, 300 N the muscle extends below", paper=f"{START:g}", unit="MPa"
)
def extends_at_first(data: Data) -> Finding:
    """C5a: the pressure at which the loaded muscle has its initial length again."""
    found = []
    for load in LOADS:
        curve = _loaded(data, load).dropna()
        pressure, contraction = curve.index.to_numpy(), curve.to_numpy()
        crossing = np.flatnonzero((contraction[:-1] < 0) & (contraction[1:] >= 0))
        if not crossing.size:
            raise Missing("the loaded muscle never has its initial length")
        k = crossing[0]
        share = -contraction[k] / (contraction[k + 1] - contraction[k])
        found.append(pressure[k] + share * (pressure[k + 1] - pressure[k]))
    why = f"under 100, 200, 300 N it extends below {listed(found, '.3f')} MPa"
    return graded(float(np.mean(found)), [abs(p - START) <= 0.025 for p in found], why)


@CLAIMS.add("C5b", "fig08", "contraction rises fastest between 0.2 and 0.4 MPa", paper="> 1")
def fastest_in_the_middle(data: Data) -> Finding:
    """C5b: slopes of contraction against pressure below, within and above 0.2 to 0.4 MPa."""
    slopes = np.array(
        [
            [slope(_loaded(data, load), *part) for part in itertools.pairwise(PARTS)]
            for load in LOADS
        ]
    )
    why = "mean slopes in percent per 0.1 MPa below, within, above: " + "; ".join(
        f"{load:g} N {listed(10 * row, '.1f')}" for load, row in zip(LOADS, slopes, strict=True)
    )
    parts = [bool(row[1] > max(row[0], row[2])) for row in slopes]
    middle = float(np.mean(slopes[:, 1] / np.maximum(slopes[:, 0], slopes[:, 2])))
    return graded(middle, parts, why)


@CLAIMS.add("C5c", "fig08", "the gap between loads widens with pressure", paper="> 0")
def gap_widens(data: Data) -> Finding:
    """C5c: gap between the lowest and the highest load along pressure."""
    gap = _contractions(data)
    gap = gap[0] - gap[-1]
    why = f"between 100 and 300 N at 0, 0.2, 0.4, 0.6 MPa: {listed(100 * gap, '.1f')} %"
    return graded(float(gap[-1] - gap[0]), list(np.diff(gap) > 0), why)


@CLAIMS.add("C5d", "fig08", "the gap narrows with load", paper="< 1")
def gap_narrows_with_load(data: Data) -> Finding:
    """C5d: gap between 100 and 200 N against that between 200 and 300 N."""
    gaps = -np.diff(_contractions(data), axis=0)
    ratio = gaps[1] / gaps[0]
    why = f"the upper gap is {listed(ratio, '.2f')} of the lower one at 0, 0.2, 0.4, 0.6 MPa"
    return graded(float(ratio.mean()), list(gaps[1] < gaps[0]), why)


def _isometric(data: Data, quantity: str, model: str | None = None) -> pd.Series:
    return data.curve("isometric", quantity, AT_CONTRACTION, model=model)


def _threshold(data: Data) -> float:
    return data.zero_force("isometric", AT_CONTRACTION)


def _equivalent(data: Data) -> pd.Series:
    """sqrt(4 F / (pi p)) above the threshold [mm]; NaN below."""
    force = _isometric(data, "force")
    pulling = force[(force > 0) & (force.index > 0)]
    return np.sqrt(4 * pulling / (np.pi * pulling.index)).reindex(force.index)


def _loaded(data: Data, load: float) -> pd.Series:
    return data.curve("isotonic", "contraction", load)


def _contractions(data: Data) -> Array:
    """Shape (load, pressure)."""
    return np.array([values(_loaded(data, load), PARTS) for load in LOADS])
