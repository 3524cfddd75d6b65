"""From episodes to a table: proportions, means and paired differences, with intervals."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from irsim.metrics.definitions import METRICS
from irsim.metrics.statistics import bootstrap, spread, wilson
from irsim.results import BenchmarkRow, EpisodeRow, Estimate, Proportion

__all__ = ["ALL", "KEYS", "estimate", "proportion", "rows_of"]

ALL = "(all)"
KEYS = (*(metric.key for metric in METRICS), "aggregated_time")
"""Metrics of an episode."""


def proportion(count: int, n: int) -> Proportion:
    """A share with its interval."""
    low, high = wilson(count, n)
    return Proportion(count=count, n=n, rate=count / n, low=low, high=high)


def estimate(values: Sequence[float | None]) -> Estimate:
    """Mean, spread and interval of the values that are not None."""
    known = [value for value in values if value is not None]
    n, mean, std = spread(known)
    low, high = bootstrap(known)
    return Estimate(n=n, mean=_known(mean), std=_known(std), low=_known(low), high=_known(high))


def rows_of(episodes: Sequence[EpisodeRow], scenarios: Sequence[str], behaviors: Sequence[str]) -> list[BenchmarkRow]:
    """Rows by scenario, then behavior; then of all scenarios together, if there are several.

    Args:
        episodes: All of them.
        scenarios: Their scenarios, in order.
        behaviors: Their behaviors, in order.
    """
    groups = {name: [episode for episode in episodes if episode.scenario == name] for name in scenarios}
    if len(scenarios) > 1:
        groups[ALL] = list(episodes)
    rows = []
    for name, chosen in groups.items():
        first = {_pair(episode): episode for episode in chosen if episode.behavior == behaviors[0]}
        for behavior in behaviors:
            mine = [episode for episode in chosen if episode.behavior == behavior]
            rows.append(_row(name, behavior, mine, first if behavior != behaviors[0] else {}))
    return rows


def _row(name: str, behavior: str, episodes: list[EpisodeRow], first: dict[Any, EpisodeRow]) -> BenchmarkRow:
    outcomes = [episode.outcome for episode in episodes]
    shares: dict[str, Any] = {
        outcome: proportion(outcomes.count(outcome), len(outcomes)) for outcome in ("success", "collision", "timeout")
    }
    paired = {}
    if first:
        pairs = [(episode, first[_pair(episode)]) for episode in episodes]
        paired = {key: estimate([_difference(a.metrics[key], b.metrics[key]) for a, b in pairs]) for key in KEYS}
    return BenchmarkRow(
        scenario=name,
        behavior=behavior,
        episodes=len(episodes),
        metrics={key: estimate([episode.metrics[key] for episode in episodes]) for key in KEYS},
        paired=paired,
        **shares,
    )


def _pair(episode: EpisodeRow) -> tuple[str, int]:
    return episode.scenario, episode.seed


def _difference(a: float | None, b: float | None) -> float | None:
    return None if a is None or b is None else a - b


def _known(value: float) -> float | None:
    return None if math.isnan(value) else value
