"""Summarise the episodes of a benchmark: proportions, means and paired differences, with intervals."""

from __future__ import annotations

import math
import operator
from collections import Counter
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import TypeVar, get_args

from irsim.benchmarks.incidents import incident_counts, incident_seeds, placed
from irsim.benchmarks.suite import Protocol
from irsim.common.text import listed
from irsim.metrics.definitions import EPISODE_METRICS, METRICS
from irsim.metrics.statistics import bootstraps, nested_bootstraps, newcombe, spread, wilson
from irsim.results.benchmark import BenchmarkResult, BenchmarkRow, EpisodeRow, Estimate, Proportion

__all__ = [
    "ALL",
    "KEYS",
    "PERTURBED",
    "counts_once",
    "first_of_each",
    "grouped_notes",
    "is_summary",
    "notes_of",
    "paired_differences",
    "protocols_of",
    "rows_of",
    "summaries_of",
]

_T = TypeVar("_T")

ALL = "(all)"
"""Name of the rows over all scenarios; with several protocols the rows of one are ``(all)/PROTOCOL``."""
KEYS = tuple(metric.key for metric in (*METRICS, *EPISODE_METRICS))
"""Keys of the metrics of an episode."""
PERTURBED = "perturbed, drawn uniformly for each seed"
"""The words of notes about what each seed changes; other notes are warnings."""
_PROPORTIONS = frozenset(metric.key for metric in (*METRICS, *EPISODE_METRICS) if metric.unit == "0/1")
"""Keys of the metrics that are 0 or 1."""
_OUTCOMES = ("success", "collision", "timeout")
"""Outcomes of an episode, which are metrics, too."""
_MAX_FAILURES = 10
"""Number of failures that a row lists, the most frequent ones."""
_MIN_SCENARIOS = 10
"""Number of scenarios with one episode each from which on they are summarised together."""
_MAX_NAMED = 3
"""Number of scenarios that a note names."""
_TABLE = ((True, True), (True, False), (False, True), (False, False))
"""Order of the counts that :func:`irsim.metrics.statistics.newcombe` takes."""


def estimates(
    columns: Mapping[str, Sequence[float | None]],
    shares: Collection[str] = (),
    scenarios: Sequence[str] | None = None,
) -> dict[str, Estimate]:
    """Mean, standard deviation and interval of the values of each column that are not None.

    Args:
        columns: Name → values.
        shares: Names of columns whose values are all 0 or 1: they get the interval of a proportion.
        scenarios: Scenario of each value, in their order, for a summary of several scenarios: they are resampled
            with their values, and no share has a narrower interval than if its values were independent.
    """
    known = {name: [value for value in values if value is not None] for name, values in columns.items()}
    if scenarios is None:
        others = [name for name in known if name not in shares]
        drawn = dict(zip(others, bootstraps([known[name] for name in others]), strict=True))
    else:
        others = [name for name, values in known.items() if values]
        table = [[math.nan if value is None else value for value in columns[name]] for name in others]
        drawn = dict(zip(others, nested_bootstraps(table, _numbers(scenarios)), strict=True)) if others else {}
    result = {}
    for name, values in known.items():
        n, mean, std = spread(values)
        intervals = [drawn[name]] if name in drawn else []
        if name in shares:
            intervals.append(wilson(sum(value > 0 for value in values), n))
        low, high = _widest(intervals)
        result[name] = Estimate(n=n, mean=_known(mean), std=_known(std), low=low, high=high)
    return result


def _numbers(scenarios: Sequence[str]) -> list[int]:
    """Number of the scenario of each value, from 0 on."""
    order = {name: number for number, name in enumerate(dict.fromkeys(scenarios))}
    return [order[name] for name in scenarios]


def _widest(intervals: Sequence[tuple[float, float]]) -> tuple[float | None, float | None]:
    """The smallest interval that holds all of these; an interval that is NaN is left out."""
    known = [ends for ends in intervals if not math.isnan(ends[0])]
    return (min(low for low, _ in known), max(high for _, high in known)) if known else (None, None)


def is_summary(name: str) -> bool:
    """Whether a row with this name is one over all scenarios, or over all of one group or protocol."""
    return name.partition("/")[0] == ALL or name.startswith(f"{ALL[:-1]} ")


