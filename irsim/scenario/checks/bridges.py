"""Checks robots that the program at the other end of a bridge may drive."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from irsim.common.text import listed, quoted
from irsim.scenario.checks._context import Context
from irsim.scenario.messages.findings import Finding, warning
from irsim.scenario.resolve.expand import DEFAULT_GOAL
from irsim.scenario.resolve.resolved import ObjectRecord, ResolvedScenario
from irsim.scenario.yaml.formatting import flow

__all__ = ["check", "driven_without_goal"]

_MAX_NAMED = 3
"""Number of robots that a message names."""


def check(context: Context) -> Iterator[Finding]:
    """Check the bridges of the scenario."""
    yield from driven_without_goal(context.resolved, context.resolved.bridges)


def driven_without_goal(scenario: ResolvedScenario, bridges: Sequence[Any]) -> Iterator[Finding]:
    """Robots that a program may drive, and that arrive at a goal that the scenario does not name.

    Args:
        scenario: The scenario.
        bridges: Options of bridges.
    """
    robots = [record.name for record in scenario.robots()]
    driver = {name: bridge.name for bridge in reversed(bridges) for name in bridge.driven(robots)}
    records = [record for record in scenario.robots() if record.name in driver and _goes_to_default(scenario, record)]
    for path in dict.fromkeys(record.path for record in records):
        names = [record.name for record in records if record.path == path]
        whose = listed([quoted(name) for name in names], _MAX_NAMED)
        they = "they arrive" if len(names) > 1 else "it arrives"
        yield warning(
            "driven-without-goal",
            path,
            f"{driver[names[0]]} may drive {whose}: without 'goal' {they} at {flow(DEFAULT_GOAL)}, and may end the run",
            fix="write the goal; where only the other program knows it, one out of reach, such as 'goal: [1000, 0]', "
            "and 'time_limit' under 'world'",
        )


def _goes_to_default(scenario: ResolvedScenario, record: ObjectRecord) -> bool:
    """Whether an object can move to the default goal."""
    moves = record.kinematics is not None and not record.static
    return moves and not record.wander and not scenario.has_written_goal(record)
