"""Sensors without beams in scenes and bridges: mounts, topics, states as JSON, and places on the earth."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

import irsim
from irsim.bridges.json_lines.bridge import scene_as_json, state_as_json
from irsim.bridges.ros.geodesy import geodetic
from irsim.bridges.ros.topics import scene_topics
from irsim.bridges.state import world_state
from irsim.objects.describe import agent_rows, describe_scene
from tests.bridges.scenes import environment
from tests.bridges.sensing import SCENE

WGS84 = 6_378_137.0, 6_356_752.314245
"""Half axes of the ellipsoid [m]."""


def test_a_scene_has_the_sensors_and_each_its_topic() -> None:
    env = environment(SCENE)
    scene = describe_scene(env.simulation)
    env.end(0)
    rover = scene.robots[0]
    assert [(one.key, one.number) for one in rover.gauges if one.name == "sonar"] == [
        ("rover/sonar", 0), ("rover/sonar_2", 1)]  # fmt: skip
    imu = next(one for one in rover.gauges if one.name == "imu")
    assert (imu.mount, imu.units["yaw_rate"], imu.settings["gyro_noise"]) == ((0.1, 0.0, 0.5), "rad/s", 0.01)
    topics = scene_topics(scene, scene.robots, "sim", names={"imu": "/imu/data{n}"}, qos={})
    kinds = {topic.name: topic.kind.rpartition("/")[2] for topic in topics if topic.gauge}
    assert kinds == {
        "/imu/data": "Imu", "/imu/data_1": "Imu", "/rover/wheel_odom": "Odometry", "/rover/gnss": "NavSatFix",
        "/rover/sonar": "Range", "/rover/sonar_1": "Range", "/rover/ir_range": "Range",
        "/rover/localization": "PoseWithCovarianceStamped",
    }  # fmt: skip
    assert not [topic for topic in scene_topics(scene, scene.robots, "real", names={}, qos={}) if topic.gauge]


def test_a_detector_in_front_of_a_lidar_is_no_lidar() -> None:
    env = environment(SCENE)
    [lidar] = describe_scene(env.simulation).robots[0].lidars
    env.end(0)
    assert (lidar.beams, lidar.range_max, lidar.mount) == (5, 3, (0.2, 0, 0))
    assert lidar.beam_time == pytest.approx(0.2 * (2 / 4) / (2 * math.pi))
    assert lidar.lag == pytest.approx(4 * lidar.beam_time)


def test_states_for_other_programs_have_the_numbers_by_name() -> None:
    env = environment(SCENE, seed=2)
    scene, rows = describe_scene(env.simulation), agent_rows(env.simulation)
    for _ in range(5):
        env.step()
    told = json.loads(json.dumps(state_as_json(world_state(env.simulation, rows)), allow_nan=False))
    sensors = {sensor.sensor_type: sensor for sensor in env.robot_list[0].sensors[:5]}
    assert told["readings"]["rover/imu"] == sensors["imu"].read()
    assert told["readings"]["rover/detector"] == sensors["detector"].read()["tracks"]
    assert len(told["readings"]["rover/detector"]) == 1
    assert told["stamps"] == {"rover/imu_2": 0}
    env.end(0)
    [rover] = [agent for agent in scene_as_json(scene)["agents"] if agent["name"] == "rover"]
    assert next(one for one in rover["gauges"] if one["name"] == "gnss")["units"]["quality"] == "1"


def test_a_state_says_when_each_sensor_has_measured() -> None:
    env = environment(SCENE)
    rows, robot = agent_rows(env.simulation), env.robot_list[0]
    slow = [sensor for sensor in robot.sensors if sensor.sensor_type == "imu"][1]
    seen = set()
    for _ in range(12):
        env.step()
        state = world_state(env.simulation, rows)
        assert state.stamps["rover/0"] == state.stamps["rover/imu"] == pytest.approx(state.time)
        told = state.stamps["rover/imu_2"]
        assert told == pytest.approx(slow.stamp, nan_ok=True)
        seen.add(None if math.isnan(told) else round(told, 6))
    env.end(0)
    assert seen == {None, 0, 0.3, 0.5, 0.8}


def cartesian(latitude: float, longitude: float, height: float) -> np.ndarray:
    """A place in the frame of the earth [m]."""
    lat, lon = math.radians(latitude), math.radians(longitude)
    squared = 1 - (WGS84[1] / WGS84[0]) ** 2
    curvature = WGS84[0] / math.sqrt(1 - squared * math.sin(lat) ** 2)
    out = (curvature + height) * math.cos(lat)
    return np.array([out * math.cos(lon), out * math.sin(lon), (curvature * (1 - squared) + height) * math.sin(lat)])


@pytest.mark.parametrize(
    "origin", [(48.1, 11.6, 520.0), (-33.9, 151.2, 0.0), (0.0, 179.999, 10.0), (89.0, -120.0, 5.0)]
)
def test_places_on_the_tangent_plane_are_where_they_are_on_the_earth(origin: tuple[float, float, float]) -> None:
    lat, lon = math.radians(origin[0]), math.radians(origin[1])
    east = np.array([-math.sin(lon), math.cos(lon), 0])
    north = np.array([-math.sin(lat) * math.cos(lon), -math.sin(lat) * math.sin(lon), math.cos(lat)])
    for x, y in ((0.0, 0.0), (5.0, -3.0), (800.0, 1200.0)):
        latitude, longitude, height = geodetic(x, y, origin)
        assert -180 <= longitude < 180
        place = cartesian(latitude, longitude, height)
        np.testing.assert_allclose(place, cartesian(*origin) + x * east + y * north, atol=1e-6)


def test_an_origin_beyond_the_poles_is_refused() -> None:
    report = irsim.validate(text=SCENE.replace("origin: [48.1,", "origin: [91,"))
    assert [problem.code for problem in report.findings] == ["out-of-range"]
    assert "no place on the earth" in report.findings[0].message
