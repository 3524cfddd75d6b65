"""The leaderboard: ``python -m tests.benchmarks.reference.leaderboard`` writes its page from kept episodes.

The kept files (``NAME.csv``) are the only input, so the page can be made again, and checked, without a simulation.
"""

from __future__ import annotations

import csv
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from irsim.benchmarks.summary import estimates
from irsim.metrics.statistics import newcombe
from tests.benchmarks.reference.write import FOLDER, PAGES, TABLES

__all__ = ["PAGE", "leaderboard", "standings"]

PAGE = PAGES / "results.md"
_KINDS = ("success", "collision", "timeout")
_ABOUT = """\
# Which policy is best where, and by how much

<!-- Written by `python -m tests.benchmarks.reference.leaderboard`: do not edit. -->

Shares of episodes in %, over all scenarios and seeds of a suite under one protocol, each episode counted once.
Brackets are 95 % intervals: scenarios are resampled and then their episodes, and no interval is narrower than Wilson's
or Newcombe's. *Behind* is the difference in success to the first one, of the same scenarios and seeds. Rows are made
from the files that the pages of the suites name, with their hashes. `irsim audit` prints such rows of a submission, too
([audit](../guides/audit.md)). Policies know different things (`irsim policies`), so a lead can be one of information.
Where policies change places between suites, choose by the scenes that are like yours.

Not here: networks (trained without limits of acceleration, `multi_robot` and `multi_robot_freeze` collide in most
episodes of `random_polygons_v2`; `recipes` of the skill irsim-runner has numbers), `maps_v2`, one policy among others
([mixed_v2](mixed_v2.md)), and recorded people ([pedestrians](pedestrians.md)), among whom `footprint_orca` comes last:
45 %, behind `dash` with 62 % and `orca` with 91 %.
"""


class Standing(NamedTuple):
    """A policy in a suite.

    Attributes:
        policy: Its name.
        shares: Shares of its episodes by outcome, in the order success, collision, timeout.
        interval: 95 % interval of the share of successes.
        behind: Its success minus the first one's; 0 for the first one.
        behind_interval: 95 % interval of that difference.
    """

    policy: str
    shares: tuple[float, ...]
    interval: tuple[float, float]
    behind: float
    behind_interval: tuple[float, float]


def standings(episodes: Sequence[Mapping[str, str]]) -> list[Standing]:
    """The policies of one suite and protocol, best first; of seeds with room for all objects.

    Args:
        episodes: Lines of a kept file, of one protocol.
    """
    trials: dict[tuple[str, str], dict[str, str]] = {}
    for one in episodes:
        trials.setdefault((one["scenario"], one["seed"]), {})[one["policy"]] = one["outcome"]
    policies = list(dict.fromkeys(one["policy"] for one in episodes))
    complete = {
        key: made
        for key, made in sorted(trials.items())
        if len(made) == len(policies) and {*made.values()} <= {*_KINDS}
    }
    scenarios = [scenario for scenario, _ in complete]
    wins = {policy: [made[policy] == "success" for made in complete.values()] for policy in policies}
    order = sorted(policies, key=lambda policy: -sum(wins[policy]))
    best, count = wins[order[0]], len(complete)
    successes = estimates({policy: [*map(float, wins[policy])] for policy in order}, order, scenarios)
    differences = {p: [float(mine) - other for mine, other in zip(wins[p], best, strict=True)] for p in order}
    apart = estimates(differences, (), scenarios)
    ranked = []
    for policy in order:
        shares = tuple(sum(made[policy] == kind for made in complete.values()) / count for kind in _KINDS)
        pairs = Counter(zip(wins[policy], best, strict=True))
        low, high = newcombe(*(pairs[a, b] for a in (True, False) for b in (True, False)))
        drawn = apart[policy]
        assert drawn.low is not None
        assert drawn.high is not None
        between = min(low, drawn.low), max(high, drawn.high)
        own = successes[policy].low or 0.0, successes[policy].high or 0.0
        ranked.append(Standing(policy, shares, own, sum(differences[policy]) / count, between))
    return ranked


def leaderboard() -> str:
    """The page, of all suites v2 whose episodes are kept by policy."""
    lines = [_ABOUT]
    for name, table in TABLES.items():
        if table.by_role or not table.suite.endswith("_v2"):
            continue
        with (FOLDER / f"{name}.csv").open(encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        lines += [f"## [{table.suite}]({name}.md)", ""]
        lines += ["| protocol | policy | success | collision | timeout | behind |", "|---|---|---|---|---|---|"]
        leads = []
        for protocol in dict.fromkeys(row["scenario"].rpartition("/")[2] for row in rows):
            ranked = standings([row for row in rows if row["scenario"].endswith(f"/{protocol}")])
            lines += [_row(protocol, one, one is ranked[0]) for one in ranked]
            leads.append(_lead(protocol, ranked))
        lines += ["", " ".join(leads), ""]
    return "\n".join(lines)


def _row(protocol: str, one: Standing, is_first: bool) -> str:
    success, collision, timeout = (f"{100 * share:.1f}" for share in one.shares)
    behind = "–" if is_first else f"{100 * one.behind:.1f} {_brackets(one.behind_interval)}"
    return f"| {protocol} | `{one.policy}` | {success} {_brackets(one.interval)} | {collision} | {timeout} | {behind} |"


def _lead(protocol: str, ranked: Sequence[Standing]) -> str:
    """Whether the first one leads for sure, and by how much."""
    first, second = ranked[:2]
    level = [one.policy for one in ranked[1:] if one.behind_interval[1] >= 0]
    if level:
        *most, last = [f"`{policy}`" for policy in level]
        names = f"{', '.join(most)} and {last}" if most else last
        return f"Under {protocol}, `{first.policy}` is first, but {names} may be as good."
    low, high = (-100 * bound for bound in reversed(second.behind_interval))
    lead = f"{-100 * second.behind:.0f} points [{low:.0f}, {high:.0f}]"
    return f"Under {protocol}, `{first.policy}` leads, {lead} before `{second.policy}`."


def _brackets(interval: tuple[float, float]) -> str:
    return f"[{100 * interval[0]:.0f}, {100 * interval[1]:.0f}]"


if __name__ == "__main__":
    PAGE.write_text(leaderboard(), encoding="utf-8")
