"""Every claim's verdict follows the data: reproduced where it holds, not where it does not."""

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from workflow.analyses.claims.claim import STEPS, Verdict
from workflow.analyses.claims.factors import SILICONE, WALLS
from workflow.analyses.claims.judge import CLAIMS, judge

from .made_up import EQUATION, FORCE, data, isobaric, isometric, isotonic, stress, with_map

YES, PARTLY, NO = Verdict.REPRODUCED, Verdict.PARTLY, Verdict.NOT_REPRODUCED
BY_NAME = {claim.name: claim for claim in CLAIMS}
FORCES, EQUATIONS, E = np.array(FORCE), np.array(EQUATION), np.array(STEPS)
FEM, EQ = ("dmsp20", "solid", 0.3), ("dmsp20", "geometric", 0.3)


def at_pressures(force=FORCES, equation=EQUATIONS, scale=lambda p: p / 0.3):
    """Curves at 0.2, 0.3, 0.4 MPa in proportion."""
    return isobaric(
        {
            ("dmsp20", model, p): scale(p) * np.asarray(numbers)
            for p in (0.2, 0.3, 0.4)
            for model, numbers in (("solid", force), ("geometric", equation))
        }
    )


def against_map(deviation, equation=lambda p, e: 0.0):
    """Curves with a relative deviation from a map that is linear and does not reach zero.

    Eq. (1) deviates by a share of the largest force.
    """
    points = [(p, e, 2000 * p * (1 - 3 * e)) for p in (0.2, 0.3, 0.4) for e in STEPS]
    curves = {}
    for p in (0.2, 0.3, 0.4):
        map_force = 2000 * p * (1 - 3 * E)
        curves["dmsp20", "solid", p] = map_force * (1 + deviation(p, E))
        curves["dmsp20", "geometric", p] = map_force + 2000 * p * equation(p, E)
    return with_map(isobaric(curves), points)


def two_angles(small, large=FORCES):
    equation = {("dmsp20_a17.1", "geometric", 0.3): 3 * EQUATIONS, EQ: EQUATIONS}
    return isobaric({("dmsp20_a17.1", "solid", 0.3): small, FEM: large} | equation)


def two_diameters(ratio, name="dmsp20_d40", equation=4.0):
    wide = {
        (name, "solid", 0.3): FORCES * ratio,
        ("dmsp20_d40", "geometric", 0.3): 787.0 * equation,
    }
    return isobaric(wide | {FEM: FORCES, EQ: np.full(5, 787.0)})


def walls(nbr, silicone, quantity="force"):
    """Force at 10 % or contraction under 200 N, by thickness."""
    both = {**dict(zip(WALLS.values(), nbr, strict=True))}
    both |= dict(zip(SILICONE.values(), silicone, strict=True))
    if quantity == "force":
        return isobaric({(m, "solid", 0.3): [f] for m, f in both.items()}, stops=(0.1,))
    curves = {(m, "solid", 200.0): {"contraction": [c]} for m, c in both.items()}
    return data("isotonic", curves, (0.3,))


def with_threads(found, change):
    """The same with what single threads change of silicone's force, by thickness."""
    return replace(found, threads=pd.Series(change, list(WALLS), dtype=float))


def pulled(p):
    """Force with a threshold of 0.15 MPa, bent below."""
    return np.where(p < 0.15, -60 * np.sqrt(np.maximum(0.15 - p, 0) / 0.15), 1600 * (p - 0.15))


def s_curve(steepest, width=0.1):
    return lambda load, p: 0.1 * np.tanh((p - steepest - load / 5000) / width)


