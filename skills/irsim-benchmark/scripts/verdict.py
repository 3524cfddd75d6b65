#!/usr/bin/env python3
# /// script
# requires-python = ">=3.10"
# dependencies = []
# ///
"""Judge each difference in a benchmark: is it real, and how many seeds would show it. Prints JSON.

Reads the output of `irsim benchmark --json`, results.json in the folder of a benchmark, or the artifact that the tool
`benchmark` names: a file, or - for standard input. Needs only Python. Policies of a suite have their names there. A
difference is real if its 95 % interval does not contain zero and at least ten pairs of episodes have a value. With
--all-pairs every policy is compared with every other one by success, and a difference is real only if McNemar's
p-value, corrected for the number of pairs in its row (Holm), is below 0.05, too.

Exits with 0 if every difference is decided, 1 if at least one is open, 2 if the input is invalid.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from typing import Any

VERDICTS = ("better", "worse", "different", "open")
MIN_PAIRS = 10
"""Pairs of episodes below which no difference is judged."""
SHARES = ("success", "success_in_belief", "goal_reached", "timeout", "group_collision_rate", "left_world", "collision")
MORE = """
    success success_in_belief goal_reached spl velocity_avg clearing_distance_min clearing_distance_avg space_compliance
    distance_to_human_min stl barn_score crowdnav_reward min_clearance explored arrived_share
""".split()  # noqa: SIM905
LESS = """
    collision_count collision_steps wall_collisions agent_collisions human_collisions contacts_between_steps timeout
    failure_to_progress stalled_time time_to_goal path_length acceleration_avg acceleration_max jerk_avg
    jerk_max personal_space_intrusion_ratio min_distance_to_goal final_distance_to_goal
    cumulative_heading_change path_irregularity path_efficiency curvature roughness angle_over_length
    motion_energy discomfort_ratio near_misses freezing_count freezing_time group_space_intrusion_ratio
    group_collision_rate social_force_robot social_force_agents social_work obstacle_force_robot control_effort
    left_world collision pedestrian_delay aggregated_time driving_time restricted_time contacts_per_hour
""".split()  # noqa: SIM905
EITHER = """
    velocity_min velocity_max acceleration_min jerk_min time_to_collision_min proxemics_intimate_ratio
    proxemics_personal_ratio proxemics_social_ratio proxemics_public_ratio distance_to_human_avg
    discomfort_min_dist human_collisions_by_robot human_collisions_by_human obstacle_force_agents
    pedestrian_velocity_avg time_in_zone zone_crossings seen_ratio goal_visible_ratio
