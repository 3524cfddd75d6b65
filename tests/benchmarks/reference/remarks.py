"""Remarks on rows over all scenarios of the leaderboard, which hide much, in sentences made of the kept episodes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from statistics import median

from irsim.benchmarks.pairs import pairs_of
from irsim.benchmarks.summary import ALL, summaries_of
from tests.benchmarks.reference.kept import Line, episode_of, kept_lines

__all__ = ["REMARKS", "remark"]

_KINDS = ("success", "collision", "timeout")
Wins = Mapping[tuple[str, str], int]
"""(scenario, policy) → number of episodes that succeed."""


def remark(name: str) -> list[str]:
    """The remark on a table as a list of one text; empty without one."""
    return [REMARKS[name](kept_lines(name))] if name in REMARKS else []


def _wins(lines: Sequence[Line]) -> Wins:
    return Counter((line["scenario"], line["policy"]) for line in lines if line["outcome"] == "success")


def _placed(lines: Sequence[Line], scenario: str) -> int:
    """Number of seeds of a scenario that have room for all."""
    return len({line["seed"] for line in lines if line["scenario"] == scenario and line["outcome"] in _KINDS})


def _social(lines: Sequence[Line]) -> str:
    """On ``bottleneck``."""
    wins, policies = _wins(lines), list(dict.fromkeys(line["policy"] for line in lines))
    number = sum(line["scenario"] == "bottleneck/freeze" for line in lines)
    scenarios = len({line["scenario"] for line in lines if line["scenario"].endswith("/freeze")})
    assert not any(wins["bottleneck/freeze", policy] for policy in policies)
    won = {policy: wins["bottleneck/yield", policy] for policy in policies}
    each = number // len(policies)
    assert won["sfm"] == won["footprint_orca"] == each
    assert won["as-written"] == won["dash"] == 0
    return (
        f"Under freeze no policy gets all robots through `bottleneck` (0 of {number} episodes), so none of them wins "
        f"more than {scenarios - 1} of {scenarios} scenarios. Under yield that scenario alone separates policies that "
        f"make way after arrival (`sfm`, `footprint_orca` {each} of {each}, `avocado` {won['avocado']}, `orca` "
        f"{won['orca']}) from the others (`rvo` {won['rvo']}, `as-written` and `dash` 0)."
    )


def _clutter(lines: Sequence[Line]) -> str:
    """On seeds that are called unreachable, and on clearances."""
    dense = [line for line in lines if line["scenario"] == "posts-45/freeze"]
    unreachable = {line["seed"] for line in lines if int(line["unreachable"] or 0)}
    assert unreachable == {line["seed"] for line in dense if int(line["unreachable"] or 0)}
    own = {line["seed"]: line["outcome"] == "success" for line in dense if line["policy"] == "footprint_orca"}
    rivals = ("footprint_orca", "follow")
    won, near = Counter(line["policy"] for line in lines if line["outcome"] == "success"), {}
    for policy in rivals:
        near[policy] = 1000 * median(float(line["min_clearance"]) for line in dense if line["policy"] == policy)
    more = won["footprint_orca"] - won["follow"]
    crossed = sum(own[seed] for seed in unreachable)
    return (
        f"The suite calls a seed unreachable if its planner finds no path: {len(unreachable)} of posts-45. "
        f"`footprint_orca` crosses {crossed} of them, which is {crossed} of the {more} episodes that it wins over "
        f"`follow`. It passes the posts of posts-45 within {near['footprint_orca']:.1f} mm (median of the smallest "
        f"clearance; `follow` {near['follow']:.0f} mm)."
    )


def _crowdnav(lines: Sequence[Line]) -> str:
    """On other periods, and on many people."""
    wins, policies = _wins(lines), ["orca-margin", "rvo"]
    columns = ("scenario", "policy", "seed", "outcome")
    chosen = [line for line in lines if line["policy"] in policies and not line["scenario"].startswith("step-")]
    episodes = [episode_of({key: line[key] for key in columns}, line["policy"]) for line in chosen]
    summaries = {ALL: summaries_of(episodes, list(dict.fromkeys(one.scenario for one in episodes)), policies)[ALL]}
    [pair] = pairs_of(summaries, policies, {}, {})
    lead = pair.difference
    assert lead.mean is not None
    assert lead.low is not None
    assert lead.low < 0
    crowds = [f"{place}-invisible-{people}/freeze" for place in ("circle", "square") for people in (15, 20)]
    first, second, third, fourth = (
        f"{wins[name, 'rvo']} and {wins[name, 'orca-margin']} of {_placed(lines, name)}" for name in crowds
    )
    assert {name for name, policy in wins if wins[name, "rvo"] > wins[name, "orca-margin"]} == {*crowds}
    return (
        "The lead depends on the scenes. Without the scenarios `step-…`, which repeat others at other periods, it is "
        f"{100 * lead.mean:.0f} points, and its interval holds 0. Where 15 or 20 people do not see the robot, `rvo` "
        f"wins more: {first}, {second} on the circle, {third}, {fourth} in the square."
    )


REMARKS: Mapping[str, Callable[[Sequence[Line]], str]] = {
    "social_v2": _social,
    "clutter_v2": _clutter,
    "crowdnav_circle_v2": _crowdnav,
}
"""Table → its remark."""
