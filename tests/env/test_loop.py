"""The loop every script writes: make, step, done, reset, end."""

from __future__ import annotations

import copy
import math
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import irsim
from tests.env.driving import Make, take_steps

ONE = """
world: {height: 10, width: 10}
robot:
  kinematics: {name: diff}
  shape: {name: circle, radius: 0.2}
  state: [1, 1, 0]
  goal: [3, 1, 0]
  behavior: {name: dash}
  goal_threshold: 0.05
"""

WALL = """
world: {height: 10, width: 10}
robot:
  kinematics: {name: diff}
  shape: {name: circle, radius: 0.5}
  state: [1, 1, 0]
  goal: [9, 1, 0]
  behavior: {name: dash}
obstacle:
  - {shape: {name: rectangle, length: 1, width: 4}, state: [4, 1, 0]}
"""


@pytest.fixture
def env(make: Make) -> Any:
    return make(ONE)


def test_dash_reaches_its_goal_in_closed_form(env: Any) -> None:
    steps = 0
    while not env.done():
        env.step()
        steps += 1
    # 1 m/s for 0.1 s a step; arrived once less than 0.05 m are left of the 2 m
    assert steps == 20
    assert (env.robot.state[0, 0], env.time, env.status) == (pytest.approx(3.0, abs=1e-12), 2.0, "Arrived")
    assert env.outcome == "success"
    assert [(e.kind, e.object, e.step) for e in env.events] == [("arrival", "robot_0", 20)]


def test_a_collision_stops_and_is_told(make: Make) -> None:
    env = make(WALL)
    for _ in range(100):
        env.step()
        if env.done():
            break
    # the disc touches x = 3.5 when its centre is at 3.0
    assert (env.robot.state[0, 0], env.robot.collision) == (pytest.approx(3.0, abs=0.11), True)
    assert (env.robot.stop_flag, env.status, env.outcome) == (True, "Collision", "collision")
    (event,) = env.events
    assert (event.kind, event.object, event.partner) == ("collision", "robot_0", "obstacle_1")
    assert (event.x, event.y) == (pytest.approx(3.5, abs=0.11), pytest.approx(1.0, abs=0.3))
    assert [o.name for o in env.robot.collision_obj] == ["obstacle_1"]
    before = env.robot.state
    env.step()
    assert np.array_equal(env.robot.state, before)
    assert not env.robot.velocity.any()


def test_initial_overlap_is_visible_at_once(make: Make) -> None:
    env = make(WALL.replace("state: [1, 1, 0]", "state: [4, 1, 0]"))
    assert (env.robot.collision, env.status, env.done()) == (True, "Collision", True)
    before = env.robot.state
    env.step()
    assert np.array_equal(env.robot.state, before)


def test_reset_repeats_the_scene(env: Any) -> None:
    first = [env.step() or env.robot.state for _ in range(5)]
    env.reset()
    assert (env.time, env.status, env.robot.trajectory, env.events) == (0, "Reset", [], [])
    again = [env.step() or env.robot.state for _ in range(5)]
    assert all(np.array_equal(a, b) for a, b in zip(first, again, strict=True))


def test_state_is_a_snapshot_and_the_trajectory_holds_every_step(env: Any) -> None:
    kept = env.get_robot_state()
    take_steps(env, 4)
    assert kept[0, 0] == 1.0
    assert [round(s[0, 0], 9) for s in env.robot.trajectory] == [1.1, 1.2, 1.3, 1.4]
    assert env.robot.trajectory[0].shape == (3, 1)


TWO = """
world: {height: 10, width: 10}
robot:
  - number: 2
    kinematics: {name: diff}
    state: [[1, 1, 0], [1, 5, 0]]
    goal: [[9, 1, 0], [9, 5, 0]]
    behavior: {name: dash}
"""


@pytest.mark.parametrize(
    ("action", "target", "expected"),
    [
        ([[0.5, 0.1], [0.2, 0.2]], None, [[0.5, 0.1], [0.2, 0.2]]),
        ([None, [0.2, 0.2]], None, [[1, 0], [0.2, 0.2]]),
        ({"robot_1": [0.3, 0.3]}, None, [[1, 0], [0.3, 0.3]]),
        ({0: [0.4, 0.4]}, None, [[0.4, 0.4], [1, 0]]),
        ([0.5, 0.1], 1, [[1, 0], [0.5, 0.1]]),
        ([0.5, 0.1], [0, 1], [[0.5, 0.1], [0.5, 0.1]]),
        ([[0.5, 0.1], [0.2, 0.2]], [1, 0], [[0.2, 0.2], [0.5, 0.1]]),
        ([0.5, 0.1], "robot_1", [[1, 0], [0.5, 0.1]]),
    ],
)
def test_actions_find_their_robots(make: Make, action: Any, target: Any, expected: list[list[float]]) -> None:
    env = make(TWO)
    env.step(action, target)
    assert [robot.velocity[:, 0].tolist() for robot in env.robot_list] == expected
    env.step()
    assert [robot.velocity[:, 0].tolist() for robot in env.robot_list] != expected, "an action holds for one step"


