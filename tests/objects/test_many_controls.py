"""A drive of four controls, of which the core keeps three, does with the same commands what one of three does."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from irsim.components.kinematics._handler import KinematicsHandler
from irsim.lib import register_kinematics
from tests.env.driving import Make

SCENE = """
world: {width: 40, height: 40, collision_mode: MODE, step_time: 0.1}
robot:
  - {name: a, kinematics: {name: wheels_COUNT}, shape: {name: circle, radius: 0.2},
     state: [5, 5, 0], goal: [30, 5]BEHAVIOR}
  - {name: b, kinematics: {name: wheels_COUNT}, shape: {name: circle, radius: 0.2},
     state: [5, 15, 0], goal: [30, 15]BEHAVIOR}
"""
ACTIONS = [(1, 0, 0.5), None, (2, 1, 0), (2, 1, 0), None, None, (0.3, 0, 0)]
HOOKS = ("none", "step", "gen_behavior_vel", "mid_process", "pre_process", "post_process")


def register(count: int) -> None:
    """Register `wheels_3` or `wheels_4`, whose fourth control does nothing."""

    @register_kinematics(f"wheels_{count}")
    class Wheels(KinematicsHandler):
        action_dim, vel_max, vel_min, acce = count, (2.0,) * count, (-2.0,) * count, (5.0,) * count
        translation_rows = (0, 1)

        def step(self, state: Any, velocity: Any, step_time: float) -> Any:
            return state + velocity[:3] * step_time

        def velocity_to_xy(self, state: Any, velocity: Any) -> Any:
            return velocity[:2]

        def velocity_from_xy(self, state: Any, velocity_xy: Any) -> Any:
            return np.vstack([velocity_xy[:2], np.zeros((count - 2, 1))])


def ways(make: Make, count: int, hook: str, mode: str, behavior: str) -> np.ndarray:
    """(steps, robots, numbers) state and velocity of both robots, of which the first has an overridden method."""
    register(count)
    text = SCENE.replace("MODE", mode).replace("COUNT", str(count))
    env = make(text.replace("BEHAVIOR", f", behavior: {{name: {behavior}}}" if behavior else ""))
    if hook != "none":
        usual = getattr(env.robot, hook)
        setattr(env.robot, hook, lambda *args, **kwargs: usual(*args, **kwargs))
    rows = []
    for number, action in enumerate(ACTIONS):
        both = (action, ACTIONS[(number + 3) % len(ACTIONS)])
        env.step([None if one is None else [*one, *[0.0] * (count - 3)] for one in both])
        rows.append([np.concatenate([v.state[:, 0], v.velocity[:3, 0], v.velocity_xy[:, 0]]) for v in env.robot_list])
    return np.array(rows)


@pytest.mark.parametrize("behavior", ["", "dash"])
@pytest.mark.parametrize("mode", ["stop", "contact"])
@pytest.mark.parametrize("hook", HOOKS)
def test_commands_hold_for_one_step_and_limits_start_from_the_last_control(
    make: Make, hook: str, mode: str, behavior: str
) -> None:
    three, four = (ways(make, count, hook, mode, behavior) for count in (3, 4))
    np.testing.assert_allclose(four, three, rtol=0, atol=1e-12)
    if not behavior:
        assert not four[1, 0, 3:].any(), "without a command it stands"


@pytest.mark.parametrize("count", [3, 4])
def test_what_is_stopped_has_no_control(make: Make, count: int) -> None:
    register(count)
    text = SCENE.replace("MODE", "stop").replace("COUNT", str(count)).replace("BEHAVIOR", "")
    env = make(text + "obstacle: [{shape: {name: circle, radius: 0.3}, state: [5.8, 5]}]")
    usual = env.robot.step
    env.robot.step = lambda *args, **kwargs: usual(*args, **kwargs)
    for _ in range(6):
        env.step([[2.0, 0.0, 0.0, 1.0][:count], None])
    assert env.robot.stop_flag
    assert not env.robot.velocity.any()
