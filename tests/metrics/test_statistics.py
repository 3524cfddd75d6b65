"""Intervals, against worked examples."""

from __future__ import annotations

import math

import numpy as np
import pytest

from irsim.metrics import bootstrap, newcombe, spread, wilson
from irsim.metrics.statistics import nested_bootstraps


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


def test_a_nested_bootstrap_is_as_wide_as_the_groups_differ() -> None:
    rng = np.random.default_rng(3)
    groups = np.repeat(range(20), 30)
    alike, apart = rng.normal(0.0, 1.0, 600), np.repeat(rng.normal(0.0, 1.0, 20), 30)
    [(low, high), (far, away)] = nested_bootstraps([alike, apart], groups)
    assert high - low == pytest.approx(2 * 1.96 / math.sqrt(600) * math.sqrt(2), rel=0.25)  # within and between groups
    assert away - far == pytest.approx(2 * 1.96 * apart.std(ddof=1) / math.sqrt(20), rel=0.15)
    assert nested_bootstraps([alike, apart], groups)[0] == (low, high)
    uneven = np.repeat([0, 1, 2], [5, 1, 3])
    values = np.array([1.0] * 5 + [math.nan] + [1.0] * 3)
    assert nested_bootstraps([values], uneven) == [(1.0, 1.0)]
    assert all(map(math.isnan, nested_bootstraps([np.full(9, math.nan)], uneven)[0]))


def test_spread_leaves_out_what_is_undefined() -> None:
    assert spread([1.0, math.nan, 3.0]) == (2, 2.0, pytest.approx(math.sqrt(2)))
    count, mean, deviation = spread([math.nan])
    assert count == 0
    assert math.isnan(mean)
    assert math.isnan(deviation)