@pytest.mark.parametrize(
    ("action", "target", "error", "says"),
    [
        ([0.1, 0.1], 17, ValueError, "no object with id or name 17"),
        ([0.1, 0.1, 0.1], None, ValueError, "takes 2 numbers"),
        ([math.nan, 0.0], None, ValueError, "not finite"),
        ("left", None, TypeError, "action must be"),
        ({"missing": [0, 0]}, None, ValueError, "missing"),
    ],
)
def test_bad_actions_say_what_is_wrong(make: Make, action: Any, target: Any, error: type[Exception], says: str) -> None:
    env = make(TWO)
    with pytest.raises(error, match=says):
        env.step(action, target)


def test_rollout_equals_steps(make: Make) -> None:
    stepped, rolled = make(WALL), make(WALL)
    poses = []
    while not stepped.done():
        stepped.step()
        poses.append(stepped.simulation.pose.copy())
    result = rolled.rollout(1000)
    assert len(result) == len(poses)
    assert np.array_equal(result.pose, np.array(poses))
    assert rolled.events == stepped.events
    assert result.time[-1] == pytest.approx(stepped.sim_time)
    assert rolled.robot.trajectory[-1].tolist() == stepped.robot.trajectory[-1].tolist()


def test_a_script_may_go_on_after_the_end(make: Make, tmp_path: Path) -> None:
    env = make(ONE, headless=False, display=False, save_ani=True)
    env.path_param.ani_path = str(tmp_path)
    for name, frames in (("a", 2), ("b", 3)):
        for _ in range(frames):
            env.step()
            env.render(0)
        env.end(0, ani_name=name)
        env.end(0, ani_name="never")
        with Image.open(tmp_path / f"{name}.gif") as animation:
            assert getattr(animation, "n_frames", 1) == frames
        env.reset()
        assert env.time == 0
    assert not (tmp_path / "never.gif").exists()
    assert len(env.rollout(2).time) == 2


def test_missing_file_names_places_and_near_matches(tmp_path: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "crossing.yaml").write_text(ONE)
    monkeypatch.chdir(tmp_path)
    with pytest.raises(FileNotFoundError, match=r"crossing\.yaml") as caught:
        irsim.make("crosing.yaml")
    assert str(tmp_path) in str(caught.value)


def test_unregistered_behavior_fails_at_the_first_step_only(make: Make) -> None:
    text = ONE.replace("{name: dash}", "{name: test_nowhere}")
    with pytest.raises(ValueError, match="test_nowhere"):
        make(text).step()
    with pytest.raises(irsim.ScenarioError, match="unknown-behavior"):
        make(text, strict=True)


def test_new_initial_values_are_kept_apart(env: Any) -> None:
    env.step()
    env.robot.set_state([2, 2, 1], init=True)
    env.reset()
    assert env.robot.state[:, 0].tolist() == [2, 2, 1]
    assert not env.robot.velocity.any(), "the velocity of that moment is not the initial one"
    env.step()
    env.robot.set_velocity([0.3, 0.2], init=True)
    env.reset()
    assert (env.robot.state[:, 0].tolist(), env.robot.velocity[:, 0].tolist()) == ([2, 2, 1], [0.3, 0.2])