def protocols_of(scenarios: Sequence[str]) -> dict[str, str]:
    """Protocol of each scenario, otherwise ``as-written``.

    It is the last part of the name ``NAME/PROTOCOL`` that the scenarios of a suite with several protocols have.

    Args:
        scenarios: Names of the scenarios.
    """
    last = {name: name.rpartition("/")[2] for name in scenarios}
    return {name: part if part in get_args(Protocol) else "as-written" for name, part in last.items()}


def summaries_of(
    episodes: Sequence[EpisodeRow],
    scenarios: Sequence[str],
    behaviors: Sequence[str],
    protocols: Mapping[str, str] | None = None,
    groups: Mapping[str, Sequence[str]] | None = None,
) -> dict[str, list[EpisodeRow]]:
    """Name of each row → its episodes: of each scenario, of all scenarios, and of each group of scenarios.

    Scenarios are summarised together if each has the same number of episodes. Different protocols never are,
    because the same start and seed would count twice.

    Args:
        episodes: The episodes that are done.
        scenarios: The scenarios, in order.
        behaviors: The behaviors, in order.
        protocols: The protocol of each scenario; None: all have the same.
        groups: Name of a group → its scenarios.
    """
    made = {name: [episode for episode in episodes if episode.scenario == name] for name in scenarios}
    together = dict[str, list[str]]()
    for name in scenarios:
        together.setdefault("" if protocols is None else protocols[name], []).append(name)
    rows = dict(made)
    for label, chosen in {"": scenarios, **(groups or {})}.items():
        for protocol, every in together.items():
            names = [name for name in every if name in chosen]
            sizes = {len(made[name]) for name in names}
            once = sizes == {len(behaviors)}  # one episode per scenario and behavior
            if len(sizes) == 1 and len(names) >= (_MIN_SCENARIOS if once else 2):
                called = f"{ALL[:-1]} {label})" if label else ALL
                rows[called if len(together) == 1 else f"{called}/{protocol}"] = [
                    episode for name in names for episode in made[name]
                ]
    return rows


def counts_once(episodes: Sequence[EpisodeRow], certain: Mapping[str, Collection[str]]) -> bool:
    """Whether the episodes of a behavior count as one in each scenario.

    They do where nothing random reaches the behavior and the episodes of all seeds are equal. Equal episodes alone do
    not tell: a planner that fails with each of its draws has equal episodes, and each draw was a trial.

    Args:
        episodes: Episodes of one behavior.
        certain: Scenario → behaviors that nothing random reaches.
    """
    known: dict[str, EpisodeRow] = {}
    for one in episodes:
        same = one.model_copy(update={"seed": 0})
        if one.behavior not in certain.get(one.scenario, ()) or known.setdefault(one.scenario, same) != same:
            return False
    return bool(episodes)


def first_of_each(
    entries: Sequence[_T], scenario_of: Callable[[_T], str] = operator.attrgetter("scenario")
) -> list[_T]:
    """The first entry of each scenario: of episodes, or of what ``scenario_of`` finds the scenario of."""
    first: dict[str, _T] = {}
    for one in entries:
        first.setdefault(scenario_of(one), one)
    return list(first.values())


def rows_of(
    summaries: Mapping[str, Sequence[EpisodeRow]],
    behaviors: Sequence[str],
    random: Mapping[str, Sequence[str]],
    certain: Mapping[str, Collection[str]],
) -> list[BenchmarkRow]:
    """Rows of each scenario, and over several, by behavior.

    Args:
        summaries: Their episodes, see :func:`summaries_of`.
        behaviors: The behaviors, in order.
        random: The random parts of each scenario.
        certain: Scenario → behaviors that nothing random reaches.
    """
    rows = []
    for name, chosen in summaries.items():
        own = {one: [episode for episode in chosen if episode.behavior == one] for one in behaviors}
        once = {one: counts_once(mine, certain) for one, mine in own.items()}
        first = {_pair(episode): episode for episode in own[behaviors[0]]}
        single = not is_summary(name)
        fixed = single and not random[name]
        for behavior, mine in own.items():
            if not placed(mine):  # no episode is done yet, or no seed has room
                continue
            both = once[behavior] and once[behaviors[0]]
            paired = [] if behavior == behaviors[0] else first_of_each(mine) if both else placed(mine)
            pairs = [(episode, first[_pair(episode)]) for episode in paired if _pair(episode) in first]
            counted = first_of_each(mine) if once[behavior] else mine
            row = _row(name, behavior, counted, fixed or (single and once[behavior]))
            row.paired = _paired(pairs, fixed or (single and both), together=not single)
            rows.append(row)
    return rows


