"""Odometry, IMU, satellite navigation and localization in programs."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

SCENE = """
world: {width: 12, height: 12, integration: exact, zones: [{name: tunnel, rectangle: [5, 0, 7, 12]}]}
robot:
  - kinematics: {name: diff}
    shape: {name: circle, radius: 0.2}
    state: [2, 6, 0]
    goal: [11, 6]
    behavior: {name: dash}
    sensors:
      - {name: lidar2d, number: 9}
      - {name: odometry, heading_noise: 0.02}
      - {name: imu, device: vn100}
      - {name: gnss, std: 0.1, drift_std: 0.2, blocked: [tunnel]}
      - {name: localization}
  - {kinematics: {name: omni}, shape: {name: circle, radius: 0.2}, state: [2, 9, 0], goal: [11, 9],
     behavior: {name: dash}, sensors: [{name: localization, position_std: 0.0, heading_std: 0.0}]}
"""


@pytest.fixture
def env(make: Callable[..., Any]) -> Any:
    return make(SCENE)


def test_sensors_read_by_name(env: Any) -> None:
    for _ in range(20):
        env.step()
    lidar, odometry, imu, gnss, place = env.robot_list[0].sensors
    assert lidar is env.robot_list[0].lidar
    read = odometry.read()
    assert list(read) == ["x", "y", "theta", "vx", "vy", "yaw_rate", "left", "right"]
    assert odometry.stamp == pytest.approx(2.0)
    assert read["x"] == pytest.approx(4.0, abs=0.05)
    assert read["vx"] == pytest.approx(1.0)
    assert read["left"] == pytest.approx(2.0 / (2 * math.pi * 0.05), rel=0.02)
    assert abs(imu.read()["ay"]) < 0.05
    assert gnss.read()["quality"] == 1
    assert place.read()["x"] == pytest.approx(4.0, abs=0.3)
    assert odometry.data.shape == (len(odometry.names),) == (len(odometry.units),)
    assert env.robot_list[1].sensors[0].read() == pytest.approx(
        {"x": 4.0, "y": 9.0, "theta": 0.0, "corrected": 0}, abs=1
    )


def test_a_tunnel_blocks_satellites(env: Any) -> None:
    for _ in range(40):
        env.step()
    read = env.robot_list[0].sensors[3].read()
    assert (math.isnan(read["x"]), read["quality"]) == (True, 0)


def test_readings_go_on_when_an_object_is_added(env: Any) -> None:
    for _ in range(10):
        env.step()
    before = env.robot_list[0].sensors[1].data
    env.add_object(env.create_obstacle(shape={"name": "circle", "radius": 0.2}, state=[10, 2]))
    np.testing.assert_array_equal(env.robot_list[0].sensors[1].data, before)
    env.step()
    assert env.robot_list[0].sensors[1].read()["x"] == pytest.approx(before[0] + 0.1, abs=0.02)


def test_a_snapshot_holds_what_sensors_remember(env: Any) -> None:
    for _ in range(10):
        env.step()
    kept = env.snapshot()
    ahead = []
    for _ in range(5):
        env.step()
        ahead.append(env.robot_list[0].sensors[1].data)
    env.restore(kept)
    for expected in ahead:
        env.step()
        np.testing.assert_array_equal(env.robot_list[0].sensors[1].data, expected)


def test_the_same_seed_measures_the_same(make: Callable[..., Any]) -> None:
    runs = []
    for seed in (3, 3, 4):
        env = make(SCENE, seed=seed)
        for _ in range(15):
            env.step()
        runs.append(np.concatenate([sensor.data for sensor in env.robot_list[0].sensors[1:]]))
    np.testing.assert_array_equal(runs[0], runs[1])
    assert not np.array_equal(runs[0], runs[2])


def test_it_is_said_what_a_sensor_reports(env: Any) -> None:
    assert repr(env.robot_list[0].sensors[1]).startswith("<sensor 'odometry' of 'robot_0': x 2")
