"""Summarise the episodes of a benchmark: proportions, means and paired differences, with intervals."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from typing import Any, get_args

from irsim.benchmarks.suite import Protocol
from irsim.common.text import listed, plural
from irsim.metrics.definitions import EPISODE_METRICS, METRICS
from irsim.metrics.statistics import bootstraps, newcombe, spread, wilson
from irsim.results.benchmark import CROWDED, LOST, BenchmarkRow, EpisodeRow, Estimate, Proportion

__all__ = [
    "ALL",
    "KEYS",
    "incident_messages",
    "incident_seeds",
    "is_summary",
    "notes_of",
    "placed",
    "proportion",
    "protocols_of",
    "rows_of",
]

ALL = "(all)"
"""Name of the rows over all scenarios; with several protocols the rows of one are ``(all)/PROTOCOL``."""
KEYS = tuple(metric.key for metric in (*METRICS, *EPISODE_METRICS))
"""Keys of the metrics of an episode."""
_PROPORTIONS = frozenset(metric.key for metric in (*METRICS, *EPISODE_METRICS) if metric.unit == "0/1")
"""Keys of the metrics that are 0 or 1."""
_MAX_FAILURES = 10
"""Number of failures that a row lists, the most frequent ones."""
_MIN_SCENARIOS = 10
"""Number of scenarios with one episode each from which on they are summarised together."""
_MAX_NAMED = 3
"""Number of scenarios that a note names."""
_TABLE = ((True, True), (True, False), (False, True), (False, False))
"""Order of the counts that :func:`irsim.metrics.statistics.newcombe` takes."""


def proportion(count: int, n: int, *, certain: bool = False) -> Proportion:
    """A proportion with its interval.

    Args:
        count: Number of episodes with the property.
        n: Number of all episodes.
        certain: Nothing is random, so there is no interval.
    """
    low, high = (None, None) if certain else wilson(count, n)
    return Proportion(count=count, n=n, rate=count / n, low=low, high=high)


def estimates(columns: Mapping[str, Sequence[float | None]], shares: Collection[str] = ()) -> dict[str, Estimate]:
    """Mean, standard deviation and interval of the values of each column that are not None.

    Args:
        columns: Name → values.
        shares: Names of columns whose values are all 0 or 1: they get the interval of a proportion.
    """
    known = {name: [value for value in values if value is not None] for name, values in columns.items()}
    others = [name for name in known if name not in shares]
    intervals = dict(zip(others, bootstraps([known[name] for name in others]), strict=True))
    result = {}
    for name, values in known.items():
        n, mean, std = spread(values)
        low, high = intervals[name] if name in intervals else wilson(sum(value > 0 for value in values), n)
        result[name] = Estimate(n=n, mean=_known(mean), std=_known(std), low=_known(low), high=_known(high))
    return result


def is_summary(name: str) -> bool:
    """Whether a row with this name is one over all scenarios, or over all of one protocol."""
    return name.partition("/")[0] == ALL


def protocols_of(scenarios: Sequence[str]) -> dict[str, str]:
    """Protocol of each scenario, otherwise ``as-written``.

    It is the last part of the name ``NAME/PROTOCOL`` that the scenarios of a suite with several protocols have.

    Args:
        scenarios: Names of the scenarios.
    """
    last = {name: name.rpartition("/")[2] for name in scenarios}
    return {name: part if part in get_args(Protocol) else "as-written" for name, part in last.items()}


def rows_of(
    episodes: Sequence[EpisodeRow],
    scenarios: Sequence[str],
    behaviors: Sequence[str],
    random: Mapping[str, Sequence[str]],
    protocols: Mapping[str, str] | None = None,
) -> list[BenchmarkRow]:
    """Rows by scenario and behavior, then over all scenarios if each has the same number of episodes.

    Scenarios of different protocols are never summarised together, because the same start and seed would count twice.

    Args:
        episodes: The episodes that are done.
        scenarios: The scenarios, in order.
        behaviors: The behaviors, in order.
        random: The random parts of each scenario.
        protocols: The protocol of each scenario; None: all have the same.
    """
    groups = {name: [episode for episode in episodes if episode.scenario == name] for name in scenarios}
    together = dict[str, list[str]]()
    for name in scenarios:
        together.setdefault("" if protocols is None else protocols[name], []).append(name)
    for protocol, names in together.items():
        sizes = {len(groups[name]) for name in names}
        once = sizes == {len(behaviors)}  # one episode per scenario and behavior
        if len(sizes) == 1 and len(names) >= (_MIN_SCENARIOS if once else 2):
            summary = ALL if len(together) == 1 else f"{ALL}/{protocol}"
            groups[summary] = [episode for name in names for episode in groups[name]]
    rows = []
    for name, chosen in groups.items():
        first = {_pair(episode): episode for episode in chosen if episode.behavior == behaviors[0]}
        certain = not is_summary(name) and not random[name]
        for behavior in behaviors:
            mine = [episode for episode in chosen if episode.behavior == behavior]
            if not placed(mine):  # no episode is done yet, or no seed has room
                continue
            rows.append(_row(name, behavior, mine, first if behavior != behaviors[0] else {}, certain))
    return rows


def perturbation_notes(changes: Mapping[str, Sequence[str]]) -> list[str]:
    """Notes about what each seed changes in each scenario; one note if it is the same in all.

    Args:
        changes: The changes by each seed in each scenario, in words.
    """
    notes = {name: f"perturbed, drawn uniformly for each seed: {'; '.join(parts)}" for name, parts in changes.items()}
    if len(set(notes.values())) == 1:
        return list(notes.values())[:1]
    return [f"{name}: {note}" for name, note in notes.items()]


def notes_of(episodes: Sequence[EpisodeRow], random: Mapping[str, Sequence[str]], seeds: Sequence[int]) -> list[str]:
    """Notes that a reader of the rows must know.

    Args:
        episodes: The episodes that are done.
        random: The random parts of each scenario.
        seeds: All seeds of the benchmark.
    """
    notes = []
    fixed = [name for name, chance in random.items() if not chance]
    if fixed and len(seeds) > 1:
        notes.append(
            f"{listed(fixed, _MAX_NAMED)}: nothing is random that these policies notice, so every seed gives the same "
            "run and only one was simulated; random placement, motion noise or perturb would make seeds differ"
        )
    lost = sorted({episode.scenario for episode in episodes if episode.unreachable})
    if lost:
        count = sum(bool(episode.unreachable) for episode in episodes)
        missing = f"in {count} episodes no path to a goal was found; spl is left out there"
        notes.append(f"{listed(lost, _MAX_NAMED)}: {missing}")
    early = [e for e in episodes if e.outcome == "timeout" and e.sim_time < e.time_limit - 1e-9 and e.lost is None]
    cut = sorted({e.scenario for e in early})
    if cut:
        notes.append(f"{listed(cut, _MAX_NAMED)}: episodes ended early with robots that stopped without arriving")
    return notes


def _row(
    name: str, behavior: str, every: list[EpisodeRow], first: dict[Any, EpisodeRow], certain: bool
) -> BenchmarkRow:
    episodes = placed(every)
    outcomes = [episode.outcome for episode in episodes]
    shares: dict[str, Any] = {
        outcome: proportion(outcomes.count(outcome), len(outcomes), certain=certain)
        for outcome in ("success", "collision", "timeout")
    }
    pairs = [(episode, first[_pair(episode)]) for episode in episodes if _pair(episode) in first]
    shown_as_shares = frozenset() if certain else _PROPORTIONS
    return BenchmarkRow(
        scenario=name,
        behavior=behavior,
        episodes=len(episodes),
        metrics=estimates({key: [episode.metrics[key] for episode in episodes] for key in KEYS}, shown_as_shares),
        paired=_paired_differences(pairs, shown_as_shares) if pairs else {},
        zones={} if is_summary(name) else _zones(episodes),
        failed={
            outcome: [episode.seed for episode in episodes if episode.outcome == outcome]
            for outcome in ("collision", "timeout")
            if outcome in outcomes and not is_summary(name)
        },
        failures={} if is_summary(name) else _frequent_failures(episodes),
        incidents=incident_counts(every),
        incident_seeds={} if is_summary(name) else incident_seeds(every),
        **shares,
    )


def _zones(episodes: list[EpisodeRow]) -> dict[str, dict[str, Estimate]]:
    """Estimates of the metrics of each zone; episodes that were measured have the same zones."""
    measured = [episode.zones for episode in episodes if episode.zones]
    return {
        zone: estimates({key: [zones[zone][key] for zones in measured] for key in values})
        for zone, values in (measured[0] if measured else {}).items()
    }


def _frequent_failures(episodes: Sequence[EpisodeRow]) -> dict[str, int]:
    count = Counter(f"{robot!r}: {fate}" for episode in episodes for robot, fate in episode.failures.items())
    return dict(count.most_common(_MAX_FAILURES))


def _paired_differences(pairs: Sequence[tuple[EpisodeRow, EpisodeRow]], shares: Collection[str]) -> dict[str, Estimate]:
    """Estimates of the differences of pairs; for shares with an interval that is not empty if all pairs agree."""
    values = {key: [(a.metrics[key], b.metrics[key]) for a, b in pairs] for key in KEYS}
    known = {key: [(a, b) for a, b in both if a is not None and b is not None] for key, both in values.items()}
    differences = estimates({key: [a - b for a, b in both] for key, both in known.items()})
    for key in shares:
        if known[key]:
            count = Counter((a > 0, b > 0) for a, b in known[key])
            differences[key].low, differences[key].high = newcombe(*(count[pair] for pair in _TABLE))
    return differences


def _pair(episode: EpisodeRow) -> tuple[str, int]:
    return episode.scenario, episode.seed


def _known(value: float) -> float | None:
    return None if math.isnan(value) else value


_MAX_SEEDS = 5
"""Number of seeds without room that a message lists."""
_MAX_HEADLINE_SEEDS = 3
"""Number of seeds of an incident that a message lists."""


def placed(episodes: Sequence[EpisodeRow]) -> list[EpisodeRow]:
    """The episodes that took place: those whose seed had room for every object."""
    return [episode for episode in episodes if episode.outcome != CROWDED]


def incident_counts(episodes: Sequence[EpisodeRow]) -> dict[str, int]:
    """Number of episodes by incident; incidents that did not occur are left out."""
    return {key: len(affected) for key, affected in _episodes_with(episodes).items() if affected}


def incident_seeds(episodes: Sequence[EpisodeRow]) -> dict[str, list[int]]:
    """Seeds of the episodes of one row by incident; incidents that did not occur are left out."""
    return {
        key: sorted(episode.seed for episode in affected)
        for key, affected in _episodes_with(episodes).items()
        if affected
    }


def _episodes_with(episodes: Sequence[EpisodeRow]) -> dict[str, list[EpisodeRow]]:
    """Episodes with each incident."""
    return {
        "human_contacts": [episode for episode in episodes if episode.human_contacts > 0],
        "left": [episode for episode in episodes if episode.left],
        "jumped": [episode for episode in episodes if episode.jumped],
        "contacts_between_steps": [
            episode for episode in episodes if (episode.metrics.get("contacts_between_steps") or 0.0) > 0.0
        ],
        "seen": [episode for episode in episodes if (episode.metrics.get("seen_ratio") or 0.0) > 0.0],
        LOST: [episode for episode in episodes if episode.lost],
        CROWDED: [episode for episode in episodes if episode.outcome == CROWDED],
    }


def _seeds(seeds: Sequence[int]) -> str:
    """The first seeds in words, each once: ``seeds 1, 4, 7 and 2 more``."""
    each = sorted(set(seeds))
    return f"seed{'s' * (len(each) > 1)} {listed([str(seed) for seed in each], _MAX_HEADLINE_SEEDS)}"


def incident_messages(episodes: Sequence[EpisodeRow]) -> list[str]:
    """Incidents besides outcomes, with the number of episodes; empty without incidents.

    Args:
        episodes: The episodes of all scenarios and behaviors.
    """
    messages, seeds_of = list[str](), incident_seeds(episodes)
    words = {
        "contacts_between_steps": "robots touched something between steps in",
        "human_contacts": "contacts between people, or other moving obstacles, in",
        "left": "objects left the world in",
        "jumped": "objects jumped over their goal in",
        "seen": "robots were seen in",
    }
    for key, what in words.items():
        if key in seeds_of:
            contacts = sum(episode.human_contacts for episode in episodes) if key == "human_contacts" else 0
            count = f"{plural(contacts, 'contact')}; " if contacts else ""
            where = f"({count}{_seeds(seeds_of[key])})"
            messages.append(f"{what} {len(seeds_of[key])} of {len(placed(episodes))} episodes {where}")
    if LOST in seeds_of:
        why = next(episode.lost for episode in episodes if episode.lost)
        many = f"{len(seeds_of[LOST])} of {len(placed(episodes))} episodes"
        messages.append(f"the policy was lost in {many} ({_seeds(seeds_of[LOST])}), which ended there: {why}")
    for name in dict.fromkeys(episode.scenario for episode in episodes):
        mine = [episode for episode in episodes if episode.scenario == name]
        crowded = sorted({episode.seed for episode in mine if episode.outcome == CROWDED})
        if crowded:
            where = f" of {name}" if len({episode.scenario for episode in episodes}) > 1 else ""
            count = f"{len(crowded)} of {len({episode.seed for episode in mine})} seeds{where}"
            seeds = listed([str(seed) for seed in crowded], _MAX_SEEDS)
            messages.append(f"{count} had no room and do not count ({CROWDED}): {seeds}")
    return messages
