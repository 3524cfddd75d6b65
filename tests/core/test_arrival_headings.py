"""`arrive_mode: state`: who reaches the heading of its goal, and what is said of those who do not."""

from __future__ import annotations

import math
import re

import pytest

import irsim
from irsim.bundled import templates
from irsim.lookup import lookup
from tests.core.worlds import assert_success

BEHAVIORS = ("dash", "follow", "orca", "avocado", "footprint_orca", "rvo", "sfm")
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


def assert_arrive_and_stay(env: irsim.Env, steps: int) -> None:
    env.rollout(steps, until_done=True)
    assert all(robot.arrive for robot in env.robot_list), [robot.state[:, 0] for robot in env.robot_list]
    env.rollout(100, until_done=False)
    assert all(robot.arrive for robot in env.robot_list)


@pytest.mark.parametrize("behavior", BEHAVIORS)
@pytest.mark.parametrize("limits", LIMITS)
def test_omni_angular_arrives_with_its_heading_from_all_directions(behavior: str, limits: str) -> None:
    text = in_all_directions(behavior, "omni_angular", limits)
    assert "heading-not-reached" not in [finding.code for finding in irsim.validate(text=text).findings]
    assert_success(text, seed=1)


@pytest.mark.parametrize("behavior", BEHAVIORS)
@pytest.mark.parametrize(
    "limits",
    [
        "vel_max: [1, 1], vel_min: [-1, -1]",
        "vel_max: [1, 2], vel_min: [-1, -2], acce: [2, 4], goal_threshold: 0.05",
        "vel_max: [1, 0.8], vel_min: [0, -0.8], acce: [0.8, 2], goal_threshold: 0.2",
    ],
)
def test_diff_turns_on_the_spot_at_its_goal_and_stays_there(make, behavior: str, limits: str) -> None:
    text = in_all_directions(behavior, "diff", limits, 8)
    assert "heading-not-reached" not in [finding.code for finding in irsim.validate(text=text).findings]
    env = make(text)
    assert_arrive_and_stay(env, 500)
    assert max(abs(robot.velocity).max() for robot in env.robot_list) < 1e-9


@pytest.mark.parametrize("behavior", ["orca", "avocado", "sfm", "footprint_orca"])
def test_members_of_a_group_turn_at_their_goals_too(behavior: str) -> None:
    text = (
        "world: {width: 20, height: 20, time_limit: 60}\nrobot:\n  - {number: 4, kinematics: {name: diff}, "
        "shape: {name: circle, radius: 0.2}, arrive_mode: state, "
        "state: [[2, 2, 0], [2, 6, 0], [2, 10, 0], [2, 14, 0]], "
        f"goal: [[9, 2, 1], [9, 6, -1], [9, 10, 3], [9, 14, -2]], group_behavior: {{name: {behavior}}}}}"
    )
    assert_success(text, seed=1)


CAR = (
    "world: {{width: 20, height: 20, time_limit: 90}}\nrobot: {{kinematics: {{name: acker, wheelbase: 0.5}}, "
    "shape: {{name: rectangle, length: 0.8, width: 0.4, wheelbase: 0.5}}, state: {state}, goal: {goal}, "
    "vel_max: [1, 0.6], vel_min: [{back}, -0.6], acce: {acce}, arrive_mode: state, goal_threshold: 0.15, "
    "behavior: {{name: follow, local: {local}}}}}\n"
)


@pytest.mark.parametrize("heading", [0, 1.57, 3.14, -1.57, 0.7])
@pytest.mark.parametrize(("back", "acce", "local"), [(-1, "[2, 2]", "dash"), (0, "[.inf, .inf]", "orca")])
def test_a_car_comes_in_with_the_heading_under_follow(make, heading: float, back: float, acce: str, local: str) -> None:
    text = CAR.format(state="[4, 10, 0]", goal=f"[12, 11, {heading}]", back=back, acce=acce, local=local)
    assert "heading-not-reached" not in [finding.code for finding in irsim.validate(text=text).findings]
    assert_arrive_and_stay(make(text), 900)


@pytest.mark.parametrize("goal", ["[10, 10.6, 0]", "[10, 10, 3.14]", "[9, 10, 0]"])
def test_a_car_parks_at_a_pose_beside_it(goal: str) -> None:
    text = CAR.format(state="[10, 10, 0]", goal=goal, back=-1, acce="[2, 2]", local="dash")
    assert_success(text, seed=1)


@pytest.mark.parametrize(("acce", "most"), [("[1, 1]", 30), ("[1, 0.5]", 75)])
def test_a_car_whose_wheels_turn_slowly_parks_in_reasonable_time(acce: str, most: float) -> None:
    text = (
        "world: {{width: 12, height: 12, time_limit: 90}}\n"
        "robot: {{kinematics: {{name: acker}}, shape: {{name: rectangle, length: 1, width: 0.5, wheelbase: 0.7}}, "
        "acce: {}, state: [{}, 0], goal: [9, 8, 0.5], arrive_mode: state, behavior: {{name: follow}}}}\n"
    )
    for start in ("2, 2, 0", "2, 8, 1", "8, 3, 2"):
        result = assert_success(text.format(acce, start), seed=1)
        assert result.sim_time < most, start


