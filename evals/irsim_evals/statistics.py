"""Statistics of pass rates: pure functions of counts."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from irsim.metrics import statistics

__all__ = ["Interval", "mcnemar", "mean_pass_hat_k", "paired_bootstrap", "pass_hat_k", "sign_flip", "wilson"]

_SAMPLES = 10_000
"""Number of draws of a bootstrap."""


class Interval(NamedTuple):
    """An estimate and the interval around it."""

    estimate: float
    low: float
    high: float


def wilson(passed: float, total: int) -> Interval:
    """Share of passes with Wilson's score interval of 95 %; without trials nothing is known, and it is 0 to 1.

    Args:
        passed: Number of passes; with shares of passes, their sum.
        total: Number of trials, at least as many.
    """
    _check_counts(passed, total)
    return Interval(passed / total, *statistics.wilson(passed, total)) if total else Interval(math.nan, 0.0, 1.0)


def pass_hat_k(passed: int, total: int, k: int) -> float:
    """Estimated chance that all of ``k`` attempts at one case pass: C(passed, k) / C(total, k).

    Args:
        passed: Number of attempts that passed.
        total: Number of attempts, at least ``k``.
        k: Number of attempts that must all pass, at least 1.

    References:
        Yao et al.: tau-bench (2024), section 3.
    """
    _check_counts(passed, total)
    if not 1 <= k <= total:
        raise ValueError(f"pass^{k} needs at least {max(k, 1)} attempts and a k of at least 1; there are {total}")
    return math.comb(passed, k) / math.comb(total, k)


def mean_pass_hat_k(attempts: Iterable[tuple[int, int]], k: int) -> float:
    """Mean of pass^k over cases with ``(passed, total)`` attempts, of which at least ``k``; NaN without cases."""
    values = [pass_hat_k(passed, total, k) for passed, total in attempts if total >= k]
    return math.fsum(values) / len(values) if values else math.nan


def mcnemar(only_first: int, only_second: int) -> float:
    """Exact two-sided p value of McNemar's test, from the numbers of pairs of which only one passes.

    It is the probability of a split at least this uneven if both were equally good; 1 if no pair differs.
    """
    if min(only_first, only_second) < 0:
        raise ValueError("numbers of pairs are not negative")
    return statistics.mcnemar(only_first, only_second)


def paired_bootstrap(differences: Mapping[str, Sequence[float]], *, seed: int = 0) -> Interval:
    """Mean difference over all pairs with a percentile interval of 95 %, drawn by family; NaN without pairs.

    Cases of one family share a base, so whole families are drawn, with replacement.

    Args:
        differences: Family → difference of each of its pairs, second minus first.
        seed: Seed of the draws.
    """
    families = [(math.fsum(values), len(values)) for _, values in sorted(differences.items()) if len(values)]
    if not families:
        return Interval(math.nan, math.nan, math.nan)
    table = np.array(families, dtype=float)
    drawn = np.random.default_rng(seed).integers(0, len(families), (_SAMPLES, len(families)))
    sums = table[drawn].sum(axis=1)
    low, high = np.quantile(sums[:, 0] / sums[:, 1], [0.025, 0.975])
    return Interval(float(table[:, 0].sum() / table[:, 1].sum()), float(low), float(high))


def sign_flip(differences: Mapping[str, Sequence[float]], *, seed: int = 0) -> float:
    """Two-sided p value of a paired permutation test of the mean difference, by family; 1 without pairs.

    Were both equally good, the differences of each family might as well have the other sign, so this is the share of
    signs with a mean at least as far from 0. With few families all signs are tried, else as many as a bootstrap draws.

    Args:
        differences: Family → difference of each of its pairs.
        seed: Seed of the draws.
    """
    sums = np.array([math.fsum(values) for _, values in sorted(differences.items()) if len(values)])
    if not len(sums):
        return 1.0
    if 2 ** len(sums) <= _SAMPLES:
        drawn = np.arange(2 ** len(sums))[:, None] >> np.arange(len(sums)) & 1
    else:
        drawn = np.random.default_rng(seed).integers(0, 2, (_SAMPLES, len(sums)))
        drawn[0] = 1
    totals = np.abs((2 * drawn - 1) @ sums)
    return float(np.mean(totals >= abs(sums.sum()) * (1 - 1e-9)))


def _check_counts(passed: float, total: int) -> None:
    if not 0 <= passed <= total:
        raise ValueError(f"{passed} passes of {total} trials are not possible")
