"""The leaderboard: ``python -m tests.benchmarks.reference.leaderboard`` writes its page from kept episodes.

Its numbers are the rows over all scenarios, and the pairs of policies in them, of the results of which the pages of the
suites are made.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import NamedTuple

from irsim.benchmarks.pairs import pairs_of
from irsim.benchmarks.stored import prepare_plan
from irsim.benchmarks.suite import load_suite
from irsim.benchmarks.suite_plan import suite_plan
from irsim.benchmarks.summary import ALL, rows_of, summaries_of
from irsim.policies.catalog import open_policy
from irsim.policies.description import list_policies
from irsim.results.benchmark import EpisodeRow, Estimate, Proportion
from irsim.scenario.behavior_override import parse_behavior
from tests.benchmarks.reference.remarks import remark
from tests.benchmarks.reference.write import PAGES, TABLES, episodes_of, kept_of

__all__ = [
    "LEFT_OUT",
    "LEFT_OUT_OF_SUITES",
    "PAGE",
    "Standing",
    "certain_of",
    "in_points",
    "in_words",
    "leaderboard",
    "standings",
    "unlisted_policies",
]

PAGE = PAGES / "results.md"
_ABOUT = """\
# Which policy is best where, and by how much

<!-- Written by `python -m tests.benchmarks.reference.leaderboard`: do not edit. -->

Shares of episodes in %, over all scenarios and seeds of a suite under one protocol, each episode counted once. Brackets
are 95 % intervals: scenarios are resampled and then their episodes, and no interval is narrower than Wilson's or
Newcombe's. *Behind* is the difference in success to the first one, of the same scenarios and seeds. Where nothing
random reaches a policy, every seed gives it the same episode, which counts once (n is then the number of scenarios).
Scenarios `step-…` repeat scenes at another period, but are resampled as if their scenes were new, so intervals are
somewhat too narrow.
Rows are the ones over all scenarios of the page that each heading links, which names the episodes and their hash.
`irsim audit` prints such rows of a submission, too, and says how many of its rows nothing has checked
([audit](../guides/audit.md)).

