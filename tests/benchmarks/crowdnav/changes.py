"""The conditions of the published row: ``python -m tests.benchmarks.crowdnav.changes`` prints that table of the page.

Each row has one change of the published scenario, over the 500 seeds of the suite.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import yaml

import irsim
from irsim.benchmarks.suite_plan import suite_plan
from tests.benchmarks.crowdnav.with_rvo2 import PUBLISHED
from tests.benchmarks.crowdnav.write import NAME, POLICY

__all__ = ["CHANGES", "main", "rows"]

Data = dict[str, Any]


def _set(key: str, value: float) -> Callable[[Data, Data], None]:
    """A change of an option of the robot's policy."""

    def change(scenario: Data, policy: Data) -> None:
        policy[key] = value

    return change


def _step(seconds: float) -> Callable[[Data, Data], None]:
    def change(scenario: Data, policy: Data) -> None:
        scenario["world"]["step_time"] = seconds

    return change


def _whole(scenario: Data, policy: Data) -> None:
    del policy["responsibility"]


def _whole_with_margin(scenario: Data, policy: Data) -> None:
    _whole(scenario, policy)
    policy["safe_radius"] = 0.21


def _fast_at_goals(scenario: Data, policy: Data) -> None:
    for behavior in (policy, scenario["obstacle"][0]["behavior"]):
        del behavior["approach_time"]


def _near_goal(scenario: Data, policy: Data) -> None:
    scenario["robot"][0]["goal_threshold"] = 0.1


CHANGES: dict[str, Callable[[Data, Data], None]] = {
    "none": lambda scenario, policy: None,
    "`safe_radius: 0` for the robot": _set("safe_radius", 0),
    "`safe_radius: 0.21` for the robot (policy `orca-margin`)": _set("safe_radius", 0.21),
    "no `responsibility`: the robot makes the whole evasion, as `orca` does by default for people who do not see it": (
        _whole
    ),
    "the same with `safe_radius: 0.21`": _whole_with_margin,
    "no `approach_time`: robots do not slow down at the goal": _fast_at_goals,
    "`timeHorizon: 2` for the robot": _set("timeHorizon", 2),
    "the robot's `goal_threshold: 0.1` instead of its radius": _near_goal,
    "`step_time: 0.1`": _step(0.1),
    "`step_time: 0.05`": _step(0.05),
}
"""Row of the table -> what it changes in the scenario and in the robot's policy."""


def rows(seeds: int | None = None) -> Iterator[str]:
    """The rows of the table, of all seeds or of the first ones."""
    plan = suite_plan(NAME, policies=[POLICY], scenarios=[PUBLISHED], full=True)
    for name, change in CHANGES.items():
        scenario, policy = yaml.safe_load(plan.scenarios[0].text), yaml.safe_load(plan.policies[POLICY])
        change(scenario, policy)
        [row] = irsim.benchmark(
            yaml.safe_dump(scenario), policies=[policy], seeds=plan.seeds[:seeds], until=plan.until
        ).rows
        time = row.metrics["time_to_goal"].mean
        shown = "–" if time is None else f"{time:.2f} s"
        yield f"| {name} | {row.success.rate:.2f} | {row.collision.rate:.2f} | {shown} |"


def main() -> None:
    """Print the table."""
    print("| change | success | collision | time to goal |\n|---|---|---|---|")
    for line in rows():
        print(line, flush=True)


if __name__ == "__main__":
    main()
