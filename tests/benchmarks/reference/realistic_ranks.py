"""Ranks with ideal and realistic sensing: ``python -m tests.benchmarks.reference.realistic_ranks`` writes the page.

The numbers come from kept episodes of each suite ``…_noisy`` and of its twin without errors, which has the same
scenarios, seeds and policies.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from statistics import fmean, median
from typing import NamedTuple

from irsim.benchmarks.incidents import placed
from irsim.benchmarks.pairs import lead, pairs_of, ranks_of
from irsim.benchmarks.summary import ALL, rows_of, summaries_of
from irsim.policies.catalog import open_policy
from irsim.results.benchmark import BenchmarkRow, EpisodeRow, Estimate, PolicyPair, PolicyRank
from tests.benchmarks.reference.leaderboard import certain_of, in_points, in_words
from tests.benchmarks.reference.write import PAGES, TABLES, episodes_of

__all__ = [
    "PAGE",
    "Change",
    "Comparison",
    "compare",
    "comparisons",
    "kendall",
    "realistic_ranks",
    "section",
    "twins",
]

PAGE = PAGES / "realistic_ranks.md"
_COLUMNS = ("scenario", "policy", "seed", "outcome", "min_clearance", "success_in_belief")
_IDEAL, _REALISTIC = "ideal", "realistic"
_ABOUT = """\
# Ranks of policies with ideal and with realistic sensing

<!-- Written by `python -m tests.benchmarks.reference.realistic_ranks`: do not edit. -->

Most comparisons of navigation policies in simulation, the [leaderboard](results.md) among them, let policies know poses
and velocities exactly and at once. Here the same policies drive in the same scenes with the same seeds once more, under
*realistic* sensing: a robot knows its pose from localization (0.05 m and 0.02 rad after a correction, drift in between)
and others from a detector with a tracker (range 10 m, misses, hidden objects, false tracks, 0.05 m and 0.1 m/s of
noise), and its commands take effect 0.1 s late and through a lag of 0.1 s. The lidar of the robot in clutter errs, too.
[Realism](realism.md) has the models. Outlines and headings of tracked objects, who has arrived and who gives way are
still told exactly, and so is the map.

Shares of episodes in %, over all scenarios under one protocol. *Change* is the difference in success of the same
scenarios and seeds, realistic minus ideal, in points; brackets are 95 % intervals, computed as on the leaderboard.
*Rank* is by success, of equals the mean of their places, and its brackets are the ranks that the intervals of the pairs
allow. *Collision* is ideal → realistic. *In belief* is the share of episodes in which every robot believed that it had
arrived and no robot had a contact: above the success, robots rested short of their goal; below it, they had arrived and
did not believe it yet. *Clearance* is the median of the smallest distances to anything of the ideal episodes, in m:
what a policy has left when places err.
Kendall's τ-b compares both orders: 1 if they are equal, 0 if they have nothing in common, -1 if one is the other in
reverse.

