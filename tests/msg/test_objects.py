"""Messages of single objects and sensors, and odometry from and into the classes of other middleware."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from irsim.msg import LaserScan, ObjectState, Odometry, WorldState
from tests.bridges.scenes import environment
from tests.bridges.sensing import SCENE
from tests.env.driving import Make

YAML = """
world: {width: 10, height: 8}
robot:
  - kinematics: {name: acker}
    shape: {name: rectangle, length: 1, width: 0.5, wheelbase: 0.6}
    state: [3, 4, 0.5, 0.2]
    goal: [9, 7, 0]
    sensors: [{name: lidar2d, number: 5}]
    behavior: {name: dash}
obstacle:
  - {shape: {name: circle, radius: 0.3}, state: [6, 6, 0]}
"""


@pytest.fixture
def env(make: Make) -> Any:
    return make(YAML)


def test_messages_of_objects_are_those_of_the_environment(env: Any) -> None:
    env.step()
    message = env.get_msg()
    state = ObjectState.from_object(env.robot, stamp=0.1, seq=1)
    assert state == message.robots[0]
    assert WorldState.from_env(env) == message
    assert Odometry.from_object(env.robot, stamp=0.1, seq=1) == message.robots[0].odom
    scan = LaserScan.from_sensor(env.robot.lidar)
    assert (scan.header.frame_id, state.scan.header.frame_id) == ("lidar2d", "robot_0/laser")
    np.testing.assert_array_equal(scan.ranges, state.scan.ranges)
    assert state.sensors == state.scans
    assert (Odometry.ros_type, LaserScan.ros_type) == ("nav_msgs/Odometry", "sensor_msgs/LaserScan")
    assert "ros_type" not in scan.to_dict()


def test_odometry_says_state_and_control(env: Any) -> None:
    env.step()
    odometry = Odometry.from_object(env.robot)
    state, velocity = odometry.to_state_velocity(env.robot)
    np.testing.assert_allclose(state, env.robot.state, atol=1e-12)
    assert velocity[0, 0] == pytest.approx(env.robot.velocity[0, 0])
    assert np.tan(velocity[1, 0]) == pytest.approx(np.tan(env.robot.state[3, 0]))
    assert odometry != Odometry.from_object(env.obstacle_list[0])


def test_native_odometry_is_copied() -> None:
    at = SimpleNamespace(x=1, y=2, z=0)
    pose = SimpleNamespace(position=at, orientation=SimpleNamespace(x=0, y=0, z=math.sin(0.25), w=math.cos(0.25)))
    twist = SimpleNamespace(linear=SimpleNamespace(x=1, y=0, z=0), angular=SimpleNamespace(x=0, y=0, z=0.5))
    stamp = SimpleNamespace(sec=2, nanosec=500_000_000)
    native = SimpleNamespace(
        header=SimpleNamespace(stamp=stamp, frame_id="odom"),
        child_frame_id="base",
        pose=SimpleNamespace(pose=pose),
        twist=SimpleNamespace(twist=twist),
    )
    copied = Odometry.from_msg(native)
    assert (copied.header.stamp, copied.header.frame_id, copied.child_frame_id) == (2.5, "odom", "base")
    assert (copied.pose.pose.orientation.to_yaw(), copied.twist.twist.angular.z) == (pytest.approx(0.5), 0.5)
    assert Odometry.from_msg(copied) == copied
    with pytest.raises(TypeError, match="pose"):
        Odometry.from_msg(3)


def test_a_scan_that_takes_time_has_the_time_of_its_first_beam() -> None:
    env = environment(SCENE)
    for _ in range(3):
        env.step()
    scan = env.get_msg().robots[0].scan
    assert scan.time_increment == pytest.approx(0.2 * (2 / 4) / (2 * math.pi))
    assert scan.header.stamp == pytest.approx(0.3 - 4 * scan.time_increment)
    assert env.get_msg().robots[0].header.stamp == pytest.approx(0.3)
    env.reset()
    assert env.get_msg().robots[0].scan.header.stamp == 0
    env.end(0)
