"""Statistics over episodes: mean, standard deviation and confidence intervals."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

__all__ = ["bootstrap", "bootstraps", "mcnemar", "nested_bootstraps", "newcombe", "spread", "wilson"]

_Z = 1.959963984540054
"""Quantile of the normal distribution for a two-sided interval of 95 %."""
_RESAMPLES = 10_000
"""Number of bootstrap resamples."""
_NESTED = 2_000
"""Number of resamples of a nested bootstrap."""
_SEED = 20_230_616
"""Fixed seed of the resamples, so that equal values always have the same interval."""
_BLOCK = 2_000_000
"""Number of values that are drawn at once."""
_MAX_CACHED = 5_000_000
"""Number of weights that are cached for the next call."""


def wilson(successes: float, count: int) -> tuple[float, float]:
    """95 % interval of a proportion (Wilson 1927); NaN for a count of 0."""
    if count < 1:
        return math.nan, math.nan
    share, z2 = successes / count, _Z**2
    middle = (share + z2 / (2 * count)) / (1 + z2 / count)
    half = _Z / (1 + z2 / count) * math.sqrt(share * (1 - share) / count + z2 / (4 * count**2))
    return (0.0 if successes == 0 else middle - half), (1.0 if successes == count else middle + half)


def newcombe(both: int, mine: int, other: int, neither: int) -> tuple[float, float]:
    """95 % interval of a difference of two paired shares (Newcombe 1998, paired data, method 10); NaN without pairs.

    The interval is not empty even if all pairs agree; a bootstrap of the pairs would be.

    Args:
        both: Number of pairs in which both episodes have the property.
        mine: Number of pairs in which only the first has it; the result is the first share minus the second.
        other: Number of pairs in which only the second has it.
        neither: Number of pairs in which neither has it.
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
    return bootstraps([values])[0]


def bootstraps(samples: Sequence[Sequence[float] | NDArray[np.float64]]) -> list[tuple[float, float]]:
    """The intervals of :func:`bootstrap` of several samples; those with as many values share the draws."""
    columns = [np.asarray(values, dtype=np.float64) for values in samples]
    columns = [column[~np.isnan(column)] for column in columns]
    intervals = [(math.nan, math.nan)] * len(columns)
    by_count: dict[int, list[int]] = {}
    for place, known in enumerate(columns):
        if len(known) >= 2 and (known == known[0]).all():
            intervals[place] = float(known[0]), float(known[0])
        elif len(known) >= 2:
            by_count.setdefault(len(known), []).append(place)
    for count, places in by_count.items():
        means: list[list[NDArray[np.float64]]] = [[] for _ in places]
        for weights in _resamples(count):
            for parts, place in zip(means, places, strict=True):
                parts.append(weights @ columns[place])
        for parts, place in zip(means, places, strict=True):
            low, high = np.percentile(np.concatenate(parts) / count, [2.5, 97.5])
            intervals[place] = float(low), float(high)
    return intervals


def nested_bootstraps(
    columns: Sequence[Sequence[float] | NDArray[np.float64]], groups: Sequence[int]
) -> list[tuple[float, float]]:
    """95 % intervals of the means of columns whose values come in groups, such as episodes of several scenarios.

    In each of 2,000 resamples groups are drawn with replacement, and values within each group that was drawn (Davison
    and Hinkley 1997, 3.8): values of one group may be more alike than values of different groups. Always the same
    draws. Values that are NaN are left out of their mean. NaN for a column of fewer than two values.

    Args:
        columns: Columns of N values.
        groups: Number of the group of each value, from 0 on; the values of a group lie together.
    """
    table = np.array([np.asarray(column, dtype=np.float64) for column in columns]).reshape(len(columns), -1).T
    known = ~np.isnan(table)
    table = np.where(known, table, 0.0)
    parts = []
    for weights in _nested(tuple(np.bincount(groups).tolist())):
        count = weights @ known
        with np.errstate(invalid="ignore"):
            parts.append(np.where(count > 0, weights @ table / count, np.nan))
    intervals = []
    for column, means in zip(known.T, np.concatenate(parts).T, strict=True):
        enough = int(column.sum()) >= 2
        low, high = np.nanpercentile(means, [2.5, 97.5]) if enough else (math.nan, math.nan)
        intervals.append((float(low), float(high)))
    return intervals


def mcnemar(mine: int, other: int) -> float:
    """Exact two-sided p-value of paired shares (McNemar 1947): whether either side has it alone equally often.

    Args:
        mine: Number of pairs in which only the first has the property.
        other: Number of pairs in which only the second has it.
    """
    n, few = mine + other, min(mine, other)
    return float(min(1.0, 2 * sum(math.comb(n, k) for k in range(few + 1)) / 2**n))


def _nested(sizes: tuple[int, ...]) -> Iterator[NDArray[np.float64]]:
    """Weights of values in groups of these sizes, in blocks of (resamples, values)."""
    if sum(sizes) * _NESTED <= _MAX_CACHED:
        yield _nested_weights(sizes)
        return
    rng = np.random.default_rng(_SEED)
    rows = max(1, _BLOCK // sum(sizes))
    for begin in range(0, _NESTED, rows):
        yield _draw_nested(rng, min(rows, _NESTED - begin), sizes)


@lru_cache(maxsize=2)
def _nested_weights(sizes: tuple[int, ...]) -> NDArray[np.float64]:
    return _draw_nested(np.random.default_rng(_SEED), _NESTED, sizes)


def _draw_nested(rng: np.random.Generator, rows: int, sizes: tuple[int, ...]) -> NDArray[np.float64]:
    size, begin = np.array(sizes), np.cumsum([0, *sizes[:-1]])
    groups = rng.integers(0, len(sizes), size=(rows, len(sizes)))
    within = (rng.random((rows, len(sizes), max(sizes))) * size[groups][:, :, None]).astype(np.int64)
    chosen = begin[groups][:, :, None] + within + (sum(sizes) * np.arange(rows))[:, None, None]
    taken = np.arange(max(sizes)) < size[groups][:, :, None]
    return np.bincount(chosen[taken], minlength=rows * sum(sizes)).reshape(rows, sum(sizes)).astype(np.float64)


def _resamples(count: int) -> Iterator[NDArray[np.float64]]:
    """Number of times that each of ``count`` values is drawn in each resample, in blocks of (resamples, count)."""
    if count * _RESAMPLES <= _MAX_CACHED:
        yield _weights(count)
        return
    rng = np.random.default_rng(_SEED)
    rows = max(1, _BLOCK // count)
    for begin in range(0, _RESAMPLES, rows):
        yield _draw(rng, min(rows, _RESAMPLES - begin), count)


@lru_cache(maxsize=2)
def _weights(count: int) -> NDArray[np.float64]:
    return _draw(np.random.default_rng(_SEED), _RESAMPLES, count)


def _draw(rng: np.random.Generator, rows: int, count: int) -> NDArray[np.float64]:
    chosen = rng.integers(0, count, size=(rows, count)) + count * np.arange(rows)[:, None]
    return np.bincount(chosen.ravel(), minlength=rows * count).reshape(rows, count).astype(np.float64)


def spread(values: Sequence[float]) -> tuple[int, float, float]:
    """Count, mean and sample standard deviation (n - 1) of the values that are not NaN."""
    known = [value for value in values if not math.isnan(value)]
    if not known:
        return 0, math.nan, math.nan
    mean = math.fsum(known) / len(known)
    if len(known) < 2:
        return 1, mean, math.nan
    return len(known), mean, math.sqrt(math.fsum((value - mean) ** 2 for value in known) / (len(known) - 1))