def perturbation_notes(changes: Mapping[str, Sequence[str]]) -> list[str]:
    """Notes about what each seed changes in each scenario.

    Args:
        changes: The changes by each seed in each scenario, in words.
    """
    notes = {name: f"{PERTURBED}: {'; '.join(parts)}" for name, parts in changes.items()}
    return list(notes.values())[:1] if len(set(notes.values())) == 1 else grouped_notes(notes)


def grouped_notes(notes: Mapping[str, str]) -> list[str]:
    """Notes on scenarios, each once, after the scenarios that it is about.

    Args:
        notes: Scenario → note.
    """
    scenarios: dict[str, list[str]] = {}
    for name, note in notes.items():
        scenarios.setdefault(note, []).append(name)
    return [f"{listed(names, _MAX_NAMED)}: {note}" for note, names in scenarios.items()]


def notes_of(episodes: Sequence[EpisodeRow], head: BenchmarkResult) -> list[str]:
    """Notes that a reader of the rows must know.

    Args:
        episodes: The episodes that are done.
        head: The result without episodes.
    """
    notes = []
    fixed = [name for name, chance in head.random.items() if not chance]
    if fixed and len(head.seeds) > 1:
        notes.append(
            f"{listed(fixed, _MAX_NAMED)}: nothing is random that these policies notice, so every seed gives the same "
            "run and only one was simulated; random placement, motion noise or perturb would make seeds differ"
        )
    notes += grouped_notes(_notes_of_equal(episodes, head.certain)) if len(head.seeds) > 1 else []
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


def _notes_of_equal(episodes: Sequence[EpisodeRow], certain: Mapping[str, Collection[str]]) -> dict[str, str]:
    """Scenario → note on the policies whose episodes are equal there."""
    of_cell: dict[tuple[str, str], list[EpisodeRow]] = {}
    for one in episodes:
        of_cell.setdefault((one.scenario, one.behavior), []).append(one)
    equal: dict[str, list[str]] = {}
    for (scenario, behavior), own in of_cell.items():
        if counts_once(own, certain):
            equal.setdefault(scenario, []).append(behavior)
    return {
        scenario: f"nothing random reaches {' and '.join(behaviors)}: all seeds give one episode, which counts once"
        for scenario, behaviors in equal.items()
    }


def _paired(pairs: Sequence[tuple[EpisodeRow, EpisodeRow]], certain: bool, *, together: bool) -> dict[str, Estimate]:
    """The differences of pairs; empty without pairs."""
    shares = frozenset[str]() if certain else _PROPORTIONS
    return paired_differences(pairs, KEYS, shares, together=together) if pairs else {}


def _row(name: str, behavior: str, every: list[EpisodeRow], certain: bool) -> BenchmarkRow:
    episodes = placed(every)
    outcomes: list[str] = [episode.outcome for episode in episodes]
    shown_as_shares = frozenset() if certain else _PROPORTIONS
    scenarios = [episode.scenario for episode in episodes] if is_summary(name) else None
    metrics = estimates(_columns(episodes), shown_as_shares, scenarios)
    shares = {key: _proportion(metrics[key], outcomes.count(key), len(outcomes), certain) for key in _OUTCOMES}
    return BenchmarkRow(
        scenario=name,
        behavior=behavior,
        episodes=len(episodes),
        metrics=metrics,
        zones={} if is_summary(name) else _zones(episodes),
        roles={} if is_summary(name) else _roles(episodes, certain),
        failed={
            outcome: [episode.seed for episode in episodes if episode.outcome == outcome]
            for outcome in _OUTCOMES[1:]
            if outcome in outcomes and not is_summary(name)
        },
        failures={} if is_summary(name) else _frequent_failures(episodes),
        incidents=incident_counts(every),
        incident_seeds={} if is_summary(name) else incident_seeds(every),
        success=shares["success"],
        collision=shares["collision"],
        timeout=shares["timeout"],
    )


