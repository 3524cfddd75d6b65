"""Comparisons of all policies of a benchmark: every pair of them, and their ranks, with intervals."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Mapping, Sequence

from irsim.benchmarks.incidents import placed
from irsim.benchmarks.summary import counts_once, first_of_each, is_summary, paired_differences
from irsim.metrics.statistics import mcnemar
from irsim.results.benchmark import BenchmarkRow, EpisodeRow, PolicyPair, PolicyRank

__all__ = ["lead", "pairs_of", "ranks_of"]

_KEY = "success"
"""The metric by which policies are compared."""


def pairs_of(
    summaries: Mapping[str, Sequence[EpisodeRow]],
    behaviors: Sequence[str],
    random: Mapping[str, Sequence[str]],
    certain: Mapping[str, Collection[str]],
) -> list[PolicyPair]:
    """Every pair of policies in every row, by the episodes with the same scenario and seed.

    Args:
        summaries: Episodes of each row, see :func:`irsim.benchmarks.summary.summaries_of`.
        behaviors: The policies, in order.
        random: The random parts of each scenario; where nothing is random there is nothing to compare.
        certain: Scenario → policies that nothing random reaches.
    """
    pairs = []
    for name, episodes in summaries.items():
        if not is_summary(name) and not random[name]:
            continue
        trials = _trials(episodes, behaviors)
        once = {one: counts_once([own for own in episodes if own.behavior == one], certain) for one in behaviors}
        for mine, other in itertools.combinations(range(len(behaviors)), 2):
            equal = once[behaviors[mine]] and once[behaviors[other]]
            counted = first_of_each(trials, lambda trial: trial[0].scenario) if equal else trials
            both = [(trial[mine], trial[other]) for trial in counted]
            if not both:
                continue
            exact = equal and not is_summary(name)
            wins = [(a.outcome == "success", b.outcome == "success") for a, b in both]
            only, others = wins.count((True, False)), wins.count((False, True))
            pairs.append(
                PolicyPair(
                    scenario=name,
                    behavior=behaviors[mine],
                    against=behaviors[other],
                    difference=paired_differences(both, [_KEY], [] if exact else [_KEY], together=is_summary(name))[
                        _KEY
                    ],
                    only_behavior=only,
                    only_against=others,
                    p=None if exact or is_summary(name) else mcnemar(only, others),
                )
            )
    return pairs


def ranks_of(rows: Sequence[BenchmarkRow], pairs: Sequence[PolicyPair]) -> list[PolicyRank]:
    """The rank of each policy in each row by the share of episodes that succeed.

    Its best rank is one more than the number of policies that are better for sure, its worst one the last less the
    number of the worse ones, by the intervals of the pairs (Mogstad et al. 2024, Inference for ranks).

    Args:
        rows: The rows.
        pairs: Every pair of policies in them.
    """
    result = []
    for row in rows:
        rates = [other.success.rate for other in rows if other.scenario == row.scenario]
        if len(rates) < 2:
            continue
        above = sum(rate > row.success.rate + 1e-12 for rate in rates)
        equal = sum(abs(rate - row.success.rate) <= 1e-12 for rate in rates)
        ahead = [lead(pair, row.behavior) for pair in pairs if pair.scenario == row.scenario]
        low, high = 1 + ahead.count(-1), len(rates) - ahead.count(1)
        rank = above + (equal + 1) / 2
        low, high = (low, high) if any(place is not None for place in ahead) else (above + 1, above + equal)
        result.append(PolicyRank(scenario=row.scenario, behavior=row.behavior, rank=rank, low=low, high=high))
    return result


def lead(pair: PolicyPair, behavior: str) -> int | None:
    """1 if a policy is better for sure than the other of a pair, -1 if worse, 0 if open; None if it is not in it.

    A difference without an interval is exact.
    """
    mean, low, high = pair.difference.mean, pair.difference.low, pair.difference.high
    if behavior not in (pair.behavior, pair.against) or mean is None:
        return None
    low, high = (mean, mean) if low is None or high is None else (low, high)
    sign = int(low > 0) - int(high < 0)
    return sign if behavior == pair.behavior else -sign


def _trials(episodes: Sequence[EpisodeRow], behaviors: Sequence[str]) -> list[list[EpisodeRow]]:
    """The episodes of all policies with the same scenario and seed.

    They are in the order of the first policy's episodes, as in the rows: intervals depend on the order of scenarios.
    """
    by_trial: dict[tuple[str, int], dict[str, EpisodeRow]] = {}
    for one in sorted(placed(episodes), key=lambda one: one.behavior != behaviors[0]):
        by_trial.setdefault((one.scenario, one.seed), {})[one.behavior] = one
    complete = [made for made in by_trial.values() if len(made) == len(behaviors)]
    return [[made[behavior] for behavior in behaviors] for made in complete]
