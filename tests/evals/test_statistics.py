"""Statistics of pass rates, compared with closed forms and published numbers."""

from __future__ import annotations

import math

import pytest

import irsim.metrics
from irsim_evals.statistics import mcnemar, mean_pass_hat_k, paired_bootstrap, pass_hat_k, wilson


def test_wilson_without_trials_says_that_nothing_is_known():
    assert wilson(7, 10) == (0.7, *irsim.metrics.wilson(7, 10))
    interval = wilson(0, 0)
    assert math.isnan(interval.estimate)
    assert interval[1:] == (0.0, 1.0)


@pytest.mark.parametrize(("passed", "total"), [(3, 2), (-1, 2)])
def test_impossible_counts_are_an_error(passed, total):
    with pytest.raises(ValueError, match="not possible"):
        wilson(passed, total)
    with pytest.raises(ValueError, match="not possible"):
        pass_hat_k(passed, total, 1)


@pytest.mark.parametrize(
    ("passed", "total", "k", "chance"),
    [(3, 4, 1, 3 / 4), (3, 4, 2, 3 / 6), (3, 4, 3, 1 / 4), (3, 4, 4, 0), (5, 5, 5, 1)],
)
def test_pass_hat_k_counts_the_draws_that_all_pass(passed, total, k, chance):
    assert pass_hat_k(passed, total, k) == chance


@pytest.mark.parametrize(("k", "message"), [(3, "there are 2"), (0, "at least 1")])
def test_pass_hat_k_needs_k_attempts(k, message):
    with pytest.raises(ValueError, match=message):
        pass_hat_k(2, 2, k)


def test_mean_pass_hat_k_leaves_out_cases_with_few_attempts():
    assert mean_pass_hat_k([(3, 4), (4, 4), (1, 1)], 2) == pytest.approx((0.5 + 1) / 2)
    assert math.isnan(mean_pass_hat_k([(1, 1)], 2))


def test_mcnemar_is_the_binomial_tail():
    assert mcnemar(0, 0) == 1
    assert mcnemar(5, 5) == 1
    assert mcnemar(0, 6) == 2 / 64
    assert mcnemar(6, 0) == 2 / 64
    assert mcnemar(1, 7) == 2 * (1 + 8) / 256
    with pytest.raises(ValueError, match="not negative"):
        mcnemar(-1, 2)


@pytest.mark.parametrize(
    ("differences", "mean"), [({"a": [1, 1], "b": [1], "c": [1, 1, 1]}, 1), ({"a": [0, 1, 1, 0]}, 0.5)]
)
def test_paired_bootstrap_of_equal_differences_or_of_one_family_has_no_width(differences, mean):
    assert paired_bootstrap(differences) == (mean, mean, mean)


def test_paired_bootstrap_agrees_with_the_normal_approximation():
    count, share = 400, 0.25
    differences = {str(i): [1.0 if i < share * count else 0.0] for i in range(count)}
    interval = paired_bootstrap(differences)
    half = 1.96 * math.sqrt(share * (1 - share) / count)
    assert interval.estimate == share
    assert interval.low == pytest.approx(share - half, abs=0.005)
    assert interval.high == pytest.approx(share + half, abs=0.005)


def test_paired_bootstrap_draws_whole_families_and_the_same_ones_each_time():
    together = {"a": [1.0] * 10, "b": [0.0] * 10}
    alone = {f"a{i}": [1.0] for i in range(10)} | {f"b{i}": [0.0] for i in range(10)}
    wide, narrow = paired_bootstrap(together), paired_bootstrap(alone)
    assert wide.high - wide.low > narrow.high - narrow.low
    assert paired_bootstrap(together, seed=3) == paired_bootstrap(together, seed=3)
    assert math.isnan(paired_bootstrap({}).estimate)
