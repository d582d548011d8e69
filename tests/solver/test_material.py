"""Rubber and threads: what is refused, and why."""

import math

import pytest

from solver.material import Thread
from solver.refusal import UnsolvableCase
from solver.rubber.mooney_rivlin.law import MooneyRivlin


def test_shear_modulus(nbr):
    assert nbr.shear_modulus == pytest.approx(0.857776)


def test_bulk_modulus_of_both_rubbers(nbr, silicone):
    assert nbr.kappa == silicone.kappa == 1000


@pytest.mark.parametrize(
    ("field", "changes"),
    [
        ("c10", {"c10": 0}),
        ("c10", {"c10": -0.1}),
        ("c10", {"c10": math.nan}),
        ("c10", {"c10": "0.3"}),
        ("c10", {"c10": True}),
        ("c01", {"c01": -1e-9}),
        ("c01", {"c01": math.inf}),
        ("kappa", {"kappa": 42.8}),  # 50 shear moduli are 42.9 MPa
        ("kappa", {"kappa": math.inf}),
    ],
)
def test_refused_rubber(field, changes):
    with pytest.raises(UnsolvableCase) as refused:
        MooneyRivlin(**{"c10": 0.345083, "c01": 0.083805} | changes)
    assert refused.value.field == field
    assert field in str(refused.value)
    assert "allowed" in str(refused.value)


def test_neo_hooke_is_a_rubber():
    assert MooneyRivlin(c10=1, c01=0).shear_modulus == 2


@pytest.mark.parametrize("stiffness", [0, -315, math.nan, math.inf, "315", None])
def test_refused_thread(stiffness):
    with pytest.raises(UnsolvableCase, match=r"stiffness.*> 0 \(N\)"):
        Thread(stiffness=stiffness)
