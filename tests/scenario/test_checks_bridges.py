"""Robots that programs at the other end of bridges may drive, and that have no goal."""

from __future__ import annotations

import pytest

import irsim
from irsim.lookup.topics import lookup
from tests.bridges.peer import Peer

WORLD = "world: {width: 10, height: 10, time_limit: 1, step_time: 0.1}\n"
ROBOT = "kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [2, 2, 0]"
CODE = "driven-without-goal"


def findings(robots: str, bridges: str) -> list[tuple[str, str, str]]:
    report = irsim.validate(text=f"{WORLD}robot: {robots}\nbridges: {bridges}\n")
    assert report.valid, report.findings
    return [(f.code, f.severity, f.path) for f in report.findings if f.code in (CODE, "default-goal", "outside-world")]


@pytest.mark.parametrize(
    "bridge",
    [
        "{name: ros2}", "{name: ros1}", "{name: rosbridge, mode: real}", "{name: json_lines}",
        "{name: carla, follow: {robot_0: hero}}", "{name: ros2, robots: [robot_0]}",
    ],
)  # fmt: skip
def test_a_program_may_drive_a_robot_without_a_goal(bridge: str) -> None:
    assert findings(f"[{{{ROBOT}}}]", f"[{bridge}]") == [(CODE, "warning", "robot[0]")]


@pytest.mark.parametrize("bridge", ["{name: rosbag}", "{name: mujoco}", "{name: carla}", "{name: ros2, robots: [b]}"])
def test_bridges_that_do_not_drive_it(bridge: str) -> None:
    assert findings(f"[{{name: a, {ROBOT}}}, {{name: b, {ROBOT}, goal: [8, 8]}}]", f"[{bridge}]") == []


@pytest.mark.parametrize(
    "keys",
    [
        "goal: [8, 8]", "waypoints: [[4, 4], [8, 8]]", "goal: [1000, 0]", "behavior: {name: dash, wander: true}",
        "static: true",
    ],
)  # fmt: skip
def test_robots_that_it_is_not_said_of(keys: str) -> None:
    assert findings(f"[{{{ROBOT}, {keys}}}]", "[{name: ros2}]") == []


def test_one_warning_takes_the_place_of_the_hint_and_names_robots_of_an_entry() -> None:
    robots = f"[{{number: 2, {ROBOT.replace('[2, 2, 0]', '[[2, 2, 0], [4, 2, 0]]')}, behavior: {{name: dash}}}}]"
    assert findings(robots, "[{name: ros2}]") == [(CODE, "warning", "robot[0]")]
    [told] = [
        f for f in irsim.validate(text=f"{WORLD}robot: {robots}\nbridges: [{{name: ros2}}]").findings if f.code == CODE
    ]
    assert (
        told.message
        == "ros2 may drive 'robot_0', 'robot_1': without 'goal' they arrive at [1, 9, 0], and may end the run"
    )


def test_a_robot_with_a_behavior_is_told_of_a_goal_outside() -> None:
    keys = f"{ROBOT}, goal: [1000, 0], behavior: {{name: dash}}"
    assert findings(f"[{{{keys}}}]", "[{name: ros2}]") == [("outside-world", "hint", "robot[0].goal")]


def test_a_bridge_of_the_command_is_checked_too() -> None:
    with Peer(lambda message: None) as peer:
        bridge = {"name": "json_lines", "address": peer.address}
        result = irsim.run(text=f"{WORLD}robot: [{{{ROBOT}}}]\n", seed=0, bridges=[bridge])
    assert [w.path for w in result.warnings if w.code == CODE] == ["robot[0]"]


def test_the_code_is_explained() -> None:
    answer = lookup(CODE)
    assert "time_limit" in answer.text
    assert "bridges:" in str(answer.example)