def test_a_second_thread_is_turned_away(make: Make) -> None:
    env = make(
        "world: {width: 60, height: 60}\n"
        "robot: {number: 300, kinematics: {name: diff}, shape: {name: circle, radius: 0.1},"
        " distribution: {name: random, min_distance: 0.3}, behavior: {name: dash, wander: true}}\n"
    )
    refused: list[str] = []

    def work() -> None:
        for _ in range(100):
            try:
                env.step()
            except RuntimeError as error:
                refused.append(str(error))

    threads = [threading.Thread(target=work) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert int(env.simulation.count[0]) + len(refused) == 300
    assert all("another thread" in message for message in refused)


def test_passing_through_something_unobstructed_is_no_collision(make: Make) -> None:
    env = make(WALL.replace("state: [4, 1, 0]}", "state: [4, 1, 0], unobstructed: true}"))
    while not env.done():
        env.step()
    assert env.outcome == "success"


def test_a_copy_is_an_environment_of_its_own(env: Any) -> None:
    other = copy.copy(env)
    other.step()
    assert (env.time, other.time) == (0.0, 0.1)


LIMITS = """
world: {height: 10, width: 10}
robot:
  - {kinematics: {name: diff}, state: [1, 1, 0], shape: {name: circle, radius: 0.2}}
  - {kinematics: {name: diff}, state: [1, 5, 0], shape: {name: circle, radius: 0.2}, acce: [1, .inf]}
  - {kinematics: {name: acker}, state: [5, 5, 0], shape: {name: rectangle, length: 1, width: 0.5, wheelbase: 0.6}}
  - {kinematics: {name: acker, wheelbase: 0.4}, state: [5, 8, 0],
     shape: {name: rectangle, length: 1, width: 0.5, wheelbase: 0.6}}
"""


def test_an_action_beyond_the_limits_of_a_drive_is_cut_and_that_is_said_once(make: Make, capsys: Any) -> None:
    env = make(LIMITS, log_level="WARNING")
    env.step([1, 1])
    env.step(np.array([[0.1], [0.2]]), "robot_1")
    assert "cut" not in capsys.readouterr().out
    take_steps(env, 3, [5, -5])
    printed = capsys.readouterr().out
    assert printed.count("is cut") == 1
    assert "robot_0: action [5, -5] is cut to the limits of its drive, now [-1, -1] to [1, 1]" in printed
    assert env.robot.velocity.ravel().tolist() == [1, -1]


def test_an_action_beyond_the_acceleration_of_a_drive_is_cut(make: Make, capsys: Any) -> None:
    env = make(LIMITS, log_level="WARNING")
    env.step([0.1, 0], 1)
    assert "cut" not in capsys.readouterr().out
    env.step([1, 0], 1)
    assert "robot_1: action [1, 0] is cut" in capsys.readouterr().out
    assert env.robot_list[1].velocity[0, 0] == pytest.approx(0.2)


def test_the_wheelbase_of_an_object_is_that_of_its_shape(make: Make) -> None:
    robots = make(LIMITS).robot_list
    assert [robot.wheelbase for robot in robots] == [None, None, 0.6, 0.6]
    assert (robots[3].kf.wheelbase, robots[3].info.wheelbase) == (0.4, 0.6)


def test_the_resolution_of_a_map_is_a_number(env: Any) -> None:
    with pytest.raises(TypeError, match=r"resolution of a map must be a number \[m\], got 'a'"):
        env.get_map("a")


def test_surplus_actions_are_a_warning_and_an_error_if_strict(make: Make, capsys: pytest.CaptureFixture[str]) -> None:
    actions = [[0.1, 0.0], [0.2, 0.0]]
    make(ONE, log_level="WARNING").step(actions)
    assert "2 actions for 1 object(s)" in capsys.readouterr().out
    with pytest.raises(ValueError, match=r"2 actions for 1 object\(s\)"):
        make(ONE, strict=True).step(actions)


@pytest.mark.parametrize("steps", [1.5, math.nan, "a", None, -1, True])
def test_steps_to_advance_are_a_whole_number(make: Make, steps: Any) -> None:
    env = make(ONE)
    with pytest.raises(ValueError, match=r"steps cannot be .* give a whole number, 0 or more"):
        env.advance(steps)
    assert env.time == 0


def test_more_steps_than_the_core_counts_end_when_all_have_arrived(make: Make) -> None:
    env = make(ONE)
    assert 10 < env.advance(10**30) < 100


def test_numbers_beyond_float_are_no_action(make: Make) -> None:
    with pytest.raises(ValueError, match="an action is numbers, not") as raised:
        make(ONE).step([10**400, 0])
    assert len(str(raised.value)) < 120


def test_scenarios_are_named_by_paths(tmp_path: Path) -> None:
    (tmp_path / "one.yaml").write_text(ONE)
    assert irsim.make(str(tmp_path / "one.yaml").encode(), headless=True).time == 0
    with pytest.raises(ValueError, match=r"named by its file, not by \{'world'.*give the path of a YAML file"):
        irsim.make({"world": {}})  # type: ignore[arg-type]
