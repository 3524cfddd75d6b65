"""Sonars and infrared range sensors in programs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from irsim.objects.drawing.scene_builder import SceneBuilder

SCENE = """
world: {width: 12, height: 12}
robot:
  kinematics: {name: diff}
  shape: {name: circle, radius: 0.2}
  state: [2, 6, 0]
  goal: [7, 6]
  behavior: {name: dash}
  sensors:
    - {name: sonar, device: hc_sr04, offset: [0.2, 0, 0], std: 0}
    - {name: lidar2d, number: 9}
    - {name: ir_range, offset: [0.2, 0, 0]}
    - {name: ir_range, device: vl53l0x, offset: [-0.2, 0, 3.14159]}
obstacle: {shape: {name: rectangle, length: 1, width: 4}, state: [8, 6, 0]}
"""


def test_sensors_of_one_cone_read_by_name(make: Callable[..., Any]) -> None:
    env = make(SCENE)
    env.step()
    sonar, lidar, infrared, behind = env.robot_list[0].sensors
    assert lidar is env.robot_list[0].lidar
    assert lidar.range_data.shape == (9,)
    assert sonar.read() == {"range": 4.0, "valid": 0.0, "field_of_view": 0.2618}
    for _ in range(39):
        env.step()
    ahead = 7.5 - 0.2 - float(env.robot_list[0].state[0, 0])
    assert sonar.read()["range"] == pytest.approx(ahead, rel=1e-4)
    assert sonar.read()["valid"] == 1
    assert behind.read() == {"range": 2.0, "valid": 0.0, "field_of_view": 0.4363}
    assert infrared.read()["valid"] == 0
    for _ in range(6):
        env.step()
    assert infrared.read()["range"] == pytest.approx(7.5 - 0.2 - float(env.robot_list[0].state[0, 0]), rel=1e-4)
    assert sonar.units == ("m", "1", "rad")


def test_cones_are_drawn_up_to_what_they_read(make: Callable[..., Any]) -> None:
    env = make(SCENE)
    for _ in range(40):
        env.step()
    marks = SceneBuilder(env.simulation).build().marks
    drawn = [mark.geometry for mark in marks if mark.part == "fov"]
    sonar, _, _, behind = env.robot_list[0].sensors
    x = float(env.robot_list[0].state[0, 0])
    assert len(drawn) == 3
    assert (drawn[0].x, drawn[0].radius) == pytest.approx((x + 0.2, sonar.read()["range"]))
    assert drawn[2].end - drawn[2].start == pytest.approx(behind.options.cone)
    assert drawn[2].x == pytest.approx(x - 0.2)


def test_a_shortest_range_beyond_the_greatest_is_an_error(make: Callable[..., Any]) -> None:
    with pytest.raises(ValueError, match="range_min must be smaller than range_max"):
        make(SCENE.replace("{name: ir_range, offset: [0.2, 0, 0]}", "{name: ir_range, range_min: 0.9}"))
