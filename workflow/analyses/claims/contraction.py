"""C1, figure 4: force against contraction at constant pressures."""

import numpy as np
import pandas as pd

from workflow.analyses.claims.claim import (
    GEOMETRIC,
    STEPS,
    Array,
    Claims,
    Data,
    Finding,
    Missing,
    bend,
    graded,
    listed,
    percents,
    within,
)
from workflow.data import deviation
from workflow.data.deviation import RELATIVE, SHARE
from workflow.data.paper import MEAN_DEVIATION

PRESSURES = (0.2, 0.3, 0.4)  # MPa
MAP = "festo_musclesim"
CLAIMS = Claims()


@CLAIMS.add("C1a", "fig04", "force falls with contraction and rises with pressure", paper="always")
def falls_and_rises(data: Data) -> Finding:
    """C1a: the share of neighbouring states that are ordered as claimed."""
    force = _forces(data, data.model)
    along, across = np.diff(force, axis=1) < 0, np.diff(force, axis=0) > 0
    share = float(np.mean(np.append(along, across)))
    why = f"{100 * share:.0f} % of the steps in contraction and pressure go the claimed way"
    return graded(share, [along.all(), across.all()], why)


@CLAIMS.add("C1b", "fig04", "force against contraction is nonlinear", paper="nonlinear")
def nonlinear(data: Data) -> Finding:
    """C1b: distance from a straight line against that of Eq. (1)."""
    ours = min(bend(STEPS, force) for force in _forces(data, data.model))
    equation = max(bend(STEPS, force) for force in _forces(data, GEOMETRIC))
    why = (
        f"curves leave their chord by at least {100 * ours:.1f} % of their range, "
        f"those of Eq. (1) by {100 * equation:.1f} %"
    )
    return graded(ours, [ours > 0.05, ours > 2 * equation], why)


@CLAIMS.add(
    "C1c", "fig04", "force is below Eq. (1), the more so at high contraction", paper="below"
)
def below_equation(data: Data) -> Finding:
    """C1c: how far below Eq. (1), and where more so."""
    return lacking(_forces(data, GEOMETRIC), _forces(data, data.model))


def lacking(equation: Array, ours: Array) -> Finding:
    """Whether forces, shape (curve, contraction), lie below Eq. (1), the more the further."""
    lack = 1 - ours / equation
    why = (
        f"from 0 to 20 % contraction {listed(100 * lack.min(axis=0))} % of Eq. (1)'s force "
        f"are missing at least"
    )
    parts = [bool((lack > 0).all()), bool((np.diff(lack, axis=1) > 0).all())]
    return graded(float(lack[:, -1].mean()), parts, why)


@CLAIMS.add(
    "C1d", "fig04", "mean deviation from the manufacturer's map", paper=f"{MEAN_DEVIATION:g}"
)
def mean_deviation(data: Data) -> Finding:
    """C1d: mean deviation from the manufacturer's map."""
    found = _deviations(data, data.model)[RELATIVE].dropna()
    mean = float(found.mean())
    why = (
        f"mean of {len(found)} states; the thread stiffness, which the paper does not give, "
        "was chosen to meet this number, so it is a fit and no test"
    )
    return within(mean, abs(mean - MEAN_DEVIATION), 0.04, 0.1, why)


@CLAIMS.add("C1e", "fig04", "that deviation is nearly constant", paper="constant")
def constant_deviation(data: Data) -> Finding:
    """C1e: the range of the deviations."""
    found = _deviations(data, data.model)[RELATIVE].dropna()
    spread = float(np.ptp(found))
    why = f"single states lie between {percents([found.min(), found.max()])}"
    return within(spread, spread, 0.1, 0.25, why)


@CLAIMS.add("C1f", "fig04", "the deviation of Eq. (1) grows with contraction", paper="grows")
def equation_by_contraction(data: Data) -> Finding:
    """C1f: deviation of Eq. (1), as a share of the curve's largest force, along contraction."""
    share = _equation(data)
    why = (
        "share of the curve's largest force from 0 to 20 %, mean of the pressures: "
        f"{percents(share.mean(axis=0))}"
    )
    rising = np.diff(share, axis=1) > 0
    return graded(float(share[:, -1].mean()), [rising.all(), rising.mean() > 0.5], why)


@CLAIMS.add("C1g", "fig04", "the deviation of Eq. (1) grows with pressure", paper="grows", unit="N")
def equation_by_pressure(data: Data) -> Finding:
    """C1g: deviation of Eq. (1) along pressure, in newtons and as a share."""
    share, found = _equation(data), _deviations(data, GEOMETRIC)
    newton = (found["force"] - found["reference"]).to_numpy().reshape(share.shape)
    rise = float(newton[-1].mean() - newton[0].mean())
    why = (
        f"from 0.2 to 0.4 MPa its mean goes from {newton[0].mean():.0f} to "
        f"{newton[-1].mean():.0f} N, but from {percents(share[0].mean())} to "
        f"{percents(share[-1].mean())} of the curve's largest force"
    )
    newtons = np.diff(newton.mean(axis=1)) > 0
    return graded(rise, [newtons.all(), (np.diff(share.mean(axis=1)) > 0).all()], why)


def _forces(data: Data, model: str) -> Array:
    """Forces [N], shape (pressure, contraction)."""
    return np.array([data.forces(pressure=p, model=model) for p in PRESSURES])


def _equation(data: Data) -> Array:
    """Deviation of Eq. (1) as a share of the curve's largest force, (pressure, contraction)."""
    found: Array = _deviations(data, GEOMETRIC)[SHARE].to_numpy()
    return found.reshape(len(PRESSURES), -1)


def _deviations(data: Data, model: str) -> pd.DataFrame:
    """All states of the rule (workflow/data/deviation.py)."""
    if MAP not in data.maps:
        raise Missing("there is no manufacturer's map")
    curves = pd.concat([data.states("isobaric", p, model=model) for p in PRESSURES])
    rows = deviation.states(data.maps[MAP], curves)
    if rows[SHARE].isna().any():
        raise Missing("a state is not converged or outside the manufacturer's map")
    return rows