def _proportion(estimate: Estimate, count: int, n: int, certain: bool) -> Proportion:
    """The share of an outcome, which is the mean of a metric; without an interval where nothing is random."""
    low, high = (None, None) if certain else (estimate.low, estimate.high)
    return Proportion(count=count, n=n, rate=count / n, low=low, high=high)


def _columns(episodes: Sequence[EpisodeRow], keys: Sequence[str] = KEYS) -> dict[str, list[float | None]]:
    """The values of each metric.

    ``contacts_per_hour`` is a ratio of two means. Its values are linearised (Woodruff 1971), so that their mean is the
    ratio, and their spread the spread of the ratio: R + (c - R t) / mean(t), with the contacts c and hours t of an
    episode.
    """
    columns = {key: [episode.metrics[key] for episode in episodes] for key in keys}
    if "contacts_per_hour" in columns:
        contacts = [episode.metrics["collision_count"] or 0.0 for episode in episodes]
        hours = [(episode.metrics["driving_time"] or 0.0) / 3600.0 for episode in episodes]
        all_hours = math.fsum(hours)
        ratio, mean = (math.fsum(contacts) / all_hours, all_hours / len(hours)) if all_hours else (math.nan, 1.0)
        columns["contacts_per_hour"] = [
            _known(ratio + (c - ratio * t) / mean) for c, t in zip(contacts, hours, strict=True)
        ]
    return columns


def _zones(episodes: list[EpisodeRow]) -> dict[str, dict[str, Estimate]]:
    """Estimates of the metrics of each zone; episodes that were measured have the same zones."""
    measured = [episode.zones for episode in episodes if episode.zones]
    return {
        zone: estimates({key: [zones[zone][key] for zones in measured] for key in values})
        for zone, values in (measured[0] if measured else {}).items()
    }


def _roles(episodes: list[EpisodeRow], certain: bool) -> dict[str, dict[str, Estimate]]:
    """Estimates of the metrics of each role; shares of a single robot get the interval of a proportion."""
    result = {}
    for role, first in (episodes[0].roles if episodes else {}).items():
        alone = not certain and first["robots"] == 1
        columns = {key: [episode.roles.get(role, {}).get(key) for episode in episodes] for key in first}
        result[role] = estimates(columns, _OUTCOMES if alone else ())
    return result


def _frequent_failures(episodes: Sequence[EpisodeRow]) -> dict[str, int]:
    count = Counter(f"{robot!r}: {fate}" for episode in episodes for robot, fate in episode.failures.items())
    return dict(count.most_common(_MAX_FAILURES))


def paired_differences(
    pairs: Sequence[tuple[EpisodeRow, EpisodeRow]],
    keys: Sequence[str],
    shares: Collection[str],
    *,
    together: bool,
) -> dict[str, Estimate]:
    """Estimates of the differences of pairs; for shares with an interval that is not empty if all pairs agree.

    Args:
        pairs: Episodes with the same scenario and seed.
        keys: The metrics.
        shares: The metrics that are 0 or 1.
        together: Whether the pairs are of several scenarios, which are then resampled.
    """
    mine, other = (_columns(side, keys) for side in zip(*pairs, strict=True))
    values = {key: list(zip(mine[key], other[key], strict=True)) for key in keys}
    apart = {key: [None if a is None or b is None else a - b for a, b in both] for key, both in values.items()}
    differences = estimates(apart, (), [a.scenario for a, _ in pairs] if together else None)
    for key in shares:
        known = [(a > 0, b > 0) for a, b in values.get(key, ()) if a is not None and b is not None]
        if known:
            count, drawn = Counter(known), differences[key]
            intervals = [newcombe(*(count[pair] for pair in _TABLE))]
            if together and drawn.low is not None and drawn.high is not None:
                intervals.append((drawn.low, drawn.high))
            drawn.low, drawn.high = _widest(intervals)
    return differences


def _pair(episode: EpisodeRow) -> tuple[str, int]:
    return episode.scenario, episode.seed


def _known(value: float) -> float | None:
    return None if math.isnan(value) else value
