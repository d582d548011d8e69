"""Which state is valid, which stable, and what that makes of a case."""

import math

import numpy as np
import pytest

from solver.load_path import PathKind
from solver.status import CaseStatus, Flag, StateStatus, case_status, state_status

GOOD = {
    "force": 100.0,
    "min_det_f": 0.9,
    "min_det_f_nodes": 0.8,
    "margin": 0.9,
    "unstable_modes": 0.0,
    "stiffness": 5.0,
}
CONVERGED, UNSTABLE, INVALID, NOT_REACHED = list(StateStatus)[:4]


def status_of(kind: PathKind, **changes: float) -> StateStatus:
    (status,) = state_status(kind, {n: np.array([v]) for n, v in (GOOD | changes).items()})
    return status


@pytest.mark.parametrize("kind", PathKind)
@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({}, CONVERGED),
        ({"force": -50.0}, CONVERGED),
        ({"force": 0.0}, CONVERGED),
        ({"min_det_f": 1e-9}, CONVERGED),
        ({"min_det_f": 0.0}, INVALID),
        ({"min_det_f": -0.1}, INVALID),
        ({"min_det_f_nodes": -0.1}, INVALID),
        ({"margin": -1e-9}, INVALID),
        ({"margin": math.nan}, INVALID),
        ({"unstable_modes": 1.0}, UNSTABLE),
        ({"unstable_modes": 2.0, "min_det_f": -0.1}, INVALID),
        ({"force": math.nan}, NOT_REACHED),
        ({"force": math.nan, "min_det_f": -0.1}, NOT_REACHED),
    ],
)
def test_state(kind, changes, expected):
    assert status_of(kind, **changes) is expected


def test_a_dead_load_needs_a_force_that_rises_with_length():
    assert status_of(PathKind.ISOTONIC, stiffness=-1.0) is UNSTABLE
    assert status_of(PathKind.ISOBARIC, stiffness=-1.0) is CONVERGED
    assert status_of(PathKind.ISOMETRIC, stiffness=-1.0) is CONVERGED


def test_states_are_judged_one_by_one():
    states = {name: np.array([value] * 3) for name, value in GOOD.items()}
    states["min_det_f"][1] = -1
    states["force"][2] = np.nan
    assert state_status(PathKind.ISOBARIC, states) == [CONVERGED, INVALID, NOT_REACHED]


@pytest.mark.parametrize(
    ("states", "expected"),
    [
        ([CONVERGED, CONVERGED], CaseStatus.CONVERGED),
        ([CONVERGED, UNSTABLE], CaseStatus.CONVERGED),
        ([CONVERGED, INVALID], CaseStatus.INVALID_STATE),
        ([CONVERGED, NOT_REACHED], CaseStatus.STALLED),
        ([INVALID, NOT_REACHED], CaseStatus.STALLED),
    ],
)
def test_case(states, expected):
    assert case_status(states) is expected


def test_a_path_that_ends_at_an_extremum_has_a_limit_point():
    assert case_status([CONVERGED, NOT_REACHED], limited=True) is CaseStatus.LIMIT_POINT
    assert case_status([CONVERGED, CONVERGED], limited=True) is CaseStatus.CONVERGED


def test_the_vocabulary():
    assert [s.value for s in StateStatus] == [
        "converged",
        "unstable",
        "invalid_state",
        "not_reached",
        "no_root",
        "not_asked",
    ]
    assert [f.value for f in Flag] == ["overstrained", "extrapolated", "smoothed"]
    assert [s.value for s in CaseStatus] == [
        "converged",
        "limit_point",
        "stalled",
        "invalid_state",
        "unbalanced",
        "mesh_failed",
        "timeout",
        "solver_error",
        "not_solved",
        "not_asked",
    ]