## At a glance
"""
_FEW = 3
"""Number of pairs that a sentence names."""


class Change(NamedTuple):
    """A policy under ideal and under realistic sensing.

    Attributes:
        policy: Its name.
        knows: Its class of information.
        rows: Its rows over all scenarios, ideal and realistic.
        ranks: Its ranks in them.
        difference: Its success under realistic sensing minus that under ideal sensing, of the same trials.
        in_belief: Share of episodes in which all robots believed to have arrived without a contact.
        clearance: Median of the smallest distance to anything under ideal sensing [m].
    """

    policy: str
    knows: str
    rows: tuple[BenchmarkRow, BenchmarkRow]
    ranks: tuple[PolicyRank, PolicyRank]
    difference: Estimate
    in_belief: float
    clearance: float


class Comparison(NamedTuple):
    """All policies of a suite under one protocol.

    Attributes:
        changes: One entry a policy, by the realistic rank.
        pairs: How many pairs of policies there are.
        swapped: Pairs that change places, the one that is better under realistic sensing first.
        surely: The swapped pairs whose intervals say so on both sides.
        parted: Number of pairs that differ for sure under realistic sensing only.
        level: Number of pairs that differ for sure under ideal sensing only.
        tau: Kendall's τ-b of both orders.
    """

    changes: list[Change]
    pairs: int
    swapped: list[tuple[str, str]]
    surely: list[tuple[str, str]]
    parted: int
    level: int
    tau: float


def twins() -> list[str]:
    """Names of the tables of suites ``…_noisy``, which repeat a suite under realistic sensing."""
    return [name for name, table in TABLES.items() if table.suite.endswith("_noisy")]


def compare(ideal: Sequence[EpisodeRow], realistic: Sequence[EpisodeRow], policies: Mapping[str, str]) -> Comparison:
    """Compare policies under both kinds of sensing.

    Args:
        ideal: Episodes under ideal sensing, of one protocol.
        realistic: Episodes of the same scenarios, seeds and policies under realistic sensing.
        policies: Name of each policy → the policy as text.
    """
    names = {text: name for name, text in policies.items()}
    sides = [_side(own, list(names)) for own in (ideal, realistic)]
    changes = [
        Change(
            policy=name,
            knows=open_policy(text).knowledge() or "what the scenarios say",
            rows=(sides[0][0][text], sides[1][0][text]),
            ranks=(sides[0][2][text], sides[1][2][text]),
            difference=_difference([one for one in ideal if one.behavior == text], realistic),
            in_belief=fmean(_known("success_in_belief", realistic, text)),
            clearance=median(_known("min_clearance", ideal, text)),
        )
        for text, name in names.items()
    ]
    swapped, surely, parted, level = [], [], 0, 0
    for before, after in zip(sides[0][1], sides[1][1], strict=True):
        assert (before.behavior, before.against) == (after.behavior, after.against)
        was, now = (one.difference.mean or 0.0 for one in (before, after))
        leads = (lead(before, before.behavior) or 0, lead(after, after.behavior) or 0)
        parted += leads[0] == 0 != leads[1]
        level += leads[1] == 0 != leads[0]
        if was * now < 0.0:
            pair = (names[after.behavior], names[after.against])
            swapped.append(pair if now > 0.0 else pair[::-1])
            if leads[0] * leads[1] < 0:
                surely.append(swapped[-1])
    changes.sort(key=lambda one: (one.ranks[1].rank, one.ranks[0].rank))
    rates = [[row.success.rate for row in (one.rows[0], one.rows[1])] for one in changes]
    tau = kendall(*zip(*rates, strict=True))
    return Comparison(changes, len(sides[0][1]), swapped, surely, parted, level, tau)


def _side(
    episodes: Sequence[EpisodeRow], behaviors: Sequence[str]
) -> tuple[dict[str, BenchmarkRow], list[PolicyPair], dict[str, PolicyRank]]:
    """Row, pairs and rank of each behavior over all scenarios."""
    summaries = {ALL: summaries_of(episodes, list(dict.fromkeys(one.scenario for one in episodes)), behaviors)[ALL]}
    rows, pairs = rows_of(summaries, behaviors, {}, {}), pairs_of(summaries, behaviors, {}, {})
    ranks = {one.behavior: one for one in ranks_of(rows, pairs)}
    return {one.behavior: one for one in rows}, pairs, ranks


def _difference(ideal: Sequence[EpisodeRow], realistic: Sequence[EpisodeRow]) -> Estimate:
    """Success under realistic sensing minus that under ideal sensing, of one policy."""
    behavior = ideal[0].behavior
    own = [one.model_copy(update={"behavior": _REALISTIC}) for one in realistic if one.behavior == behavior]
    own += [one.model_copy(update={"behavior": _IDEAL}) for one in ideal]
    [pair] = pairs_of({ALL: own}, [_REALISTIC, _IDEAL], {}, {})
    return pair.difference


def _known(key: str, episodes: Sequence[EpisodeRow], behavior: str) -> list[float]:
    """The values of a metric in all episodes of one policy."""
    values = [one.metrics[key] for one in placed(episodes) if one.behavior == behavior]
    known = [value for value in values if value is not None]
    assert len(known) == len(values)
    return known


def kendall(one: Sequence[float], other: Sequence[float]) -> float:
    """Kendall's τ-b of two lists of values of the same things; NaN if all values of a list are equal.

    References:
        Kendall: The treatment of ties in ranking problems (Biometrika 1945).
    """
    pairs = itertools.combinations(zip(one, other, strict=True), 2)
    signs = [(_sign(a[0] - b[0]), _sign(a[1] - b[1])) for a, b in pairs]
    untied = [sum(sign[k] != 0 for sign in signs) for k in (0, 1)]
    return sum(a * b for a, b in signs) / math.sqrt(untied[0] * untied[1]) if all(untied) else math.nan


def _sign(value: float) -> int:
    return (value > 1e-12) - (value < -1e-12)


def comparisons(name: str) -> dict[str, Comparison]:
    """Protocol → the comparison, of a table under realistic sensing."""
    twin, plan = name.removesuffix("_noisy"), TABLES[name].plan()
    assert plan.policies == TABLES[twin].plan(seeds=len(plan.seeds)).policies
    assert certain_of(twin) == certain_of(name) == {}
    protocol_of = {one.name: one.protocol for one in plan.scenarios}
    ideal = [one for one in episodes_of(twin, _COLUMNS[:-1]) if one.seed in plan.seeds]
    realistic = episodes_of(name, _COLUMNS)
    made = {}
    for protocol in dict.fromkeys(protocol_of.values()):
        sides = [[one for one in side if protocol_of[one.scenario] == protocol] for side in (ideal, realistic)]
        made[protocol] = compare(*sides, plan.policies)
    return made


def realistic_ranks() -> str:
    """The page, of all suites whose twins have kept episodes."""
    every = {name: comparisons(name) for name in twins()}
    head = ["| suite | protocol | first, ideal | first, realistic | loses most | τ-b |", "|---" * 6 + "|"]
    rows = [_glance(name, protocol, one) for name, made in every.items() for protocol, one in made.items()]
    return "\n".join([_ABOUT, *head, *rows, "", *(section(name, made) for name, made in every.items())])


def _first(one: Comparison, side: int) -> list[str]:
    """The policies with the best rank on a side, ideal or realistic."""
    best = min(change.ranks[side].rank for change in one.changes)
    return [change.policy for change in one.changes if change.ranks[side].rank == best]


def _loser(one: Comparison) -> Change:
    """The policy whose success falls most."""
    return min(one.changes, key=lambda change: change.difference.mean or 0.0)


def _glance(name: str, protocol: str, one: Comparison) -> str:
    """A row of the table of all suites."""
    suite = name.removesuffix("_noisy")
    firsts = [in_words(_first(one, side)) for side in (0, 1)]
    most = _loser(one)
    cells = [f"[{suite}](#{suite})", protocol, *firsts, f"`{most.policy}` {in_points(most.difference)}"]
    return f"| {' | '.join([*cells, f'{one.tau:.2f}'])} |"


def section(name: str, made: Mapping[str, Comparison]) -> str:
    """The table of one suite, and what changes."""
    ideal, seeds = name.removesuffix("_noisy"), TABLES[name].plan().seeds
    head = ("protocol", "policy", "knows", "n", "ideal", "realistic", "change", "rank, ideal", "rank, realistic")
    head += ("collision", "in belief", "clearance")
    lines = [
        f"## {ideal}\n",
        f"{len(seeds)} seeds from {seeds[0]:,} on; episodes: [ideal]({ideal}.md), [realistic]({name}.md).\n",
        f"| {' | '.join(head)} |",
        "|---" * len(head) + "|",
        *(_row(protocol, change) for protocol, one in made.items() for change in one.changes),
        "\n" + " ".join(_sentences(protocol, one) for protocol, one in made.items()) + "\n",
    ]
    return "\n".join(lines)


def _row(protocol: str, one: Change) -> str:
    ideal, realistic = one.rows
    cells = [protocol, f"`{one.policy}`", one.knows, str(realistic.episodes)]
    cells += [f"{100 * row.success.rate:.1f}" for row in one.rows]
    cells += [in_points(one.difference), *(f"{rank.rank:g} [{rank.low}, {rank.high}]" for rank in one.ranks)]
    cells += [f"{100 * ideal.collision.rate:.1f} → {100 * realistic.collision.rate:.1f}", f"{100 * one.in_belief:.1f}"]
    cells.append(f"{one.clearance:.2f}")
    return f"| {' | '.join(cells)} |"


def _sentences(protocol: str, one: Comparison) -> str:
    """Who loses most and least, who is first, and which pairs change places."""
    most, least = _loser(one), max(one.changes, key=lambda change: change.difference.mean or 0.0)
    text = f"Under {protocol}, `{most.policy}` loses most, {in_points(most.difference)} points, and "
    text += f"`{least.policy}` least, {in_points(least.difference)}."
    before, after = (_first(one, side) for side in (0, 1))
    if before == after:
        text += f" {in_words(before)} {'stays' if len(before) == 1 else 'stay'} first."
    else:
        text += f" First under ideal sensing: {in_words(before)}; under realistic sensing: {in_words(after)}."
    surely = "none of them for sure"
    if one.surely:
        named = [f"`{better}` is now before `{worse}`" for better, worse in one.surely[:_FEW]]
        more = f"; {len(one.surely) - _FEW} more" if len(one.surely) > _FEW else ""
        surely = f"{len(one.surely)} of them for sure ({'; '.join(named)}{more})"
    text += f" Of {one.pairs} pairs of policies, {len(one.swapped) or 'none'} change places"
    text += f", {surely}" if one.swapped else ""
    return f"{text}; {one.parted} differ for sure under realistic sensing only, {one.level} under ideal sensing only."


if __name__ == "__main__":
    PAGE.write_text(realistic_ranks(), encoding="utf-8")
