"""Intervals, against worked examples."""

from __future__ import annotations

import math

import numpy as np
import pytest

from irsim.metrics import bootstrap, newcombe, spread, wilson


def test_wilson_as_published() -> None:
    # Newcombe 1998, table I, method 3: 81 of 263, 15 of 148, 0 of 20, 1 of 29
    assert wilson(81, 263) == pytest.approx((0.2553, 0.3662), abs=1e-4)
    assert wilson(15, 148) == pytest.approx((0.0624, 0.1605), abs=1e-4)
    assert wilson(0, 20) == pytest.approx((0.0, 0.1611), abs=1e-4)
    assert wilson(1, 29) == pytest.approx((0.0061, 0.1718), abs=1e-4)
    assert wilson(20, 20)[1] == 1.0
    assert all(map(math.isnan, wilson(0, 0)))


def test_newcombe_for_pairs_as_published() -> None:
    # Newcombe 1998, paired data, table II, method 10: 36, 12, 2, 0 of 50
    assert newcombe(36, 12, 2, 0) == pytest.approx((0.0569, 0.3404), abs=1e-4)
    low, high = newcombe(20, 0, 0, 0)
    assert (low, high) == pytest.approx((-0.1611, 0.1611), abs=1e-4)
    low, high = newcombe(10, 0, 0, 10)  # all pairs agree, but that says something
    assert -0.161 < low < 0 < high < 0.161
    assert newcombe(1, 5, 0, 2) == tuple(-end for end in reversed(newcombe(1, 0, 5, 2)))
    assert all(map(math.isnan, newcombe(0, 0, 0, 0)))


def test_bootstrap_is_near_the_normal_interval_and_repeatable() -> None:
    values = np.random.default_rng(1).normal(3.0, 2.0, 400)
    low, high = bootstrap(values)
    half = 1.96 * values.std(ddof=1) / 20
    assert (low, high) == pytest.approx((values.mean() - half, values.mean() + half), abs=0.02)
    assert bootstrap(values) == (low, high)
    assert bootstrap([*values, math.nan]) == (low, high)
    assert bootstrap([2.0, 2.0, 2.0]) == (2.0, 2.0)
    assert all(map(math.isnan, bootstrap([1.0])))


def test_spread_leaves_out_what_is_undefined() -> None:
    assert spread([1.0, math.nan, 3.0]) == (2, 2.0, pytest.approx(math.sqrt(2)))
    count, mean, deviation = spread([math.nan])
    assert count == 0
    assert math.isnan(mean)
    assert math.isnan(deviation)