@pytest.mark.parametrize("limit", ["", ", psi_max: 0.6"])
def test_a_car_whose_steering_rate_is_commanded_arrives(limit: str) -> None:
    """Without a limit of its own, its wheels could turn so far that they come back too late."""
    for behavior, mode in (("follow", "position"), ("follow", "state"), ("orca", "position"), ("rvo", "position")):
        for start in ("3, 3, 2", "3, 12, -3", "12, 4, 0", "8, 12, 1.5"):
            text = (
                "world: {width: 16, height: 16, time_limit: 60}\n"
                f"robot: {{kinematics: {{name: acker, mode: angular{limit}}}, shape: {{name: rectangle, length: 1, "
                f"width: 0.5, wheelbase: 0.7}}, state: [{start}, 0], goal: [9, 8, 0.5], goal_threshold: 0.3, "
                f"arrive_mode: {mode}, behavior: {{name: {behavior}}}}}\n"
            )
            result = irsim.run(text=text, seed=1)
            assert result.outcome == "success", (behavior, mode, start, result.reason)


def test_a_car_backs_into_a_bay() -> None:
    text = CAR.format(state="[4, 10, 0]", goal="[10, 8, 1.57]", back=-1, acce="[2, 2]", local="dash")
    text += (
        "obstacle:\n  - {number: 2, shape: {name: rectangle, length: 0.2, width: 1.6}, "
        "state: [[9.4, 8.3, 0], [10.6, 8.3, 0]]}\n"
        "  - {shape: {name: rectangle, length: 1.4, width: 0.2}, state: [10, 7.3, 0]}\n"
    )
    assert_success(text, seed=1)


@pytest.mark.parametrize("behavior", ["dash", "orca", "rvo"])
def test_a_car_under_another_behavior_is_told_at_once(behavior: str) -> None:
    text = CAR.format(state="[4, 10, 0]", goal="[12, 11, 1.57]", back=-1, acce="[2, 2]", local="dash")
    text = text.replace("{name: follow, local: dash}", f"{{name: {behavior}}}")
    (diagnostic,) = [finding for finding in irsim.validate(text=text).findings if finding.code == "heading-not-reached"]
    assert f"behavior: {{name: follow, local: {behavior}}}" in (diagnostic.fix or "")


def test_a_car_without_reverse_says_that_no_path_leads_to_the_heading_of_its_goal() -> None:
    text = """
world: {width: 20, height: 10, boundary: walls, time_limit: 60}
robot: {kinematics: {name: acker}, shape: {name: rectangle, length: 0.6, width: 0.4, wheelbase: 0.35}, state: [3, 5, 0],
  goal: [15, 7.4, 1.57], arrive_mode: state, goal_threshold: 0.2, behavior: {name: follow}, vel_max: [1.2, 0.8],
  vel_min: [0, -0.8], acce: [1, 4]}
obstacle:
  - {shape: {name: rectangle, length: 0.2, width: 2}, state: [14.2, 7.9, 0]}
  - {shape: {name: rectangle, length: 0.2, width: 2}, state: [15.8, 7.9, 0]}
"""
    result = irsim.run(text=text, seed=1)
    assert result.outcome == "timeout"
    assert "there is no path to it with that heading without reverse (vel_min)" in result.reason
    assert [event.kind for event in result.events if event.object == "robot_0"] == ["no_path"]
    assert irsim.run(text=text.replace("[0, -0.8]", "[-1.2, -0.8]"), seed=1).outcome == "success"


def test_a_car_that_finds_no_path_without_a_heading_is_told_of_it() -> None:
    park = templates.fill(templates.load("car-park"), {}).replace("{name: dash}", "{name: follow}")
    text = re.sub(r"waypoints: .*", "goal: [17, 13.5, 1.57]", park).replace("vel_min: [-2.0,", "vel_min: [0,")
    reason = str(irsim.run(text=text).reason)
    assert (
        "there is no path to it (in tight places a car finds one with arrive_mode: state and the heading in" in reason
    )
    assert "backs up with vel_min below 0" in reason
    for cure in (("    goal:", "    arrive_mode: state\n    goal:"), ("vel_min: [0,", "vel_min: [-2,")):
        assert irsim.run(text=text.replace(*cure)).outcome == "success", cure


def test_whoever_turns_at_its_goal_lets_others_pass() -> None:
    """Two others pass the place where a robot turns; no object touches it, and it arrives in the end."""
    text = (
        "world: {width: 20, height: 10, time_limit: 60}\nrobot:\n"
        "  - {kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [6, 5, 3], goal: [8, 5, 3.1], "
        "arrive_mode: state, behavior: {name: orca}}\n"
        "  - {number: 2, kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, behavior: {name: orca}, "
        "state: [[2, 5.1, 0], [14, 4.9, 3.14]], goal: [[14, 5.1], [2, 4.9]]}"
    )
    assert_success(text, seed=1)


def test_headings_are_reached_at_each_waypoint() -> None:
    text = in_all_directions("orca", "omni_angular", "vel_max: [1, 1, 1]", 1)
    text = text.replace("goal: [25.0000, 20.0000, 1.5708]", "waypoints: [[24, 20, 1.57], [20, 24, -1.57], [20, 20, 3]]")
    result = assert_success(text, seed=1)
    assert [event.kind for event in result.events] == ["waypoint", "waypoint", "arrival"]


@pytest.mark.parametrize("behavior", BEHAVIORS)
def test_without_a_heading_to_reach_nobody_turns_to_one(behavior: str) -> None:
    text = in_all_directions(behavior, "omni_angular", "vel_max: [1, 1, 1]", 1).replace(", arrive_mode: state", "")
    result = assert_success(text, seed=1)
    assert result.robots[0].pose[2] == 0


def test_a_drive_that_does_not_turn_there_is_told_and_says_why() -> None:
    text = in_all_directions("dash", "omni", "vel_max: [1, 1]", 1)
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
