"""Sensors in scripts: several on an object, from user code, fields of view, fog."""

from __future__ import annotations

import math
from typing import Any, Literal

import numpy as np
import pytest

import irsim
from irsim.components.options import SensorOptions
from irsim.objects.sensors.lidar import FMCWLidar2D, Lidar2D
from irsim.objects.views import views
from irsim.options.registry import SENSORS
from irsim.options.units import Meters
from irsim.simulation.fog import FogMap
from irsim.world.sensors import SensorFactory
from tests.env.driving import Make, take_steps

SEVERAL = """
robot:
  kinematics: {name: diff}
  shape: {name: circle, radius: 0.2}
  state: [2, 5, 0]
  goal: [9, 5]
  behavior: {name: dash}
  sensors:
    - {type: lidar2d, number: 1, angle_range: 0}
    - {name: fmcw_lidar2d, number: 3, angle_range: 0.2, offset: [0.1, 0, 0]}
    - {number: 5, has_velocity: true}
obstacle:
  - {kinematics: {name: diff}, shape: {name: rectangle, length: 1, width: 2}, state: [6, 5, 0], velocity: [0.4, 0]}
"""


def test_several_sensors_of_any_mix(make: Make) -> None:
    robot = make(SEVERAL).robot
    assert [type(s) for s in robot.sensors] == [Lidar2D, FMCWLidar2D, Lidar2D]
    assert [s.sensor_type for s in robot.sensors] == ["lidar2d", "fmcw_lidar2d", "lidar2d"]
    assert robot.lidar is robot.sensors[0]
    one, two, three = (s.get_scan() for s in robot.sensors)
    assert one["ranges"] == pytest.approx([3.5])
    assert (one["angle_min"], one["angle_max"], one["angle_increment"]) == (0, 0, 0)
    assert (two["ranges"][1], two["radial_velocity"][1]) == (pytest.approx(3.4), pytest.approx(0.4))
    assert "velocity" not in two
    assert three["velocity"][:, 2] == pytest.approx([0.4, 0.0])
    assert three["velocity"][:, 0] == pytest.approx([0.0, 0.0])
    assert (robot.sensors[1].offset.shape, robot.sensors[1].get_offset()) == ((3, 1), [0.1, 0, 0])


def test_recorded_velocities_are_those_of_the_scan(make: Make) -> None:
    env = make(SEVERAL)
    lidar, other = env.robot.sensors[2], env.objects[1]
    other.set_velocity([-0.9, 0])
    assert lidar.velocity[0, 2] == pytest.approx(0.4)
    lidar.step()
    assert lidar.velocity[0, 2] == pytest.approx(-0.9)
    lidar.step(np.array([[3.0], [5.0], [0.0]]))
    kept = lidar.get_scan()["ranges"]
    env.step()
    assert kept[2] == pytest.approx(2.5)


class Odometer(SensorOptions):
    """Distance gone since the start of the episode."""

    name: Literal["odometer"] = "odometer"
    error: Meters = 0.0
    """Standard deviation of the error."""


ODOMETER = """
robot:
  - number: 2
    kinematics: {name: diff}
    shape: {name: circle, radius: 0.2}
    state: [[2, 5, 0], [2, 8, 0]]
    goal: [[9, 5], [9, 8]]
    behavior: {name: dash}
    sensors: [{name: lidar2d, number: 3}, {name: odometer, error: 0.1}]
"""


def odometer(parent: Any, options: Odometer, rng: np.random.Generator) -> float:
    x0, y0 = parent.init_state[:2, 0]
    return math.dist((x0, y0), parent.position[:, 0]) + options.error * float(rng.standard_normal())


def test_a_sensor_of_user_code(make: Make) -> None:
    SENSORS.register(Odometer)(odometer)
    env = make(ODOMETER)
    sensor = env.robot.sensors[1]
    assert (sensor.sensor_type, sensor.parent, sensor.obj_id) == ("odometer", env.robot, 0)
    assert env.robot.lidar is env.robot.sensors[0]
    assert abs(sensor.data) < 0.5  # measured at once
    first = sensor.data
    take_steps(env, 10)
    assert sensor.data == pytest.approx(1.0, abs=0.5)
    assert sensor.data != 1.0
    env.reset()
    assert abs(sensor.data) < 0.5
    assert sensor.data != first  # another noise episode
    again = make(ODOMETER).robot.sensors[1]
    assert again.data == first
    again.step()
    assert again.data == first  # the draws belong to the moment


def test_the_lidar_is_found_behind_other_sensors(make: Make) -> None:
    SENSORS.register(Odometer)(odometer)
    lidar, other = "{name: lidar2d, number: 3}", "{name: odometer, error: 0.1}"
    robot = make(ODOMETER.replace(f"[{lidar}, {other}]", f"[{other}, {lidar}]")).robot
    assert robot.lidar is robot.sensors[1]
    assert len(robot.get_lidar_scan()["ranges"]) == 3


