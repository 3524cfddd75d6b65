"""`arrive_mode: state`: who reaches the heading of its goal, and what is said of those who do not."""

from __future__ import annotations

import math

import pytest

import irsim
from irsim.lookup import lookup

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


@pytest.mark.parametrize(
    ("distance", "turn", "arrives"),
    [(0, 0.14, True), (0, 0.16, False), (0.14, 0, True), (0.16, 0, False), (0.1, 0.1, True), (0.11, 0.11, False)],
)
def test_the_threshold_of_distance_and_turn_is_that_of_its_description(
    distance: float, turn: float, arrives: bool
) -> None:
    text = (
        "robot: {kinematics: {name: omni_angular}, state: [1, 1, 0], arrive_mode: state, goal_threshold: 0.15, "
        f"goal: [{1 + distance}, 1, {turn}]}}\n"
    )
    assert (irsim.run(text=text, steps=1).outcome == "success") is arrives
    said = lookup("robot.goal_threshold").text
    assert "sqrt(dx^2 + dy^2 + turn^2)" in said
    assert "0.15 means under 0.15 m and under 0.15 rad (8.6 degrees)" in said
    assert math.degrees(0.15) == pytest.approx(8.6, abs=0.01)
