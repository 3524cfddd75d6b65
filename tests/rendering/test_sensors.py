"""Velocity colours, marks and fog in pictures."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import pytest
from matplotlib.colors import to_rgba

from irsim.components.options import SensorOptions
from irsim.objects.drawing.scene_builder import SceneBuilder
from irsim.options.registry import SENSORS
from tests.env.driving import Make, take_steps
from tests.rendering.conftest import Look

WORLD = """
world: {width: 10, height: 10%s}
robot:
  kinematics: {name: diff}
  shape: {name: rectangle, length: 0.4, width: 0.3}
  state: [3, 5, 0]
  velocity: [0.5, 0]
  sensors: [{name: fmcw_lidar2d, number: 5, angle_range: 1.4, range_max: 6%s}]
obstacle:
  - {kinematics: {name: diff}, shape: {name: rectangle, length: 0.3, width: 1}, state: [6, 5, 0], velocity: [1.5, 0]}
  - {kinematics: {name: diff}, shape: {name: rectangle, length: 0.3, width: 1}, state: [6, 7.3, 0], velocity: [0, 0]}
"""


def test_beams_have_the_colour_of_their_velocity(make: Make) -> None:
    env = make(WORLD % ("", ", velocity_color_max: 2.0"))
    (beams,) = SceneBuilder(env.simulation).build().beams
    rest, away = np.array(to_rgba("#56B4E9")), np.array(to_rgba("#CC3311"))
    np.testing.assert_allclose(beams.colors[2], rest + 0.5 * (away - rest))  # recedes at 1 of 2 m/s
    np.testing.assert_allclose(beams.colors[0], to_rgba("lightgray", 0.03))
    assert (beams.widths.tolist(), beams.dots.points.shape) == ([0.8, 0.8, 2.5, 0.8, 2.5], (2, 2))
    assert beams.dots.points[0] == pytest.approx((5.85, 5.0))
    near = beams.colors[4]  # approached at 0.5 cos(0.7) m/s
    share = 0.5 * np.cos(0.7) / 2
    np.testing.assert_allclose(near, rest + share * (np.array(to_rgba("#0072B2")) - rest))


def test_drawing_options_may_be_switched_off_and_changed(make: Make) -> None:
    env = make(WORLD % ("", ", plot: {velocity_color: false, show_velocity_markers: false, color: blue}"))
    builder = SceneBuilder(env.simulation)
    (beams,) = builder.build().beams
    assert (beams.colors, beams.dots, beams.color) == (None, None, "blue")
    env.robot.lidar.show_velocity_markers = True
    env.robot.lidar.velocity_marker_size = 9
    (beams,) = builder.build().beams
    assert beams.dots.area == 9
    assert builder.build().as_dict()["beams"][0]["dots"]["area"] == 9


def test_marks_and_beams_are_seen(make: Make, color_at: Look) -> None:
    env = make(WORLD % ("", ", positive_velocity_color: [0, 0, 1], zero_velocity_color: [0, 0, 1]"))
    assert (color_at(env, 4.5, 5.0), color_at(env, 5.83, 5.0)) == ((0, 0, 255), (0, 0, 255))


def test_fog_covers_what_nobody_has_seen(make: Make, color_at: Look) -> None:
    env = make(WORLD % (", fog_map: true, fog_map_resolution: 0.5", ""))
    fog = (199, 199, 204)
    assert color_at(env, 9.0, 1.0) == fog
    assert color_at(env, 6.0, 7.2) == fog  # hides obstacles
    env.step()
    assert (color_at(env, 9.0, 1.0), color_at(env, 4.7, 5.3)) == (fog, (255, 255, 255))
    env.reset()
    assert color_at(env, 4.7, 5.3) == fog
    scene = SceneBuilder(env.simulation).build()
    assert scene.fog.extent == (0.0, 10.0, 0.0, 10.0)
    assert SceneBuilder(make(WORLD % ("", "")).simulation).build().fog is None


def test_a_lidar_draws_itself_into_any_axes(make: Make) -> None:
    from matplotlib.figure import Figure

    env = make(WORLD % ("", ""))
    ax = Figure().add_subplot()
    lidar = env.robot.lidar
    lidar.plot(ax, env.robot.state, alpha=0.5)
    assert len(ax.collections) == 2
    env.step()
    lidar.step_plot()
    lidar.plot_clear()
    assert len(ax.collections) == 0
    lidar.step_plot()


class Flag(SensorOptions):
    """Draws a square ahead of its carrier."""

    name: Literal["flag"] = "flag"


class DrawnFlag:
    def __init__(self, parent: Any, options: Any) -> None:
        self.parent, self.line = parent, None

    def step(self, state: np.ndarray) -> None:
        pass

    def plot(self, ax: Any, state: np.ndarray, **kwargs: Any) -> None:
        (self.line,) = ax.plot([float(state[0, 0]) + 0.5], [float(state[1, 0])], "s", color="m", markersize=12)

    def step_plot(self) -> None:
        self.line.set_data([self.parent.position[0, 0] + 0.5], [self.parent.position[1, 0]])

    def plot_clear(self) -> None:
        self.line.remove()


def test_a_sensor_of_user_code_draws_itself(make: Make, color_at: Look) -> None:
    SENSORS.register(Flag)(DrawnFlag)
    env = make(
        "robot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [2, 5, 0], goal: [9, 5],"
        " behavior: {name: dash}, sensors: [{name: flag}], plot: {show_arrow: false}}"
    )
    magenta = (191, 0, 191)
    assert color_at(env, 2.5, 5.0) == magenta
    take_steps(env, 20)
    assert (color_at(env, 4.5, 5.0), color_at(env, 2.5, 5.0)) == (magenta, (255, 255, 255))
    env.reset()
    assert color_at(env, 2.5, 5.0) == magenta
    env.delete_object(0)
    assert color_at(env, 2.5, 5.0) == (255, 255, 255)