WALL_FALLS, SOFT_PEAK = [330, 274, 222, 170], [480, 500, 490, 485]
CASES = [
    # claim, states, verdict
    ("C1a", at_pressures(), YES),
    ("C1a", at_pressures(scale=lambda p: 0.3 / p), PARTLY),
    ("C1a", at_pressures(FORCES[::-1], scale=lambda p: 0.3 / p), NO),
    ("C1b", at_pressures(), YES),
    ("C1b", at_pressures(700 - 3000 * E), NO),
    ("C1c", at_pressures(), YES),
    ("C1c", at_pressures(EQUATIONS * 0.8), PARTLY),
    ("C1c", at_pressures(EQUATIONS * (1.5 - E)), PARTLY),
    ("C1c", at_pressures(EQUATIONS * (1.1 + E)), NO),
    ("C1d", against_map(lambda p, e: -0.1 + 0 * e), YES),
    ("C1d", against_map(lambda p, e: -0.17 + 0 * e), PARTLY),
    ("C1d", against_map(lambda p, e: 0.1 + 0 * e), NO),
    ("C1e", against_map(lambda p, e: -0.1 + 0.1 * e), YES),
    ("C1e", against_map(lambda p, e: -0.1 + 1.0 * e), PARTLY),
    ("C1e", against_map(lambda p, e: -0.2 + 2.0 * e), NO),
    ("C1f", against_map(lambda p, e: 0 * e, lambda p, e: e), YES),
    ("C1f", against_map(lambda p, e: 0 * e, lambda p, e: 0.3 - e), NO),
    ("C1g", against_map(lambda p, e: 0 * e, lambda p, e: p + 0 * e), YES),
    ("C1g", against_map(lambda p, e: 0 * e, lambda p, e: 0.1 + 0 * e), PARTLY),
    ("C1g", against_map(lambda p, e: 0 * e, lambda p, e: 0.1 / p**2 + 0 * e), NO),
    ("C2a", stress(cylinder=[1, 1.1, 1.2]), YES),
    ("C2a", stress(cylinder=[-1, 0.1, 0.2]), PARTLY),
    ("C2a", stress(cylinder=[-1, -1, -1]), NO),
    ("C2b", stress(arc=[-1, -1, -2], arc_mean=[-0.1, -0.2, -0.3]), YES),
    ("C2b", stress(arc=[0.1, -0.1, -2], arc_mean=[0.1, 0.1, 0.1]), PARTLY),
    ("C2b", stress(arc=[0.1, 0.1, 0.2], arc_mean=[0.1, 0.1, 0.1]), NO),
    ("C2c", stress(compressed=[0.1, 0.2, 0.3]), YES),
    ("C2c", stress(compressed=[0.1, 0.2, 0.1]), PARTLY),
    ("C2c", stress(compressed=[0.3, 0.2, 0.1]), NO),
    ("C3a", isometric(0.14, force=pulled), YES),
    ("C3a", isometric(0.12, force=pulled), PARTLY),
    ("C3a", isometric(0.05, force=pulled), NO),
    ("C3b", isometric(force=pulled), YES),
    ("C3b", isometric(force=lambda p: p - 0.05), PARTLY),
    ("C3b", isometric(force=lambda p: 1 + p), NO),
    ("C3c", isometric(force=pulled), YES),
    ("C3c", isometric(force=lambda p: 1000 * (p - 0.15)), NO),
    ("C3d", isometric(model="geometric", force=lambda p: 1000 * p), YES),
    ("C3d", isometric(model="geometric", force=lambda p: 1000 * (p - 0.1)), NO),
    ("C4a", isometric(inner_diameter_inflated=lambda p: 21 + p + 8 * np.minimum(p / 0.15, 1)), YES),
    ("C4a", isometric(inner_diameter_inflated=lambda p: 20 + 20 * p), NO),
    ("C4b", isometric(force=pulled, inner_diameter_inflated=lambda p: 28 + 2 * p), YES),
    ("C4b", isometric(force=lambda p: 500 * p, inner_diameter_inflated=lambda p: 28 + 2 * p), NO),
    (
        "C4c",
        isometric(
            force=lambda p: np.pi * p * 30**2 / 4 * 1.15**2,
            inner_diameter_inflated=lambda p: 30 + 0 * p,
        ),
        YES,
    ),
    (
        "C4c",
        isometric(
            force=lambda p: np.pi * p * 30**2 / 4 * 1.06**2,
            inner_diameter_inflated=lambda p: 30 + 0 * p,
        ),
        PARTLY,
    ),
    (
        "C4c",
        isometric(
            force=lambda p: np.pi * p * 30**2 / 4 * 0.8,
            inner_diameter_inflated=lambda p: 30 + 0 * p,
        ),
        NO,
    ),
    ("C5a", isotonic(lambda load, p: p - 0.1), YES),
    ("C5a", isotonic(lambda load, p: p - load / 2000), PARTLY),
    ("C5a", isotonic(lambda load, p: p - 0.3), NO),
    ("C5b", isotonic(s_curve(0.3)), YES),
    ("C5b", isotonic(s_curve(0.15)), PARTLY),
    ("C5b", isotonic(s_curve(0.05)), NO),
    ("C5c", isotonic(lambda load, p: p * (400 - load) / 1000), YES),
    ("C5c", isotonic(lambda load, p: -load * np.where(p > 0.3, 1 - p, p + 0.1) / 1000), PARTLY),
    ("C5c", isotonic(lambda load, p: -load * (1 - p) / 1000), NO),
    ("C5d", isotonic(lambda load, p: 0 * p - math.sqrt(load)), YES),
    ("C5d", isotonic(lambda load, p: 0 * p - load**2), NO),
    ("C6a", two_angles(FORCES + 100), YES),
    ("C6a", two_angles(FORCES + 100 - 700 * E), PARTLY),
    ("C6a", two_angles(FORCES - 100), NO),
    ("C6b", two_angles(FORCES * 2), YES),
    ("C6b", two_angles(FORCES + 100 + 500 * E), NO),
    ("C6c", two_angles(FORCES * 2), YES),
    ("C6c", two_angles(3 * EQUATIONS * (1.1 + E)), NO),
    ("C6d", two_angles(FORCES * 1.5), YES),
    ("C6d", two_angles(FORCES + 500 - 2000 * E), PARTLY),
    ("C6d", two_angles(FORCES + 500), NO),
    ("C7a", two_diameters(4), YES),
    ("C7a", two_diameters(np.array([1.1, 1.3, 2, 6, 50])), NO),
    ("C7b", two_diameters(4), YES),
    ("C7b", two_diameters(4, equation=4.3), PARTLY),
    ("C7b", two_diameters(4, equation=2), NO),
    *(
        (claim, two_diameters(np.array(ratio), name), verdict)
        for name, first, last in (("dmsp20_d40", "C7c", "C7e"), ("dmsp20_d40_n120", "C7d", "C7f"))
        for claim, ratio, verdict in (
            (first, [3.8, 4, 4.1, 4.5, 9], YES),
            (first, [3.8, 4, 4.1, 5.5, 9], PARTLY),
            (first, [3.8, 4, 5.1, 9.5, 9], NO),
            (last, [4, 4, 4, 5, 34], YES),
            (last, [4, 4, 4, 5, 15], PARTLY),
            (last, [4, 4, 4, 5, 6], NO),
        )
        if name == "dmsp20_d40"
    ),
    ("C8a", walls(WALL_FALLS, SOFT_PEAK), YES),
    ("C8a", walls([330, 270, 222, 200], SOFT_PEAK), PARTLY),
    ("C8a", walls([330, 200, 180, 170], SOFT_PEAK), NO),
    ("C8b", walls(WALL_FALLS, SOFT_PEAK), YES),
    ("C8b", walls(WALL_FALLS[::-1], SOFT_PEAK), NO),
    ("C8c", walls(WALL_FALLS, SOFT_PEAK), YES),
    ("C8c", walls(SOFT_PEAK, WALL_FALLS), NO),
    ("C8d", walls(WALL_FALLS, SOFT_PEAK), YES),
    ("C8d", walls(WALL_FALLS, [508, 502, 496, 491]), NO),
    ("C8d", with_threads(walls(WALL_FALLS, [508, 502, 496, 491]), [-1, 0.1, -2, -3]), NO),
    ("C8d", with_threads(walls(WALL_FALLS, [508, 502, 496, 491]), [-9, 0.1, -2, -3]), YES),
    ("C9a", walls([0.15, 0.13, 0.11, 0.09], [0.23, 0.22, 0.21, 0.2], "contraction"), YES),
    ("C9a", walls([0.15, 0.13, 0.11, 0.09], [0.23, 0.2, 0.2, 0.2], "contraction"), PARTLY),
    ("C9a", walls([0.15, 0.1, 0.09, 0.09], [0.23, 0.2, 0.2, 0.2], "contraction"), NO),
    ("C9b", walls([0.15, 0.13, 0.11, 0.09], [0.23, 0.22, 0.21, 0.2], "contraction"), YES),
    ("C9b", walls([0.23, 0.22, 0.21, 0.2], [0.15, 0.13, 0.11, 0.09], "contraction"), NO),
    ("C9c", walls([0.15, 0.13, 0.11, 0.09], [0.23, 0.22, 0.21, 0.2], "contraction"), YES),
    ("C9c", walls([0.23, 0.22, 0.21, 0.2], [0.15, 0.13, 0.11, 0.09], "contraction"), NO),
]


