"""From episodes to a table: proportions, means and paired differences, with intervals."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from irsim.metrics.definitions import EPISODE_METRICS, METRICS
from irsim.metrics.statistics import bootstrap, newcombe, spread, wilson
from irsim.results.benchmark import BenchmarkRow, EpisodeRow, Estimate, Proportion

__all__ = ["ALL", "KEYS", "estimate", "notes_of", "proportion", "rows_of"]

ALL = "(all)"
KEYS = tuple(metric.key for metric in (*METRICS, *EPISODE_METRICS))
"""Metrics of an episode."""
_SHARES = frozenset(metric.key for metric in (*METRICS, *EPISODE_METRICS) if metric.unit == "0/1")
_MOST = 10
_FEWEST = 10
"""Scenarios of one episode each from which on something can be said of all together."""
_NAMED = 3
_TABLE = ((True, True), (True, False), (False, True), (False, False))


def proportion(count: int, n: int, *, certain: bool = False) -> Proportion:
    """A share with its interval; without one if nothing is random, as it cannot come out differently."""
    low, high = (None, None) if certain else wilson(count, n)
    return Proportion(count=count, n=n, rate=count / n, low=low, high=high)


def estimate(values: Sequence[float | None], *, share: bool = False) -> Estimate:
    """Mean, spread and interval of the values that are not None; with ``share`` they are 0 and 1."""
    known = [value for value in values if value is not None]
    n, mean, std = spread(known)
    low, high = wilson(sum(value > 0 for value in known), n) if share else bootstrap(known)
    return Estimate(n=n, mean=_known(mean), std=_known(std), low=_known(low), high=_known(high))


def rows_of(
    episodes: Sequence[EpisodeRow],
    scenarios: Sequence[str],
    behaviors: Sequence[str],
    random: Mapping[str, Sequence[str]],
) -> list[BenchmarkRow]:
    """Rows by scenario, then behavior, of which there are episodes; then of all together, if they weigh the same.

    Args:
        episodes: Those that are done.
        scenarios: Their scenarios, in order.
        behaviors: Their behaviors, in order.
        random: What the seed decides in each scenario.
    """
    groups = {name: [episode for episode in episodes if episode.scenario == name] for name in scenarios}
    sizes = {len(group) for group in groups.values()}
    once = sizes == {len(behaviors)}  # one episode of each
    if len(sizes) == 1 and len(scenarios) >= (_FEWEST if once else 2):
        groups[ALL] = list(episodes)
    rows = []
    for name, chosen in groups.items():
        first = {_pair(episode): episode for episode in chosen if episode.behavior == behaviors[0]}
        certain = name != ALL and not random[name]
        for behavior in behaviors:
            mine = [episode for episode in chosen if episode.behavior == behavior]
            if not mine:  # none is done yet
                continue
            rows.append(_row(name, behavior, mine, first if behavior != behaviors[0] else {}, certain))
    return rows


def notes_of(episodes: Sequence[EpisodeRow], random: Mapping[str, Sequence[str]], seeds: Sequence[int]) -> list[str]:
    """What to know before reading the rows.

    Args:
        episodes: Those that are done.
        random: What the seed decides in each scenario.
        seeds: All that were asked for.
    """
    notes = []
    fixed = [name for name, chance in random.items() if not chance]
    if fixed and len(seeds) > 1:
        notes.append(
            f"{_some(fixed)}: nothing is random, so every seed gives the same run and one was made; random placement "
            "or motion noise would make seeds differ"
        )
    lost = sorted({episode.scenario for episode in episodes if episode.unreachable})
    if lost:
        count = sum(bool(episode.unreachable) for episode in episodes)
        notes.append(f"{_some(lost)}: in {count} episodes no way to a goal was found; spl is left out there")
    cut = sorted({e.scenario for e in episodes if e.outcome == "timeout" and e.sim_time < e.time_limit - 1e-9})
    if cut:
        notes.append(f"{_some(cut)}: episodes ended early with robots that stopped without arriving")
    return notes


def _some(names: Sequence[str]) -> str:
    more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
    return ", ".join(names[:_NAMED]) + more


def _row(
    name: str, behavior: str, episodes: list[EpisodeRow], first: dict[Any, EpisodeRow], certain: bool
) -> BenchmarkRow:
    outcomes = [episode.outcome for episode in episodes]
    shares: dict[str, Any] = {
        outcome: proportion(outcomes.count(outcome), len(outcomes), certain=certain)
        for outcome in ("success", "collision", "timeout")
    }
    pairs = [(episode, first[_pair(episode)]) for episode in episodes if _pair(episode) in first]
    return BenchmarkRow(
        scenario=name,
        behavior=behavior,
        episodes=len(episodes),
        metrics={
            key: estimate([episode.metrics[key] for episode in episodes], share=key in _SHARES and not certain)
            for key in KEYS
        },
        paired={
            key: _compared([(a.metrics[key], b.metrics[key]) for a, b in pairs], key in _SHARES and not certain)
            for key in KEYS
            if pairs
        },
        failed={
            outcome: [episode.seed for episode in episodes if episode.outcome == outcome]
            for outcome in ("collision", "timeout")
            if outcome in outcomes and name != ALL
        },
        failures={} if name == ALL else _counted(episodes),
        **shares,
    )


def _counted(episodes: Sequence[EpisodeRow]) -> dict[str, int]:
    count = Counter(f"{robot!r}: {fate}" for episode in episodes for robot, fate in episode.failures.items())
    return dict(count.most_common(_MOST))


def _compared(pairs: Sequence[tuple[float | None, float | None]], share: bool) -> Estimate:
    """Differences of pairs; that of shares with an interval that does not vanish where all pairs agree."""
    known = [(a, b) for a, b in pairs if a is not None and b is not None]
    found = estimate([a - b for a, b in known])
    if share and known:
        count = Counter((a > 0, b > 0) for a, b in known)
        found.low, found.high = newcombe(*(count[pair] for pair in _TABLE))
    return found


def _pair(episode: EpisodeRow) -> tuple[str, int]:
    return episode.scenario, episode.seed


def _known(value: float) -> float | None:
    return None if math.isnan(value) else value