def test_rollouts_and_batches_measure_alike(make: Make) -> None:
    SENSORS.register(Odometer)(odometer)
    env, rolled, advanced = make(ODOMETER), make(ODOMETER), make(ODOMETER)
    take_steps(env, 3)
    rolled.rollout(3)
    advanced.advance(3)
    alone = env.objects[1].sensors[1].data
    assert [other.objects[1].sensors[1].data for other in (rolled, advanced)] == [alone, alone]
    batch = irsim.batch(env.scenario, 3, seeds=[5, 1, 9], threads=2)
    batch.advance(3)
    assert views(batch.simulation, 1)[1].sensors[1].data == alone
    assert views(batch.simulation, 0)[1].sensors[1].data != alone


def test_worlds_without_one_do_not_pay(make: Make) -> None:
    simulation = make(SEVERAL).simulation
    assert (simulation.measurements, simulation.in_python) == ([], False)


class Counter:
    """A sensor class: counts its measurements."""

    def __init__(self, parent: Any, options: Any) -> None:
        self.parent, self.options, self.count, self.episodes = parent, options, 0, 0

    def reset(self) -> None:
        self.count = 0
        self.episodes += 1

    def step(self, state: np.ndarray) -> dict[str, float]:
        self.count += 1
        return {"x": float(state[0, 0]), "noise": float(self.rng.uniform())}  # type: ignore[attr-defined]


def test_a_sensor_class_of_user_code(make: Make) -> None:
    SENSORS.register(Odometer)(Counter)
    env = make(ODOMETER)
    sensor = env.robot.sensors[1]
    assert (sensor.count, sensor.episodes) == (1, 1)
    env.step()
    assert (sensor.data["x"], sensor.count, sensor.instance.count) == (pytest.approx(2.1), 2, 2)
    env.refresh()
    assert sensor.count == 3
    env.reset()
    assert (sensor.count, sensor.episodes) == (1, 2)
    with pytest.raises(AttributeError, match="altitude"):
        _ = sensor.altitude