""".split()  # noqa: SIM905
# Whether more or less is better, None if that depends; as in references/metrics.md.
BETTER = dict.fromkeys(MORE, "more") | dict.fromkeys(LESS, "less") | dict.fromkeys(EITHER)


def judge(
    metric: str, row: dict[str, Any], first: str, detect: float, names: dict[str, str] | None = None
) -> dict[str, Any]:
    """The verdict on one difference, with its numbers; names: behavior → name of the policy in a suite."""
    names = names or {}
    difference = row["paired"][metric]
    n, mean, low, high = (difference[key] for key in ("n", "mean", "low", "high"))
    answer = {
        "scenario": row["scenario"],
        "behavior": names.get(row["behavior"], row["behavior"]),
        "against": names.get(first, first),
        "metric": metric,
        "n": n,
        "difference": mean,
        "low": low,
        "high": high,
    }
    if mean is None or low is None or n < MIN_PAIRS:
        return {
            **answer,
            "verdict": "open",
            "why": f"only {n} pairs of episodes have a value, at least {MIN_PAIRS} are needed",
        }
    aim = detect if metric in SHARES else abs(mean)
    half = (high - low) / 2
    needed = math.ceil(n * (half / aim) ** 2) if aim else None
    if low <= 0 <= high:
        return {**answer, "verdict": "open", "why": "the interval contains zero", "pairs_needed": needed, "to_see": aim}
    better = (mean > 0) == (BETTER.get(metric) == "more")
    return {**answer, "verdict": ("better" if better else "worse") if BETTER.get(metric) else "different"}


def judge_pairs(result: dict[str, Any], detect: float, names: dict[str, str]) -> list[dict[str, Any]]:
    """The verdicts on all pairs of policies, by success."""
    answers = []
    for scenario in dict.fromkeys(pair["scenario"] for pair in result["pairs"]):
        pairs = [pair for pair in result["pairs"] if pair["scenario"] == scenario]
        corrected = holm([pair["p"] for pair in pairs])
        for pair, p in zip(pairs, corrected, strict=True):
            row = {**pair, "paired": {"success": pair["difference"]}}
            answer = judge("success", row, pair["against"], detect, names)
            answer.update(only_behavior=pair["only_behavior"], only_against=pair["only_against"], p_corrected=p)
            if p is not None and p >= 0.05 and answer["verdict"] != "open":
                answer.update(verdict="open", why=f"p = {p:.2g} when corrected for {len(pairs)} pairs")
            answers.append(answer)
    return answers


def holm(values: list[float | None]) -> list[float | None]:
    """P-values corrected for their number (Holm 1979); None stays None."""
    known = sorted((p, place) for place, p in enumerate(values) if p is not None)
    corrected: list[float | None] = [None] * len(values)
    last = 0.0
    for order, (p, place) in enumerate(known):
        last = max(last, min(1.0, p * (len(known) - order)))
        corrected[place] = last
    return corrected


def main() -> int:
    """Read the result and print the verdicts."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("result", help="JSON file of `irsim benchmark --json`, or -")
    parser.add_argument(
        "--metric", action="append", choices=sorted(BETTER), metavar="KEY", help="repeatable; default: success"
    )
    parser.add_argument(
        "--detect",
        type=float,
        default=0.1,
        metavar="SHARE",
        help="smallest difference of shares that matters (default: 0.1)",
    )
    parser.add_argument("--all-pairs", action="store_true", help="every pair of policies, by success")
    parser.add_argument("--scenario", action="append", metavar="NAME", help="only this row, such as (all); repeatable")
    parser.add_argument("--policy", action="append", metavar="NAME", help="only comparisons of this policy; repeatable")
    parser.add_argument(
        "--verdict",
        action="append",
        choices=VERDICTS,
        help="print only these verdicts; repeatable; the exit code stays",
    )
    given = parser.parse_args()
    try:
        if given.result == "-":
            result = json.load(sys.stdin)
        else:
            with open(given.result, encoding="utf-8") as file:
                result = json.load(file)
        names = {text: name for name, text in (result.get("policies") or {}).items()}
        answers = [
            judge(metric, row, result["behaviors"][0], given.detect, names)
            for row in result["rows"]
            if row["paired"] and not given.all_pairs
            for metric in given.metric or ["success"]
        ] + (judge_pairs(result, given.detect, names) if given.all_pairs else [])
        every = len(answers)
        for wanted, keys in ((given.scenario, ["scenario"]), (given.policy, ["behavior", "against"])):
            answers = [one for one in answers if not wanted or any(one[key] in wanted for key in keys)]
    except (OSError, ValueError, KeyError, TypeError) as error:
        print(f"verdict.py: {given.result}: {type(error).__name__}: {error}", file=sys.stderr)
        return 2
    if not answers:
        why = f"none of its {every} comparisons is of these" if every else "has one behavior only: nothing to compare"
        print(f"verdict.py: {given.result}: {why}", file=sys.stderr)
        return 2
    shown = [one for one in answers if not given.verdict or one["verdict"] in given.verdict]
    print(json.dumps({"comparisons": len(answers), "differences": shown, "notes": result["notes"]}, indent=1))
    return 1 if any(answer["verdict"] == "open" for answer in answers) else 0


if __name__ == "__main__":
    sys.exit(main())
