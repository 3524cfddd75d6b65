"""`arrive_mode: state`: who reaches the heading of its goal, and what is said of those who do not."""

from __future__ import annotations

import math

import pytest

import irsim

BEHAVIORS = ("dash", "follow", "orca", "rvo", "sfm")
LIMITS = (
    "vel_max: [1, 1, 1]",
    "vel_max: [1, 1, 3], vel_min: [-1, -1, -3], acce: [2, 2, 2]",
    "vel_max: [1, 1, 3], vel_min: [-1, -1, -3]",
    "vel_max: [1, 0.6, 0.4], vel_min: [-1, -0.6, -0.4]",
)


def in_all_directions(behavior: str, drive: str, more: str, count: int = 16) -> str:
    """Robots far from each other, each with a goal in another direction and with another heading."""
    lines = ["world: {width: 160, height: 160, time_limit: 60}", "robot:"]
    for k in range(count):
        x, y, angle = 20 + 40 * (k % 4), 20 + 40 * (k // 4), 2 * math.pi * k / count
        goal = [x + 5 * math.cos(angle), y + 5 * math.sin(angle), (1.5708, -0.3, -2.5, 3.1)[k % 4]]
        lines.append(
            f"  - {{kinematics: {{name: {drive}}}, shape: {{name: circle, radius: 0.2}}, state: [{x}, {y}, 0], "
            f"goal: [{goal[0]:.4f}, {goal[1]:.4f}, {goal[2]}], arrive_mode: state, behavior: {{name: {behavior}}}, "
            f"{more}}}"
        )
    return "\n".join(lines)


@pytest.mark.parametrize("behavior", BEHAVIORS)
@pytest.mark.parametrize("limits", LIMITS)
def test_omni_angular_arrives_with_its_heading_from_all_directions(behavior: str, limits: str) -> None:
    text = in_all_directions(behavior, "omni_angular", limits)
    assert "heading-not-reached" not in [finding.code for finding in irsim.validate(text=text).findings]
    result = irsim.run(text=text, seed=1)
    assert result.outcome == "success", result.reason


def test_headings_are_reached_at_each_waypoint() -> None:
    text = in_all_directions("orca", "omni_angular", "vel_max: [1, 1, 1]", 1)
    text = text.replace("goal: [25.0000, 20.0000, 1.5708]", "waypoints: [[24, 20, 1.57], [20, 24, -1.57], [20, 20, 3]]")
    result = irsim.run(text=text, seed=1)
    assert result.outcome == "success", result.reason
    assert [event.kind for event in result.events] == ["waypoint", "waypoint", "arrival"]


@pytest.mark.parametrize("behavior", BEHAVIORS)
def test_without_a_heading_to_reach_nobody_turns_to_one(behavior: str) -> None:
    text = in_all_directions(behavior, "omni_angular", "vel_max: [1, 1, 1]", 1).replace(", arrive_mode: state", "")
    result = irsim.run(text=text, seed=1)
    assert result.outcome == "success"
    assert result.robots[0].pose[2] == 0


def test_a_drive_that_does_not_turn_there_is_told_and_says_why() -> None:
    text = in_all_directions("dash", "diff", "vel_max: [1, 1]", 1)
    report = irsim.validate(text=text, simulate=True)
    assert "heading-not-reached" in [finding.code for finding in report.findings]
    assert report.dry_run is not None
    assert "it is at its goal, but its heading is off by 1.57 rad" in report.dry_run.summary
    assert "its heading is off by 1.57 rad" in (irsim.run(text=text, seed=1).reason or "")
