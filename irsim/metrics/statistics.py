"""Over episodes: mean, spread and intervals."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

__all__ = ["bootstrap", "newcombe", "spread", "wilson"]

_Z = 1.959963984540054  # of the normal distribution, 95 % two-sided
_RESAMPLES = 10_000
_SEED = 20_230_616
_BLOCK = 2_000_000  # numbers drawn at once
_KEPT = 5_000_000  # numbers remembered for the next call


def wilson(successes: int, count: int) -> tuple[float, float]:
    """95 % interval of a proportion (Wilson 1927); NaN for none at all."""
    if count < 1:
        return math.nan, math.nan
    share, z2 = successes / count, _Z**2
    middle = (share + z2 / (2 * count)) / (1 + z2 / count)
    half = _Z / (1 + z2 / count) * math.sqrt(share * (1 - share) / count + z2 / (4 * count**2))
    return (0.0 if successes == 0 else middle - half), (1.0 if successes == count else middle + half)


def newcombe(both: int, mine: int, other: int, neither: int) -> tuple[float, float]:
    """95 % interval of a difference of two paired shares (Newcombe 1998, paired data, method 10); NaN without pairs.

    It has a width also where all pairs agree, which resampling them would not give.

    Args:
        both: Pairs in which both have it.
        mine: Pairs in which only the one has it whose share the other's is taken from.
        other: Pairs in which only the other has it.
        neither: Pairs in which none has it.
    """
    n = both + mine + other + neither
    if n < 1:
        return math.nan, math.nan
    p, q = (both + mine) / n, (both + other) / n
    (p_low, p_high), (q_low, q_high) = wilson(both + mine, n), wilson(both + other, n)
    products = (both + mine) * (other + neither) * (both + other) * (mine + neither)
    excess = both * neither - mine * other
    corrected = max(excess - n / 2, 0.0) if excess > 0 else float(excess)
    phi = corrected / math.sqrt(products) if products else 0.0

    def reach(a: float, b: float) -> float:
        return math.sqrt(max(a * a - 2 * phi * a * b + b * b, 0.0))

    return p - q - reach(p - p_low, q_high - q), p - q + reach(p_high - p, q - q_low)


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
    means = np.concatenate([weights @ known for weights in _resamples(len(known))]) / len(known)
    low, high = np.percentile(means, [2.5, 97.5])
    return float(low), float(high)


def _resamples(count: int) -> Iterator[NDArray[np.float64]]:
    """How often each of ``count`` values is drawn in each resample, in blocks of (resamples, count)."""
    if count * _RESAMPLES <= _KEPT:
        yield _weights(count)
        return
    rng = np.random.default_rng(_SEED)
    rows = max(1, _BLOCK // count)
    for begin in range(0, _RESAMPLES, rows):
        yield _drawn(rng, min(rows, _RESAMPLES - begin), count)


@lru_cache(maxsize=2)
def _weights(count: int) -> NDArray[np.float64]:
    return _drawn(np.random.default_rng(_SEED), _RESAMPLES, count)


def _drawn(rng: np.random.Generator, rows: int, count: int) -> NDArray[np.float64]:
    chosen = rng.integers(0, count, size=(rows, count)) + count * np.arange(rows)[:, None]
    return np.bincount(chosen.ravel(), minlength=rows * count).reshape(rows, count).astype(np.float64)


def spread(values: Sequence[float]) -> tuple[int, float, float]:
    """Count, mean and standard deviation (of the sample, n - 1) of the values that are not NaN."""
    known = [value for value in values if not math.isnan(value)]
    if not known:
        return 0, math.nan, math.nan
    mean = math.fsum(known) / len(known)
    if len(known) < 2:
        return 1, mean, math.nan
    return len(known), mean, math.sqrt(math.fsum((value - mean) ** 2 for value in known) / (len(known) - 1))
