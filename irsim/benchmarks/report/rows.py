"""Contents of a report of a result: names of scenarios and policies, rows in their order, and the worst episodes."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from irsim.benchmarks.labels import labels_of
from irsim.benchmarks.summary import is_summary
from irsim.policies.catalog import SUFFIXES
from irsim.results.benchmark import BenchmarkResult, BenchmarkRow, EpisodeRow, PolicyRank, SuiteResult

__all__ = [
    "RANKS",
    "families",
    "policy_labels",
    "protocols",
    "rank_text",
    "series",
    "shown_ranks",
    "worst_episodes",
]

RANKS = "Ranks by success, and the ranks that the intervals of all pairs allow"
"""The heading of the ranks."""


def policy_labels(result: BenchmarkResult) -> dict[str, str]:
    """Policy as the rows have it → name; of a file without its folders, if that is unambiguous."""
    if isinstance(result, SuiteResult):
        labels = {text: name for name, text in result.policies.items()}
    else:
        files = {text: text for text in result.behaviors if text.endswith(SUFFIXES)}
        labels = labels_of(result.behaviors) | files
    for parts in (1, 2):
        short = {text: _shortened(label, parts) for text, label in labels.items()}
        if len(set(short.values())) == len(labels):
            return short
    return labels


def _shortened(label: str, parts: int) -> str:
    """The last parts of the path of a file; other labels as they are."""
    return "/".join(Path(label).parts[-parts:]) if label.endswith(SUFFIXES) else label


def families(result: BenchmarkResult) -> Iterator[tuple[str, str, list[tuple[dict[str, Any], str]]]]:
    """Family, protocol, and (values, name) of its scenarios, of each family of a suite with several scenarios."""
    if not isinstance(result, SuiteResult):
        return
    keys = list(dict.fromkeys((fact.family, fact.protocol) for fact in result.facts))
    for family, protocol in keys:
        own = [(f.values, f.name) for f in result.facts if (f.family, f.protocol) == (family, protocol)]
        if len(own) > 1:
            yield family, protocol, own


def protocols(result: BenchmarkResult) -> dict[str, set[str]]:
    """Protocol → its scenarios, of a suite with several protocols; otherwise all scenarios without a name."""
    of_protocol = dict[str, set[str]]()
    for fact in result.facts if isinstance(result, SuiteResult) else ():
        of_protocol.setdefault(fact.protocol, set()).add(fact.name)
    return of_protocol if len(of_protocol) > 1 else {"": set(result.scenarios)}


def series(result: BenchmarkResult, names: list[str], behavior: str) -> list[BenchmarkRow]:
    """The rows of a policy on some scenarios, in the order of the names."""
    of_scenario = {row.scenario: row for row in result.rows if row.behavior == behavior}
    return [of_scenario[name] for name in names if name in of_scenario]


def shown_ranks(result: BenchmarkResult) -> dict[str, list[PolicyRank]]:
    """Name of each row over several scenarios, or else of each row, → its ranks, the best policy first.

    Empty with fewer than three policies, whose ranks their differences say.
    """
    wide = [one for one in result.ranks if is_summary(one.scenario)] or result.ranks
    ranks: dict[str, list[PolicyRank]] = {}
    for one in wide if len(result.behaviors) > 2 else ():
        ranks.setdefault(one.scenario, []).append(one)
    return {name: sorted(of_row, key=lambda one: one.rank) for name, of_row in ranks.items()}


def rank_text(one: PolicyRank) -> str:
    """A rank with the ranks that the intervals allow."""
    return f"{one.rank:g} ({one.low} to {one.high})"


MAX_WORST = 2
"""Number of episodes that are shown of each policy."""
_ORDER = {"collision": 0, "timeout": 1}


def worst_episodes(result: BenchmarkResult) -> list[EpisodeRow]:
    """For each policy some failed episodes, each of another scenario.

    Scenarios in which the policy fails least often come first, collisions before time-outs, low seeds first.
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
