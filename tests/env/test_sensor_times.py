"""Rates and latencies of sensors in programs: what they read, run-time changes, objects that come and go, fog."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.diagnostics.errors import ScenarioError

SCENE = """
world: {width: 20, height: 10, step_time: 0.02, collision_mode: unobstructed}
robot:
  - kinematics: {name: omni}
    shape: {name: circle, radius: 0.2}
    state: [2, 5, 0]
    vel_max: [1, 1]
    sensors:
      - {name: lidar2d, number: 3, angle_range: 0.2, range_max: 18, rate: 10}
      - {name: fmcw_lidar2d, number: 3, angle_range: 0.2, range_max: 18, latency: 0.12}
      - {name: odometry, rate: 10, latency: 0.1}
      - {name: imu}
obstacle:
  - {shape: {name: rectangle, length: 1, width: 10}, state: [15.5, 5, 0], static: true}
"""
AHEAD = np.array([[1.0], [0.0]])


@pytest.fixture
def env(make: Callable[..., Any]) -> Any:
    return make(SCENE)


def drive(env: Any, steps: int) -> None:
    for _ in range(steps):
        env.step(AHEAD)


def middle(lidar: Any) -> float:
    return float(lidar.range_data[1])


def test_programs_read_the_last_data_and_their_time(env: Any) -> None:
    fast, late, odometry, imu = env.robot.sensors
    assert not late.get_scan()["valid"].any()
    assert math.isnan(late.stamp)
    assert late.get_points() is None
    assert math.isnan(odometry.read()["x"])
    drive(env, 13)
    assert (fast.stamp, late.stamp) == pytest.approx((0.2, 0.14))
    assert (odometry.read()["stamp"], imu.stamp) == pytest.approx((0.1, 0.26))
    assert middle(fast) == pytest.approx(15 - 2.2)
    assert middle(late) == pytest.approx(15 - 2.14)
    assert odometry.read()["x"] == pytest.approx(2.1)
    assert fast.get_scan()["stamp"] == fast.stamp
    assert late.get_scan()["stamp"] == late.stamp
    assert late.radial_velocity[1] == pytest.approx(-1.0)


def test_objects_that_come_and_go_leave_sensors_alone(env: Any) -> None:
    drive(env, 12)
    fast, late, odometry, _ = env.robot.sensors
    before = [middle(fast), middle(late), *odometry.data, fast.stamp, late.stamp, odometry.stamp]
    env.add_object(env.create_obstacle(shape={"name": "circle", "radius": 0.2}, state=[10, 9]))
    assert [middle(fast), middle(late), *odometry.data, fast.stamp, late.stamp, odometry.stamp] == before
    drive(env, 2)
    env.delete_object(env.obstacle_list[-1].id)
    drive(env, 3)
    assert (fast.stamp, late.stamp, odometry.stamp) == pytest.approx((0.3, 0.22, 0.2))
    assert middle(fast) == pytest.approx(15 - 2.3)
    assert middle(late) == pytest.approx(15 - 2.22)
    assert odometry.read()["x"] == pytest.approx(2.2)


def test_a_robot_that_comes_later_shows_nothing_until_its_first_data(env: Any) -> None:
    drive(env, 12)
    sensors = [{"name": "lidar2d", "number": 1, "range_max": 18, "rate": 10, "latency": 0.04}]
    env.add_object(env.create_robot(kinematics={"name": "omni"}, state=[3, 2, 0], sensors=sensors))
    lidar = env.robot_list[1].lidar
    stamps = []
    for _ in range(10):
        stamps.append(lidar.stamp)
        env.step(AHEAD)
    assert np.isnan(stamps[:5]).all()
    assert stamps[5:] == pytest.approx([0.3] * 5)


def test_times_may_change_while_it_runs(env: Any) -> None:
    drive(env, 7)
    lidar = env.robot.lidar
    lidar.rate = 25.0
    assert math.isnan(lidar.stamp)
    drive(env, 2)
    assert (lidar.rate, lidar.stamp) == (25.0, pytest.approx(0.16))
    lidar.rate, lidar.latency = None, 0.02
    drive(env, 2)
    assert lidar.stamp == pytest.approx(0.2)
    with pytest.raises(ValueError, match="latency"):
        lidar.latency = -1.0


def test_a_scan_that_a_program_takes_is_there_at_once(env: Any) -> None:
    drive(env, 3)
    late = env.robot.sensors[1]
    late.step()
    assert (middle(late), late.stamp) == pytest.approx((15 - 2.06, 0.06))


def test_a_snapshot_brings_back_scans_on_their_way(env: Any) -> None:
    drive(env, 8)
    kept, seen = env.snapshot(), []
    for back in (False, True):
        if back:
            env.restore(kept)
        sensors = env.robot.sensors
        seen.append([])
        for _ in range(8):
            drive(env, 1)
            seen[-1].append([value for s in sensors[:2] for value in (middle(s), s.stamp)] + [*sensors[2].data])
    np.testing.assert_array_equal(seen[0], seen[1])


def test_a_reset_forgets_them(env: Any) -> None:
    drive(env, 14)
    env.reset()
    fast, late, odometry, _ = env.robot.sensors
    assert (middle(fast), middle(late)) == pytest.approx((13.0, 18.0))
    assert np.isnan([late.stamp, odometry.stamp, *odometry.data]).all()


FOG = """
world: {width: 20, height: 10, step_time: 0.1, collision_mode: unobstructed, fog_map: true}
robot:
  - {kinematics: {name: omni}, shape: {name: circle, radius: 0.2}, state: [2, 5, 0], vel_max: [5, 5],
     sensors: [{name: lidar2d, number: 60, angle_range: 1.5, range_max: 18, TIMES}]}
obstacle:
  - {shape: {name: rectangle, length: 1, width: 10}, state: [15.5, 5, 0], static: true}
"""


@pytest.mark.parametrize("times", ["rate: 1", "latency: 1", "rate: 2, latency: 0.5"])
def test_fog_is_cleared_where_the_robot_was_when_it_measured(make: Callable[..., Any], times: str) -> None:
    """A scan that is a second old would otherwise clear the wall, and what is behind it."""
    env = make(FOG.replace("TIMES", times))
    for _ in range(20):
        env.step(5 * AHEAD)
    cleared = np.asarray(env.simulation.state.explored[0]) > 0
    columns = np.linspace(0, 20, cleared.shape[0], endpoint=False)
    assert cleared[(columns > 5) & (columns < 14)].any()
    assert not cleared[columns > 15.3].any()


@pytest.mark.parametrize(("key", "value"), [("rate", 0), ("rate", -1), ("latency", -0.1), ("latency", 11)])
def test_times_out_of_range_are_refused(make: Callable[..., Any], key: str, value: float) -> None:
    with pytest.raises(ScenarioError, match=key):
        make(SCENE.replace("{name: imu}", f"{{name: imu, {key}: {value}}}"))


@pytest.mark.parametrize("sensor", ["imu", "lidar2d"])
@pytest.mark.parametrize(("other", "key"), [("update_rate", "rate"), ("frequency", "rate"), ("delay", "latency")])
def test_other_names_of_the_keys_are_known(sensor: str, other: str, key: str) -> None:
    result = irsim.validate(text=SCENE.replace("{name: imu}", f"{{name: {sensor}, {other}: 5}}"))
    assert [finding.fix for finding in result.findings if finding.code == "unknown-key"] == [f"rename it to '{key}'"]
