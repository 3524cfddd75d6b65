"""`replay` among others: contacts do not push a recorded obstacle away, and a recording arrives when it ends."""

from __future__ import annotations

import numpy as np
import pytest

import irsim
from irsim.api import read_scenario

CROWD = """
world: {{width: 10, height: 10, step_time: 0.1, collision_mode: {mode}}}
robot:
  - {{kinematics: {{name: omni}}, shape: {{name: circle, radius: 0.3}}, state: [5, {y}, 0], goal: [5, 5],
     behavior: {{name: dash}}, mass: 50}}
obstacle:
  - kinematics: {{name: {drive}}}
    shape: {{name: circle, radius: 0.3}}
    behavior:
      name: replay
      times: [0, 4, 6]
      poses: [[1, 5], [9, 5], [9, 8]]
  - {{name: box, shape: {{name: rectangle, length: 0.5, width: 0.5}}, state: [7, 5.1, 0], mass: 2}}
  - {{name: post, shape: {{name: circle, radius: 0.3}}, state: [9, 6.5, 0]}}
"""
LAP = """
world: {{width: 10, height: 10, step_time: 0.1}}
robot:
  - kinematics: {{name: omni}}
    shape: {{name: circle, radius: 0.2}}
    {keys}
    behavior:
      name: replay
      times: {times}
      poses: {poses}
"""
SQUARE = "[[2, 2], [8, 2], [8, 8], [2, 8], [2, 2]]"


def make(text: str) -> irsim.Env:
    scenario, _ = read_scenario(text=text, strict=True)
    return irsim.Env(scenario, headless=True, log_level="ERROR", seed=1)


@pytest.mark.parametrize("drive", ["omni", "omni_angular"])
def test_in_contact_mode_a_recorded_obstacle_is_where_it_was_recorded(drive: str) -> None:
    env = make(CROWD.format(mode="contact", drive=drive, y=5.0))
    walker, box = env.obstacle_list[0], env.obstacle_list[1]
    touched = False
    for step in range(1, 61):
        env.step()
        touched = touched or np.hypot(*(env.robot.state[:2, 0] - walker.state[:2, 0])) < 0.6 + 1e-3
        time = step * 0.1
        place = [1 + 2 * time, 5] if time <= 4 else [9, 5 + 1.5 * (time - 4)]
        np.testing.assert_allclose(walker.state[:2, 0], place, atol=1e-9)
    assert touched
    assert not walker.pushable
    assert walker.inv_mass == 0
    assert np.hypot(*(box.state[:2, 0] - (7, 5.1))) > 0.3, "what it meets is pushed by it"
    assert np.hypot(*(env.robot.state[:2, 0] - walker.state[:2, 0])) > 0.59


def test_a_recorded_obstacle_takes_who_stands_in_its_way_along() -> None:
    env = make(CROWD.format(mode="contact", drive="omni", y=5.0))
    for _ in range(25):
        env.step()
        gap = float(np.hypot(*(env.robot.state[:2, 0] - env.obstacle_list[0].state[:2, 0])))
        assert gap > 0.6 - 1e-3, "no robot is inside of it"


def test_a_robot_that_ends_where_it_began_arrives_when_its_recording_ends() -> None:
    result = irsim.run(text=LAP.format(keys="", times="[0, 2, 4, 6, 8]", poses=SQUARE), seed=0)
    [robot] = result.robots
    assert (result.outcome, robot.time_to_goal, result.steps) == ("success", pytest.approx(8.0), 80)
    assert robot.path_length == pytest.approx(24.0)
    assert [event.kind for event in result.events] == ["arrival"]


def test_a_robot_that_passes_its_last_place_goes_on() -> None:
    poses = "[[2, 5], [5, 5], [8, 5], [8, 8], [5, 5]]"
    result = irsim.run(text=LAP.format(keys="", times="[0, 2, 4, 6, 8]", poses=poses), seed=0)
    assert (result.outcome, result.robots[0].time_to_goal) == ("success", pytest.approx(8.0))


@pytest.mark.parametrize(("end", "arrival"), [(8.0, 8.0), (7.96, 7.9), (8.04, 8.0)])
def test_an_end_between_two_steps(end: float, arrival: float) -> None:
    result = irsim.run(text=LAP.format(keys="", times=f"[0, 2, 4, 6, {end}]", poses=SQUARE), seed=0)
    assert result.robots[0].time_to_goal == pytest.approx(arrival, abs=0.1001)
    assert result.outcome == "success"


def test_a_goal_that_is_written_elsewhere_counts_on_the_way() -> None:
    keys = "goal: [8, 8]"
    result = irsim.run(text=LAP.format(keys=keys, times="[0, 2, 4, 6, 8]", poses=SQUARE), seed=0)
    assert result.robots[0].time_to_goal == pytest.approx(4.0, abs=0.11)


def test_somebody_who_stands_in_one_place_arrives_at_once_or_at_the_end() -> None:
    once = irsim.run(text=LAP.format(keys="", times="[0]", poses="[[3, 3]]"), seed=0)
    stays = irsim.run(text=LAP.format(keys="", times="[0, 2]", poses="[[3, 3], [3, 3]]"), seed=0)
    assert once.robots[0].time_to_goal == 0
    assert stays.robots[0].time_to_goal == pytest.approx(2.0)


def test_an_obstacle_that_comes_back_is_said_to_arrive_once_and_late() -> None:
    text = CROWD.format(mode="stop", drive="omni", y=2.0).replace(
        "[[1, 5], [9, 5], [9, 8]]", "[[1, 5], [9, 5], [1, 5]]"
    )
    env = make(text)
    for _ in range(60):
        env.step()
    mine = [event for event in env.events if event.object == env.obstacle_list[0].name and event.kind == "arrival"]
    assert [round(event.time, 3) for event in mine] == [6.0]


def test_a_reset_replays_it_again() -> None:
    env = make(LAP.format(keys="", times="[0, 2, 4, 6, 8]", poses=SQUARE))
    for _ in range(2):
        assert not env.robot.arrive
        steps = 0
        while not env.done():
            env.step()
            steps += 1
        assert steps == 80
        env.reset()