@pytest.mark.parametrize(("name", "found", "verdict"), CASES)
def test_a_verdict_follows_the_data(name, found, verdict):
    found = judge(BY_NAME[name], found)
    assert found.verdict is verdict, found.why
    assert math.isfinite(found.value)
    assert "nan" not in found.why


@pytest.mark.parametrize("name", [n for n in BY_NAME if n not in ("C7d", "C7f", "C10")])
def test_every_claim_is_tested_both_ways(name):
    verdicts = {verdict for claim, _, verdict in CASES if claim == name}
    assert {YES, NO} <= verdicts


@pytest.mark.parametrize("name", BY_NAME)
def test_a_claim_of_which_there_are_no_states_is_not_testable(name):
    found = judge(BY_NAME[name], isobaric({("other", "solid", 0.3): FORCES}))
    assert found.verdict is Verdict.NOT_TESTABLE
    assert math.isnan(found.value)
    assert found.why


@pytest.mark.parametrize("name", ["C6a", "C7c", "C1a"])
def test_states_that_did_not_converge_are_no_data(name):
    curves = {(m, "solid", p): FORCES for m in WALLS.values() for p in (0.2, 0.3, 0.4)}
    found = isobaric(curves, status="invalid_state")
    assert judge(BY_NAME[name], found).verdict is Verdict.NOT_TESTABLE
