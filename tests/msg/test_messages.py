"""Messages out of an environment, and odometry into it."""

from __future__ import annotations

import json
import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from irsim import msg
from tests.env.driving import Make, take_steps

TEXT = """
world: {width: 10, height: 10, name: hall}
robot:
  - {kinematics: {name: diff}, state: [1, 1, 0.3], shape: {name: circle, radius: 0.2}, goal: [9, 9, 0],
     sensors: [{type: lidar2d, number: 5, range_min: 0.5, range_max: 3}]}
  - {kinematics: {name: acker}, state: [5, 1, 0.3, 0.1],
     shape: {name: rectangle, length: 1, width: 0.4, wheelbase: 0.6}}
  - {kinematics: {name: omni_angular}, state: [5, 5, 0.3], shape: {name: circle, radius: 0.2}}
obstacle:
  - {shape: {name: circle, radius: 0.2}, state: [8, 1, 0]}
"""


@pytest.fixture
def env(make: Make) -> Any:
    return make(TEXT)


def test_what_a_message_says(env: Any) -> None:
    env.step([[0.5, 0.2], [1, 0.2], [0.5, 0.2, 0.1]])
    message = env.get_msg()
    assert (message.header, message.name, message.status) == (msg.Header(1, 0.1, "world"), "hall", env.status)
    assert [state.name for state in message.robots] == ["robot_0", "robot_1", "robot_2"]
    assert [state.name for state in message.obstacles] == ["obstacle_3"]
    diff, car, disc = message.robots
    assert diff.odom.child_frame_id == "robot_0/base_link"
    assert diff.odom.pose.pose.orientation.to_yaw() == pytest.approx(env.robot.orientation)
    assert (diff.odom.twist.twist.linear.x, diff.odom.twist.twist.angular.z) == (0.5, 0.2)
    assert car.odom.twist.twist.angular.z == pytest.approx(math.tan(0.2) / 0.6)
    assert (disc.odom.twist.twist.linear.y, disc.odom.twist.twist.angular.z) == (0.2, 0.1)
    assert diff.scan.ranges.dtype == np.float32
    assert (diff.scan.header.frame_id, len(diff.scans), car.scan) == ("robot_0/laser", 1, None)
    assert diff.goal.shape == (3, 1)
    assert json.loads(json.dumps(message.to_dict()))["objects"][0]["goal"] == [[9], [9], [0]]


def test_infinite_ranges(env: Any) -> None:
    scan = env.get_msg(use_inf=True).objects[0].scan
    assert np.isposinf(scan.ranges).all()
    env.objects[3].set_state([1.5, 1.1, 0])
    env.refresh()
    scan = env.get_msg(use_inf=True).objects[0].scan
    assert np.isneginf(scan.ranges).any()


def test_a_message_puts_everything_back(env: Any) -> None:
    env.step([[0.5, 0.2], [1, 0.2], [0.5, 0.2, 0.1]])
    message, states = env.get_msg(), [view.state for view in env.objects]
    speeds = [view.velocity for view in env.objects]
    take_steps(env, 5, [[0.5, 0.2], [1, -0.2], [0.5, 0.2, 0.1]])
    assert env.receive_msg(message) == 4
    for view, state, speed in zip(env.objects, states, speeds, strict=True):
        np.testing.assert_allclose(view.state, state, atol=1e-12)
        np.testing.assert_allclose(view.velocity, speed, atol=1e-12)


def test_odometry_of_others(env: Any) -> None:
    native = SimpleNamespace(
        pose=SimpleNamespace(pose=msg.Pose(msg.Point(2, 3))), twist=SimpleNamespace(twist=msg.Twist())
    )
    assert env.receive_msg(native) == 1
    assert env.robot.state[:, 0].tolist() == [2, 3, 0]
    native.pose.pose.position.x = 7
    env.receive_msg(native, object_name="obstacle_3")
    assert env.objects[3].state[:2, 0].tolist() == [7, 3]
    car = env.objects[1]
    native.twist.twist.linear.x, native.twist.twist.angular.z = 0.0, 1.0
    env.receive_msg(native, object_id=1)  # a standing car tells no steering
    assert car.state[3, 0] == 0.1
    native.twist.twist.linear.x = 1.0
    env.receive_msg(native, object_id=1)
    assert car.state[3, 0] == pytest.approx(math.atan(0.6))


def test_nothing_changes_when_a_message_is_wrong(env: Any) -> None:
    message = env.get_msg()
    message.objects[0].odom.pose.pose.position.x = 5.0
    message.objects[1].odom.pose.pose.position.x = math.nan
    with pytest.raises(ValueError, match="must have finite numbers"):
        env.receive_msg(message)
    assert env.robot.state[0, 0] == 1
    with pytest.raises(ValueError, match="'missing'"):
        env.receive_msg(message.objects[0], object_name="missing")
    with pytest.raises(TypeError, match="int"):
        env.receive_msg(3)
    with pytest.raises(TypeError):
        env.receive_msg(SimpleNamespace(pose=1, twist=2))
