"""Sensors that are not good enough: odometry that is lost before the goal, lidars that see less far than they must."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from irsim.components.sensors._realism import LidarRealism
from irsim.components.sensors.odometry import Odometry
from irsim.diagnostics.diagnostic import Diagnostic
from irsim.scenario.model.zones import Zone
from irsim.scenario.read import read
from irsim.scenario.resolve.odometry_drift import Slippage, drift_of

WAYPOINTS = [[11.0, 5.0], [11.0, 9.0], [5.0, 9.0]]
LEGS = list(zip([(5.0, 5.0), *map(tuple, WAYPOINTS)], map(tuple, WAYPOINTS), strict=False))


def findings(code: str, **keys: Any) -> list[Diagnostic]:
    entry = {
        "kinematics": {"name": "diff"},
        "shape": {"name": "circle", "radius": 0.25},
        "behavior": {"name": "dash"},
        "state": [1, 5, 0],
        "goal": [9, 5],
        **keys,
    }
    wall = {"shape": {"name": "circle", "radius": 0.5}, "state": [5, 8], "reflectivity": 0.02}
    data = {"robot": [entry], "obstacle": [wall]}
    return [finding for finding in read(data).diagnostics if finding.code == code]


@pytest.mark.parametrize(
    "keys",
    [
        {"heading_noise": 0.05},
        {"turning_noise": 0.1},
        {"distance_noise": 0.2},
        {"diameter_error": 0.01},
        {"track_error": 0.05},
        {"scale_error": 0.05},
        {"diameter_std": 0.01},
        {"track_std": 0.05},
        {"scale_std": 0.05},
        {"heading_noise": 0.03, "diameter_error": 0.01, "track_error": -0.03, "scale_error": 0.02, "scale_std": 0.03},
    ],
    ids=lambda keys: "-".join(keys),
)
def test_the_expected_drift_is_that_of_many_robots(make: Callable[..., Any], keys: dict[str, float]) -> None:
    sensor = {"name": "odometry", "track": 0.3, **keys}
    scene = {
        "world": {"width": 16, "height": 14, "step_time": 0.1, "time_limit": 60},
        "robot": {
            "number": 400,
            "kinematics": {"name": "diff"},
            "shape": {"name": "circle", "radius": 0.2},
            "state": [5, 5, 0],
            "waypoints": WAYPOINTS,
            "goal_threshold": 0.1,
            "vel_max": [1, 1],
            "vel_min": [0, -1],
            "unobstructed": True,
            "behavior": {"name": "dash", "angle_tolerance": 0.06},
            "sensors": [sensor],
        },
    }
    env = make(json.dumps(scene), seed=1)
    while not env.done():
        env.step()
    errors = [math.dist(robot.sensors[0].data[:2], robot.state[:2, 0]) for robot in env.robot_list]
    env.end(ending_time=0)
    expected = drift_of(Odometry(**{key: value for key, value in sensor.items() if key != "name"}), LEGS, 0.0).error
    assert math.sqrt(np.mean(np.square(errors))) == pytest.approx(expected, rel=0.12)


@pytest.mark.parametrize(
    ("ground", "track"),
    [
        ({"slip": 0.2}, 0.3),
        ({"slip": 0.3, "slip_std": 0.1, "slip_time": 0.5}, 0.6),
        ({"slip": 0.3, "slip_std": 0.08, "slip_time": 0}, 0.6),
    ],
)
def test_the_expected_drift_counts_the_slip_of_zones(
    make: Callable[..., Any], ground: dict[str, float], track: float
) -> None:
    zone = {"name": "wet", "rectangle": [6, 3, 8, 7], **ground}
    scene = {
        "world": {"width": 16, "height": 14, "step_time": 0.1, "time_limit": 60, "zones": [zone]},
        "robot": {
            "number": 300,
            "kinematics": {"name": "diff", "track": track},
            "shape": {"name": "circle", "radius": 0.2},
            "state": [5, 5, 0],
            "waypoints": WAYPOINTS,
            "goal_threshold": 0.1,
            "vel_max": [1, 1],
            "vel_min": [0, -1],
            "unobstructed": True,
            "behavior": {"name": "dash", "angle_tolerance": 0.06},
            "sensors": [{"name": "odometry", "track": track}],
        },
    }
    env = make(json.dumps(scene), seed=1)
    while not env.done():
        env.step()
    errors = [math.dist(robot.sensors[0].data[:2], robot.state[:2, 0]) for robot in env.robot_list]
    env.end(ending_time=0)
    slippage = Slippage([Zone(**zone)], 1.0, track, 0.1)
    expected = drift_of(Odometry(track=track), LEGS, 0.0, slippage).error
    assert math.sqrt(np.mean(np.square(errors))) == pytest.approx(expected, rel=0.25)


def test_slip_on_the_way_is_told(tmp_path: Any) -> None:
    def messages(zone: dict[str, Any]) -> list[str]:
        world = {"width": 10, "height": 10, "zones": [{"name": "wet", **zone}]}
        robot = {"kinematics": {"name": "diff"}, "state": [1, 5, 0], "goal": [9, 5], "perceives": "estimate",
                 "behavior": {"name": "dash"}, "goal_threshold": 0.3, "sensors": [{"name": "odometry"}]}  # fmt: skip
        diagnostics = read({"world": world, "robot": robot}).diagnostics
        return [finding.message for finding in diagnostics if finding.code == "odometry-drifts"]

    [message] = messages({"rectangle": [3, 4, 7, 6], "slip": 0.2})
    assert "off by 1 m (root mean square) after 8 m of way, mostly by the slip of zone 'wet'" in message
    assert messages({"rectangle": [3, 4, 7, 6], "slip": 0.05}) == []
    assert messages({"rectangle": [3, 6, 7, 8], "slip": 0.5}) == [], "it is beside the way"
    assert messages({"circle": {"center": [5, 5], "radius": 2}, "slip": 1.0})


def test_odometry_that_is_lost_before_the_goal_is_told_with_a_value_that_suffices() -> None:
    noisy = {"name": "odometry", "heading_noise": 0.05, "distance_noise": 0.01}
    [finding] = findings("odometry-drifts", perceives="estimate", sensors=[noisy])
    expected = math.sqrt(0.05**2 * 8**3 / 3 + 0.01**2 * 8)
    assert f"off by {expected:.2f} m (root mean square) after 8 m of way, mostly by heading_noise" in finding.message
    assert finding.fix == "add {name: localization} to its sensors, or write heading_noise: 0.0073"
    assert not findings("odometry-drifts", perceives="estimate", sensors=[{**noisy, "heading_noise": 0.0073}])
    assert findings("odometry-drifts", perceives="estimate", sensors=[{**noisy, "heading_noise": 0.0078}])


@pytest.mark.parametrize(
    "keys",
    [
        {"perceives": "truth"},
        {"perceives": "estimate", "sensors": [{"name": "odometry"}]},
        {"perceives": "estimate", "goal_threshold": 1},
        {"perceives": "estimate", "behavior": {"name": "dash", "wander": True}},
        {"perceives": "estimate", "sensors": [{"name": "odometry", "scale_std": 0.1}, {"name": "localization"}]},
    ],
    ids=["truth", "exact", "wide-goal", "wander", "localization"],
)
def test_odometry_that_suffices_or_is_not_used_is_not_told(keys: dict[str, Any]) -> None:
    assert not findings("odometry-drifts", **{"sensors": [{"name": "odometry", "heading_noise": 0.03}], **keys})


def test_noise_beside_an_error_that_is_too_large_has_no_value_that_suffices() -> None:
    sensor = {"name": "odometry", "diameter_error": 0.02, "scale_error": 0.1}
    [finding] = findings("odometry-drifts", perceives="estimate", sensors=[sensor])
    assert finding.fix == "add {name: localization} to its sensors"


@pytest.mark.parametrize("keys", [{"kinematics": None, "behavior": None}, {"static": True, "behavior": None}])
def test_perceiving_without_deciding_is_unused(keys: dict[str, Any]) -> None:
    [finding] = findings("perceives-unused", perceives="both", **keys)
    assert (finding.severity, finding.fix) == ("warning", "remove 'perceives'")
    assert not findings("perceives-without-sensor", perceives="both", **keys)
    assert not findings("perceives-unused", perceives="both", behavior=None)


def short(sensor: dict[str, Any], **keys: Any) -> list[Diagnostic]:
    return findings("lidar-too-short", vel_max=[2, 1], sensors=[{"name": "lidar2d", **sensor}], **keys)


def test_a_lidar_must_see_as_far_as_the_robot_drives_until_it_stands() -> None:
    step, edge = 2 * 0.1, 0.25
    braking = 2**2 / (2 * 1)
    assert not short({"range_max": step + edge + 0.01})
    assert short({"range_max": step + edge - 0.01})
    [finding] = short({"range_max": 2.4}, acce=[1, 2])
    assert f"may need {step + edge + braking:.2f} m to stop from 2 m/s" in finding.message
    assert finding.fix is not None
    assert finding.fix.startswith("range_max: 2.5 or more")
    assert not short({"range_max": 2.46}, acce=[1, 2])


@pytest.mark.parametrize(
    ("sensor", "keys", "time"),
    [
        ({"latency": 0.3}, {}, 0.3),
        ({"rate": 2}, {}, 0.5),
        ({}, {"actuation": {"command_period": 0.2, "delay": 0.3, "lag": [0.1, 0.4]}}, 0.9),
    ],
    ids=["latency", "rate", "actuation"],
)
def test_time_passes_until_a_robot_brakes(sensor: dict[str, Any], keys: dict[str, Any], time: float) -> None:
    needed = 2 * (0.1 + time) + 0.25
    assert short({"range_max": needed - 0.01, **sensor}, **keys)
    assert not short({"range_max": needed + 0.01, **sensor}, **keys)


def test_a_dark_surface_is_seen_from_nearer() -> None:
    [finding] = short({"range_max": 30, "realism": {"range_dark": 4}}, acce=[1, 2])
    assert finding.message.endswith("the lidar sees 'obstacle_1' (reflectivity 0.02) from 0.91 m")
    assert not short({"range_max": 30, "realism": {"range_dark": 15}}, acce=[1, 2])
    assert not short({"range_max": 30, "realism": {"dropout": 0.1}}, acce=[1, 2])


@pytest.mark.parametrize(("reflectivity", "seen"), [(0.1, 4.0), (0.9, 16.0), (0.3, 8.0), (1.0, 16.0), (0.0, 0.0)])
def test_the_range_of_a_surface_is_a_power_of_its_reflectivity(reflectivity: float, seen: float) -> None:
    assert LidarRealism(range_dark=4).range_of(reflectivity, 16) == pytest.approx(seen)