*Knows* is what a policy knows besides its own state and goal, as `irsim policies` prints it. The simulator tells it
exactly and at once; only `lidar` is read from a sensor, without noise. How ranks change where poses, tracks and
commands err: [realistic sensing](realistic_ranks.md). `+intent` is told, too, and not sensed: who has arrived, and who
gives way by the same law. Policies of one class stand together, and the class of the best one is
first: only they compete with equal means, and a lead over another class can be one of information. Where policies
change places between suites, choose by the scenes that are like yours. One robot drives in {alone}, and its episode
ends when it has arrived: both protocols give equal episodes there, and only `freeze` is listed.
"""
_WHERE = """\
Networks run in suites whose scenes are like the ones of their training, most of them on fewer seeds. Of the networks
that are trained here only `multi_robot_v2` has met the limits of acceleration that all suites v2 have. No table has:
"""
_OTHERS = """\
One policy among others is in [mixed_v2](mixed_v2.md). Recorded people are in [pedestrians](pedestrians.md): they do
not make way. The options of `orca of the suite` were chosen, and no record says on which windows; the others have
their defaults. Successes in {n} episodes, of {seeds} seeds from 100,000 on in each of {windows} windows:
{shares}.
"""
_PEOPLE = re.compile(r"^\| all \| (`[^`]+`) \| (\d+) \| (\d+ %) ", re.MULTILINE)
"""Policy, number of episodes and success in a row over all recordings of the page on pedestrians."""
_SEEDS_OF_PEOPLE = 10
"""Number of seeds in each window of the page on pedestrians."""
LEFT_OUT = {
    "random": "it draws its controls",
    "replay": "it repeats a recording and does not decide",
    "mixed": "it is several policies ([mixed_v2](mixed_v2.md))",
    "neupan": "it needs a package and a file of its authors",
    "process": "it is a program that the user brings",
    "rl_rvo_authors": "its weights are the authors' ([policies of the paper](policies_of_the_paper.md))",
}
"""Policy that no table has -> why."""
LEFT_OUT_OF_SUITES = {
    ("random_polygons_v2", "sarl"): "it was trained to lead one robot among people",
}
"""Suite, and a policy that it has a name for but no table of it has -> why."""


class Standing(NamedTuple):
    """A policy in a row over all scenarios.

    Attributes:
        policy: Its name.
        knows: Its class of information.
        episodes: Number of its episodes.
        shares: Its shares of success, collision and timeout.
        behind: Its success minus the first one's, with its interval; None for the first one.
    """

    policy: str
    knows: str
    episodes: int
    shares: tuple[Proportion, Proportion, Proportion]
    behind: Estimate | None


def standings(
    episodes: Sequence[EpisodeRow], policies: Mapping[str, str], certain: Mapping[str, Collection[str]]
) -> list[Standing]:
    """The policies over all scenarios, the best one first, by the functions that make the rows of a page.

    Args:
        episodes: Episodes of one protocol.
        policies: Name of each policy → the policy as text.
        certain: Scenario → policies that nothing random reaches.
    """
    names = {text: name for name, text in policies.items()}
    summaries = {ALL: summaries_of(episodes, list(dict.fromkeys(one.scenario for one in episodes)), list(names))[ALL]}
    rows = sorted(rows_of(summaries, list(names), {}, certain), key=lambda one: -one.success.rate)
    pairs, best = pairs_of(summaries, list(names), {}, certain), rows[0].behavior
    behind = {one.behavior: one.difference for one in pairs if one.against == best}
    behind |= {one.against: _negated(one.difference) for one in pairs if one.behavior == best}
    return [
        Standing(
            policy=names[one.behavior],
            knows=open_policy(one.behavior).knowledge() or "what the scenarios say",
            episodes=one.episodes,
            shares=(one.success, one.collision, one.timeout),
            behind=behind.get(one.behavior),
        )
        for one in rows
    ]


def _negated(one: Estimate) -> Estimate:
    """The difference in the other direction."""
    assert one.mean is not None
    assert one.low is not None
    assert one.high is not None
    return one.model_copy(update={"mean": 0.0 - one.mean, "low": 0.0 - one.high, "high": 0.0 - one.low})


def leaderboard() -> str:
    """The page, of all suites v2 whose episodes are kept by policy."""
    alone = sorted({TABLES[name].suite for name in _tables() if TABLES[name].protocols == ("freeze",)})
    about = _ABOUT.format(alone=" and ".join([", ".join(alone[:-1]), alone[-1]]))
    parts = [about, *(part for name in _tables() for part in _section(name))]
    return "\n".join([*parts, "## Not here", "", _WHERE, *_left_out(), "", _people()])


def _people() -> str:
    """The sentence on recorded people, made of the rows over all recordings of their page."""
    rows = _PEOPLE.findall((PAGES / "pedestrians.md").read_text(encoding="utf-8"))
    *most, last = [f"{policy} {share}" for policy, _, share in sorted(rows, key=lambda one: -int(one[2].split()[0]))]
    episodes = int(rows[0][1])
    return _OTHERS.format(
        n=episodes, seeds=_SEEDS_OF_PEOPLE, windows=episodes // _SEEDS_OF_PEOPLE, shares=f"{', '.join(most)} and {last}"
    )


def certain_of(name: str) -> Mapping[str, Collection[str]]:
    """Scenario → policies that nothing random reaches, of a table; scenarios are read only if equal episodes ask it."""
    of_cell: dict[tuple[str, str], set[str]] = {}
    for (scenario, policy, _), line in kept_of(name).items():
        of_cell.setdefault((scenario, policy), set()).add(repr({**line, "seed": "", "engine": ""}))
    if all(len(lines) > 1 for lines in of_cell.values()):
        return {}
    return prepare_plan(TABLES[name].plan()).head.certain


def _tables() -> list[str]:
    return [name for name, table in TABLES.items() if table.suite.endswith("_v2") and not table.by_role]


def _section(name: str) -> Iterator[str]:
    """The table of one suite, and who leads."""
    table, episodes = TABLES[name], episodes_of(name, ("scenario", "policy", "seed", "outcome"))
    plan, certain = table.plan(), certain_of(name)
    more = name.removeprefix(table.suite).replace("_", ", with ")
    yield f"## [{table.suite}{more}]({name}.md)\n"
    yield f"{len(plan.seeds)} seeds from {plan.seeds[0]:,} on.\n"
    yield "| protocol | knows | policy | n | success | collision | timeout | behind |"
    yield "|---" * 8 + "|"
    leads, protocol_of = [], {one.name: one.protocol for one in plan.scenarios}
    for protocol in dict.fromkeys(protocol_of.values()):
        own = [one for one in episodes if protocol_of[one.scenario] == protocol]
        ranked = standings(own, plan.policies, certain)
        for knows in dict.fromkeys(one.knows for one in ranked):
            yield from (_row(protocol, one) for one in ranked if one.knows == knows)
        leads.append(_lead(protocol, ranked))
    yield "\n" + " ".join([*leads, *remark(name)]) + "\n"


def _row(protocol: str, one: Standing) -> str:
    success, collision, timeout = one.shares
    behind = "–"
    if one.behind is not None and one.behind.mean is not None:
        behind = in_points(one.behind)
    cells = [protocol, one.knows, f"`{one.policy}`", str(one.episodes)]
    cells += [f"{100 * success.rate:.1f} {_brackets(success.low, success.high)}"]
    cells += [f"{100 * share.rate:.1f}" for share in (collision, timeout)]
    return f"| {' | '.join([*cells, behind])} |"


def _lead(protocol: str, ranked: Sequence[Standing]) -> str:
    """Whether the first one leads for sure, by how much, and whether it knows the same."""
    first, second = ranked[:2]
    level = [one.policy for one in ranked[1:] if one.behind is None or one.behind.high is None or one.behind.high >= 0]
    if level:
        return f"Under {protocol}, `{first.policy}` is first, but {in_words(level)} may be as good."
    assert second.behind is not None
    assert second.behind.mean is not None
    assert second.behind.low is not None
    assert second.behind.high is not None
    lead = f"{-100 * second.behind.mean:.0f} points [{-100 * second.behind.high:.0f}, {-100 * second.behind.low:.0f}]"
    knows = "" if first.knows == second.knows else f", which knows {second.knows} and not {first.knows}"
    return f"Under {protocol}, `{first.policy}` leads, {lead} before `{second.policy}`{knows}."


def unlisted_policies() -> tuple[set[str], set[tuple[str, str]]]:
    """Policies that no table has, and suite and name of policies that a suite names but no table of it has."""
    everywhere, of_suites = set[str](), set[tuple[str, str]]()
    for suite in {TABLES[name].suite for name in _tables()}:
        plans = [TABLES[name].plan() for name in _tables() if TABLES[name].suite == suite]
        texts = {text for plan in plans for text in plan.policies.values()}
        every = suite_plan(suite, policies=[*load_suite(suite)[0].known_policies]).policies
        of_suites |= {(suite, name) for name, text in every.items() if text not in texts}
        everywhere |= {str((parse_behavior(text) or {}).get("name", text)) for text in texts}
    return {one.name for one in list_policies()} - everywhere, of_suites


def _left_out() -> Iterator[str]:
    """Each policy that is left out, and why."""
    everywhere, of_suites = unlisted_policies()
    yield from (f"- `{policy}`: {LEFT_OUT[policy]}." for policy in sorted(everywhere))
    for suite, policy in sorted(of_suites):
        yield f"- `{policy}` in {suite}: {LEFT_OUT_OF_SUITES[suite, policy]}."


def in_words(policies: Sequence[str]) -> str:
    """Names of policies in a sentence."""
    *most, last = [f"`{policy}`" for policy in policies]
    return f"{', '.join(most)} and {last}" if most else last


def in_points(one: Estimate) -> str:
    """A difference of shares in points, with its interval."""
    assert one.mean is not None
    return f"{100 * one.mean:.1f} {_brackets(one.low, one.high)}"


def _brackets(low: float | None, high: float | None) -> str:
    assert low is not None
    assert high is not None
    return f"[{100 * low:.1f}, {100 * high:.1f}]"


if __name__ == "__main__":
    PAGE.write_text(leaderboard(), encoding="utf-8")
