"""Tests of random numbers with fixed seeds: do they come from the distribution that was asked for?"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np


def normal_below(z: np.ndarray) -> np.ndarray:
    """Share of the standard normal distribution below each value."""
    return np.array([0.5 * math.erfc(-value / math.sqrt(2)) for value in z])


def kolmogorov(values: np.ndarray, below: Callable[[np.ndarray], np.ndarray]) -> float:
    """How likely values are that differ at least this much from a distribution, by the test of Kolmogorov-Smirnov."""
    count, shares = len(values), below(np.sort(values))
    steps = np.arange(count + 1) / count
    apart = max(float((steps[1:] - shares).max()), float((shares - steps[:-1]).max()))
    reach = (math.sqrt(count) + 0.12 + 0.11 / math.sqrt(count)) * apart
    return min(1.0, 2 * sum((-1) ** (k - 1) * math.exp(-2 * (k * reach) ** 2) for k in range(1, 101)))


def assert_standard_normal(z: np.ndarray) -> None:
    """Mean, variance and shape are as in the standard normal distribution."""
    count = len(z)
    assert abs(z.mean()) <= 4 / math.sqrt(count)
    assert abs(float(z @ z) - count) <= 4 * math.sqrt(2 * count)
    assert kolmogorov(z, normal_below) > 1e-3


def assert_uniform(values: np.ndarray, low: float, high: float) -> None:
    assert kolmogorov(values, lambda v: np.clip((v - low) / (high - low), 0, 1)) > 1e-3


def assert_share(hits: np.ndarray, share: float) -> None:
    """Events come as often as asked for, within four standard deviations."""
    count = len(hits)
    assert abs(int(hits.sum()) - share * count) <= 4 * math.sqrt(share * (1 - share) * count)
