"""The episodes of a benchmark that went worst: those that a reader wants to look at."""

from __future__ import annotations

from irsim.results.benchmark import BenchmarkResult, EpisodeRow

__all__ = ["MAX_WORST", "worst_episodes"]

MAX_WORST = 2
"""Number of episodes that are shown of each policy."""
_ORDER = {"collision": 0, "timeout": 1}


def worst_episodes(result: BenchmarkResult) -> list[EpisodeRow]:
    """For each policy some failed episodes, each of another scenario.

    Those of scenarios in which the policy fails least often come first, collisions before time-outs, low seeds first.
    """
    rates = {(row.scenario, row.behavior): row.success.rate for row in result.rows}
    chosen: list[EpisodeRow] = []
    for behavior in result.behaviors:
        failed = [one for one in result.episodes if one.behavior == behavior and one.outcome in _ORDER]
        failed.sort(key=lambda one: (-rates.get((one.scenario, behavior), 0.0), _ORDER[one.outcome], one.seed))
        seen: set[str] = set()
        for one in failed:
            if one.scenario not in seen and len(seen) < MAX_WORST:
                seen.add(one.scenario)
                chosen.append(one)
    return chosen
