#!/usr/bin/env python3
# /// script
# requires-python = ">=3.10"
# dependencies = []
# ///
"""Judge each difference in a benchmark: is it real, and how many seeds would show it. Prints JSON.

Reads the output of `irsim benchmark --json`, results.json in the folder of a benchmark, or the artifact that the tool
`benchmark` names: a file, or - for standard input. Needs only Python. Policies of a suite have their names there. A
difference is real if its 95 % interval does not contain zero and at least ten pairs of episodes have a value.

Exits with 0 if every difference is decided, 1 if at least one is open, 2 if the input is invalid.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from typing import Any

MIN_PAIRS = 10
"""Pairs of episodes below which no difference is judged."""
SHARES = ("success", "goal_reached", "timeout", "group_collision_rate", "left_world", "collision")
MORE = """
    success goal_reached spl velocity_avg clearing_distance_min clearing_distance_avg space_compliance
    distance_to_human_min stl barn_score crowdnav_reward min_clearance explored
""".split()  # noqa: SIM905
LESS = """
    collision_count collision_steps wall_collisions agent_collisions human_collisions contacts_between_steps timeout
    failure_to_progress stalled_time time_to_goal path_length acceleration_avg acceleration_max jerk_avg
    jerk_max personal_space_intrusion_ratio min_distance_to_goal final_distance_to_goal
    cumulative_heading_change path_irregularity path_efficiency curvature roughness angle_over_length
    motion_energy discomfort_ratio near_misses freezing_count freezing_time group_space_intrusion_ratio
    group_collision_rate social_force_robot social_force_agents social_work obstacle_force_robot control_effort
    left_world collision pedestrian_delay aggregated_time
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
            if row["paired"]
            for metric in given.metric or ["success"]
        ]
    except (OSError, ValueError, KeyError, TypeError) as error:
        print(f"verdict.py: {given.result}: {type(error).__name__}: {error}", file=sys.stderr)
        return 2
    if not answers:
        print(f"verdict.py: {given.result} has one behavior only, so there is nothing to compare", file=sys.stderr)
        return 2
    print(json.dumps({"comparisons": len(answers), "differences": answers, "notes": result["notes"]}, indent=1))
    return 1 if any(answer["verdict"] == "open" for answer in answers) else 0


if __name__ == "__main__":
    sys.exit(main())
