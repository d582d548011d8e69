"""Least squares on functions whose minimum and scatter are known."""

import numpy as np
import pytest

from workflow.analyses.calibration.fit import Parameter, fit

X = np.linspace(1, 2, 12)
LINE = Parameter("a", "N", 1.0, 0.01, 100.0), Parameter("b", "N", 1.0, 0.01, 100.0)


def line(noise):
    y = 3 + 5 * X + noise
    return lambda v: v["a"] + v["b"] * X - y


def test_exact_data_are_found_exactly():
    a, b = fit(LINE, line(0))
    assert (a.value, b.value) == pytest.approx((3, 5), rel=1e-4)
    assert a.low <= a.value <= a.high
    assert a.high - a.low < 1e-3


def test_the_interval_holds_the_truth_as_often_as_it_says():
    chance, inside = np.random.default_rng(1), 0
    for _ in range(200):
        _, b = fit(LINE, line(0.1 * chance.standard_normal(X.size)))
        inside += b.low < 5 < b.high
    assert 180 <= inside <= 199  # 95 % of 200 is 190


def test_more_scatter_is_a_wider_interval():
    noise = np.random.default_rng(2).standard_normal(X.size)
    widths = []
    for share in (0.01, 0.1):
        _, b = fit(LINE, line(share * noise))
        widths.append(b.high - b.low)
    assert widths[1] == pytest.approx(10 * widths[0], rel=0.1)


def test_a_bound_is_said_and_kept():
    bounded = (LINE[0], Parameter("b", "N", 1.0, 0.01, 4.0))
    a, b = fit(bounded, line(0))
    assert b.value == pytest.approx(4, rel=1e-3)
    assert b.at_bound
    assert not a.at_bound


def test_what_the_data_does_not_say_has_no_interval():
    product = fit(LINE, lambda v: v["a"] * v["b"] * X - 6 * X)
    assert np.isnan([product[0].low, product[0].high]).all()


def test_too_few_data_are_refused():
    with pytest.raises(ValueError, match="2 forces cannot fix 2 values"):
        fit(LINE, lambda v: np.array([v["a"] - 3, v["b"] - 5]))
