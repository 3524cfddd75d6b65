"""Over episodes: mean, spread and intervals."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

__all__ = ["bootstrap", "spread", "wilson"]

_Z = 1.959963984540054  # of the normal distribution, 95 % two-sided
_RESAMPLES = 10_000
_SEED = 20_230_616
_BLOCK = 2_000_000  # numbers drawn at once


def wilson(successes: int, count: int) -> tuple[float, float]:
    """95 % interval of a proportion (Wilson 1927); NaN for none at all."""
    if count < 1:
        return math.nan, math.nan
    share, z2 = successes / count, _Z**2
    middle = (share + z2 / (2 * count)) / (1 + z2 / count)
    half = _Z / (1 + z2 / count) * math.sqrt(share * (1 - share) / count + z2 / (4 * count**2))
    return (0.0 if successes == 0 else middle - half), (1.0 if successes == count else middle + half)


def bootstrap(values: Sequence[float] | NDArray[np.float64]) -> tuple[float, float]:
    """95 % interval of the mean: percentiles of 10,000 resampled means, always the same draws (Efron 1979).

    NaN for fewer than two values.
    """
    known = np.asarray(values, dtype=np.float64)
    known = known[~np.isnan(known)]
    if len(known) < 2:
        return math.nan, math.nan
    if (known == known[0]).all():
        return float(known[0]), float(known[0])
    rng = np.random.default_rng(_SEED)
    means = []
    left = _RESAMPLES
    while left:
        rows = min(left, max(1, _BLOCK // len(known)))
        means.append(known[rng.integers(0, len(known), size=(rows, len(known)))].mean(axis=1))
        left -= rows
    low, high = np.percentile(np.concatenate(means), [2.5, 97.5])
    return float(low), float(high)


def spread(values: Sequence[float]) -> tuple[int, float, float]:
    """Count, mean and standard deviation (of the sample, n - 1) of the values that are not NaN."""
    known = [value for value in values if not math.isnan(value)]
    if not known:
        return 0, math.nan, math.nan
    mean = math.fsum(known) / len(known)
    if len(known) < 2:
        return 1, mean, math.nan
    return len(known), mean, math.sqrt(math.fsum((value - mean) ** 2 for value in known) / (len(known) - 1))
