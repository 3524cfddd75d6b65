"""Bumpers, cliff sensors, depth cameras and radio ranges in programs."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

SCENE = """
world: {width: 12, height: 12, zones: [{name: stairs, rectangle: [4, 4, 5, 8]}]}
robot:
  kinematics: {name: diff}
  shape: {name: circle, radius: 0.2}
  state: [2, 6, 0]
  goal: [11, 6]
  vel_max: [0.5, 1]
  behavior: {name: dash}
  sensors:
    - {name: bumper}
    - {name: cliff, points: [[0.2, 0], [-0.2, 0]], zones: [stairs]}
    - {name: depth_scan, device: d435, number: 31}
    - {name: uwb, anchors: [[0, 6], [12, 6]], nlos_bias: 0.3}
obstacle: {shape: {name: rectangle, length: 1, width: 4}, state: [8, 6, 0]}
"""


def test_sensors_read_by_name_on_the_way_to_a_wall(make: Callable[..., Any]) -> None:
    env = make(SCENE)
    robot = env.robot_list[0]
    bumper, cliff, depth, uwb = robot.sensors
    env.step()
    assert bumper.read() == {"pressed_0": 0.0, "pressed_1": 0.0}
    assert cliff.read() == {"drop_0": 0.0, "drop_1": 0.0}
    x = float(robot.state[0, 0])
    assert uwb.read() == pytest.approx({"range_0": x, "range_1": 12 - x + 0.3})
    assert depth is robot.lidar
    assert depth.range_data.shape == (31,)
    assert depth.range_data[15] == pytest.approx(7.5 - x, abs=5 * 0.0025 * (7.5 - x) ** 2)
    drops = []
    for _ in range(110):
        env.step()
        drops.append(list(cliff.read().values()))
    assert [1.0, 0.0] in drops
    assert [0.0, 1.0] in drops
    assert bumper.read() == {"pressed_0": 1.0, "pressed_1": 1.0}
    assert robot.collision
    nearest = 7.5 - float(robot.state[0, 0])
    assert nearest < 0.28
    assert not depth.valid[15]
    assert uwb.units == ("m", "m")


def test_a_device_gives_way_to_keys_beside_it(make: Callable[..., Any]) -> None:
    depth = make(SCENE).robot_list[0].lidar
    assert depth.angle_range == pytest.approx(math.radians(87), abs=1e-4)
    assert (depth.number, depth.options.depth_growth) == (31, 0.0025)


def test_sensors_go_on_when_an_object_is_added(make: Callable[..., Any]) -> None:
    env = make(SCENE)
    for _ in range(5):
        env.step()
    before = [sensor.data for sensor in env.robot_list[0].sensors if hasattr(sensor, "data")]
    env.add_object(env.create_obstacle(shape={"name": "circle", "radius": 0.2}, state=[10, 2]))
    after = [sensor.data for sensor in env.robot_list[0].sensors if hasattr(sensor, "data")]
    assert len(before) == 3
    for one, other in zip(before, after, strict=True):
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize(
    ("written", "message"),
    [
        ("{name: cliff, zones: [stars]}", "no zone is called 'stars'"),
        ("{name: gnss, blocked: [tunnel]}", "no zone is called 'tunnel'"),
        ("{name: bumper, sectors: [[1, -1]]}", "a sector goes from a bearing to a greater one"),
        ("{name: bumper, sectors: [[0, 7]]}", "a sector goes from a bearing to a greater one"),
        ("{name: uwb}", "'anchors' is missing"),
        ("{name: depth_scan, angle_range: 3.1}", "angle_range"),
    ],
)
def test_wrong_options_are_named(make: Callable[..., Any], written: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        make(SCENE.replace("{name: bumper}", written))