def test_plug_ins_are_found_by_entry_point(make: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    class Entry:
        name = "odometer"

        def load(self) -> None:
            SENSORS.register(Odometer)(odometer)

    monkeypatch.setattr(SENSORS, "_plugins", {"odometer": Entry()})
    assert "odometer" in SENSORS.installed()
    assert make(ODOMETER).robot.sensors[1].sensor_type == "odometer"


def test_fields_of_view(make: Make) -> None:
    robot, other, wall, ball = make("""
robot:
  - {kinematics: {name: diff}, shape: {name: circle}, state: [2, 5, 0], fov: 1.0, fov_radius: 4, fov_occlusion: true}
  - {kinematics: {name: diff}, shape: {name: circle}, state: [2, 8, 0]}
obstacle:
  - {shape: {name: rectangle, length: 0.2, width: 3}, state: [4, 5, 0]}
  - {shape: {name: circle, radius: 0.3}, state: [5.4, 5, 0]}
""").objects
    assert robot.get_fov_detected_objects() == [wall]
    robot.fov_occlusion = False
    assert robot.get_fov_detected_objects() == [wall, ball]
    assert (robot.fov_detect_object(ball), robot.fov_detect_object(other)) == (True, False)
    robot.set_state([2, 5, math.pi])
    assert robot.get_fov_detected_objects() == []
    robot.fov, robot.fov_radius = 2 * math.pi, 3.0
    assert robot.get_fov_detected_objects() == [other, wall]
    assert other.get_fov_detected_objects() == [], "it has no field of view"


FOG = """
world: {width: 4, height: 3, fog_map: true, fog_map_resolution: 0.5%s}
robot: {kinematics: {name: diff}, shape: {name: circle}, state: [0.6, 1.2, 0], sensors: [{name: lidar2d, number: 3}]}
"""


def test_the_fog_of_an_environment(make: Make) -> None:
    env = make(FOG % "")
    fog = env._world.fog_map
    assert fog is env._world.fog_map
    assert (fog.shape, fog.explored_ratio, fog.explored.dtype) == ((8, 6), 0.0, bool)
    env.step()
    explored = fog.explored
    assert explored[1:, 2].all()  # the middle beam, to the edge
    assert explored[1].all()
    assert fog.explored_ratio == explored.mean() == 12 / 48
    with pytest.raises(ValueError, match="read-only"):
        explored[0, 0] = True
    fog.reset()
    assert fog.explored_ratio == 0.0
    fog.reveal_from_lidar([3.2, 0.2, 0.0], [0.0], [0.1])
    assert fog.explored[6, 0]
    assert env.simulation.state.explored[0, 6, 0] == 1
    env.reset()
    assert fog.explored_ratio == 0.0
    assert make(SEVERAL)._world.fog_map is None
    assert make(FOG % ", offset: [-1, 2]")._world.fog_map.world_offset == (-1.0, 2.0)


def test_a_fog_map_by_itself() -> None:
    fog = FogMap(4, 3, 0.5)
    fog.reveal_from_lidar(np.array([0.6, 1.2, 0.0]), np.array([0.0, 1.0]), np.array([10.0, 0.9]))
    assert np.argwhere(fog.explored).tolist() == [[1, 2], [1, 3], [2, 2], [2, 3], *([i, 2] for i in range(3, 8))]
    fog.reset()
    fog.reveal_fov(np.array([[2.0], [1.0], [0.5]]), 1.5, 1.2)
    assert np.argwhere(fog.explored).tolist() == [[4, 2], [4, 3], [5, 2], [5, 3]]
    rgba = fog.to_rgba()
    assert (rgba.shape, rgba[0, 0].tolist(), rgba[4, 2, 3]) == ((8, 6, 4), [0.78, 0.78, 0.8, 1.0], 0.0)
    assert fog.to_rgba((1, 0, 0), 0.5)[0, 0].tolist() == [1, 0, 0, 0.5]
    fog.reveal_fov([2, 1, 0], 7.0, 10)
    assert fog.explored_ratio == 1.0
    assert FogMap(4, 3, 0.7).shape == (6, 4)
    assert FogMap(1, 1, 10).shape == (1, 1)
    fog.reveal_from_lidar([0, 0, 0], [], [])
    for bad in (0, -1, math.nan, math.inf):
        with pytest.raises(ValueError, match="positive"):
            FogMap(4, 3, bad)
    with pytest.raises(ValueError, match="finite"):
        fog.reveal_from_lidar([0, 0, 0], [0.0], [math.nan])


def test_sensors_by_themselves() -> None:
    lidar = SensorFactory().create_sensor(np.array([[1.0], [2.0], [0.5]]), 3, name="lidar2d", number=4)
    assert isinstance(lidar, Lidar2D)
    assert (lidar.obj_id, lidar.lidar_origin[:, 0]) == (3, pytest.approx([1, 2, 0.5]))
    assert lidar.get_scan()["ranges"].tolist() == [10.0] * 4
    assert isinstance(SensorFactory().create_sensor([0, 0, 0], 0, type="fmcw_lidar2d"), FMCWLidar2D)
    with pytest.raises(NotImplementedError, match="radar"):
        SensorFactory().create_sensor([0, 0, 0], 0, name="radar")


# `endpoint`: n beams over a full turn as n directions
DIRECTIONS = """
world: {{width: 10, height: 10}}
robot: {{kinematics: {{name: diff}}, shape: {{name: circle, radius: 0.2}}, state: [5, 5, 0], goal: [9, 5],
  behavior: {{name: dash}}, sensors: [{{name: {name}, number: {number}, angle_range: {span}{more}}}]}}
obstacle: {{shape: {{name: circle, radius: 1}}, state: [2, 5, 0]}}
"""


def directions(number: int, span: float = 2 * math.pi, more: str = ", endpoint: false", name: str = "lidar2d") -> str:
    return DIRECTIONS.format(name=name, number=number, span=span, more=more)


@pytest.mark.parametrize("name", ["lidar2d", "fmcw_lidar2d"])
def test_n_beams_are_n_directions(make: Make, name: str) -> None:
    lidar = make(directions(720, name=name)).robot.lidar
    angles = np.degrees(lidar.angle_list)
    np.testing.assert_allclose(angles, np.linspace(-180, 180, 720, endpoint=False), atol=1e-9)
    scan, half_a_degree = lidar.get_scan(), math.radians(0.5)
    assert (lidar.angle_inc, scan["angle_increment"]) == pytest.approx((half_a_degree, half_a_degree))
    assert scan["angle_max"] == pytest.approx(math.pi - half_a_degree)


def test_the_last_beam_does_not_repeat_the_first(make: Make) -> None:
    lidar, closed = (make(directions(4, more=more)).robot.lidar for more in (", endpoint: false", ""))
    assert np.degrees(lidar.angle_list).tolist() == pytest.approx([-180, -90, 0, 90])
    assert lidar.range_data.tolist() == pytest.approx([2, 10, 10, 10])
    assert np.degrees(closed.angle_list).tolist() == pytest.approx([-180, -60, 60, 180])


def test_the_key_may_be_written_at_run_time(make: Make) -> None:
    lidar = make(directions(9, math.pi, more="")).robot.lidar
    assert (lidar.endpoint, lidar.angle_max) == (True, pytest.approx(math.pi / 2))
    lidar.endpoint = False
    assert lidar.angle_max == pytest.approx(math.pi / 2 - math.pi / 9)


@pytest.mark.parametrize(("more", "fixes"), [("", ["endpoint: false, for 720 directions"]), (", endpoint: false", [])])
def test_the_checker_proposes_the_key(more: str, fixes: list[str]) -> None:
    findings = irsim.validate(text=directions(720, 6.28318, more=more)).findings
    assert [finding.fix for finding in findings if finding.code == "lidar-ends-meet"] == fixes
