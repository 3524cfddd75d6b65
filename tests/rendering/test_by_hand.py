"""Objects and parts of the picture that scripts draw by hand."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from irsim.simulation.fog import FogMap
from tests.env.driving import Make

YAML = """
world: {width: 10, height: 8, offset: [1, 2]}
robot:
  - kinematics: {name: diff}
    shape: {name: circle, radius: 0.2}
    state: [3, 4, 0.5]
    goal: [9, 8, 0]
    fov: 1.0
    fov_radius: 2.0
    sensors: [{name: lidar2d, number: 9}]
    behavior: {name: dash}
    plot: {show_trajectory: true, show_goal: true, show_fov: true, show_text: true}
obstacle:
  - {shape: {name: rectangle, length: 1, width: 2}, state: [6, 6, 0]}
"""


@pytest.fixture
def env(make: Make) -> Any:
    return make(YAML)


@pytest.fixture
def ax() -> Axes:
    axes = Figure().add_subplot()
    axes.set_xlim(0, 12)
    axes.set_ylim(0, 12)
    return axes


def extent(artist: Any) -> list[float]:
    """Bounding box in data coordinates: x from, y from, x to, y to."""
    box = artist.get_path().get_extents()
    return [*box.min, *box.max]


def test_plot_draws_what_the_keys_show_and_clear_takes_it_out(env: Any, ax: Axes) -> None:
    robot = env.robot
    env.step()
    env.step()
    before = len(ax.get_children())
    robot.plot(ax)
    assert robot.ax is ax
    parts = [robot.object_patch, robot.goal_patch, robot.fov_patch, robot.arrow_patch, robot.trajectory_line]
    assert all(part in ax.get_children() for part in parts)
    assert robot.plot_line_list == [robot.trajectory_line]
    assert [text.get_text() for text in robot.plot_text_list] == ["r0"]
    robot.plot_trail(ax)
    robot.plot_clear()
    assert (robot.plot_patch_list, robot.plot_line_list, robot.plot_text_list) == ([], [], [])
    assert len(robot.plot_trail_list) == 1
    robot.plot_clear(all=True)
    assert robot.plot_trail_list == []
    assert len(ax.get_children()) == before


def test_a_body_is_drawn_where_it_is_or_where_one_says(env: Any, ax: Axes) -> None:
    robot, corners = env.robot, np.array([[0, 1, 1], [0, 0, 2]])
    for keys, box in (
        ({}, [2.8, 3.8, 3.2, 4.2]),
        ({"vertices": corners}, [0, 0, 1, 2]),
        ({"state": [[5], [6], [0]], "obj_color": "r", "obj_alpha": 0.5}, [4.8, 5.8, 5.2, 6.2]),
    ):
        robot.plot_object(ax, **keys)
        np.testing.assert_allclose(extent(robot.object_patch), box, atol=1e-3)
    assert robot.object_patch.get_facecolor() == (1, 0, 0, 0.5)


def test_goals_and_arrows_are_drawn_as_asked(env: Any, ax: Axes) -> None:
    robot = env.robot
    robot.plot_goal(ax, goal_state=[4, 4], goal_color="b")
    np.testing.assert_allclose(extent(robot.goal_patch), [3.8, 3.8, 4.2, 4.2], atol=1e-3)
    assert robot.goal_patch.get_facecolor()[:3] == (0, 0, 1)
    robot.plot_arrow(ax, state=[1, 1, 0], arrow_theta=np.pi / 2, arrow_length=2.0, arrow_width=0.2)
    low_x, low_y, high_x, high_y = extent(robot.arrow_patch)
    assert high_y - low_y > 5 * (high_x - low_x)
    robot.set_goal(None)
    robot.plot_goal(ax)
    assert len(robot.plot_patch_list) == 2


def test_trails_keep_the_newest(env: Any, ax: Axes) -> None:
    for x in range(5):
        env.robot.plot_trail(ax, state=[x, 1, 0], keep_trail_length=2)
    assert [round(extent(mark)[0] + 0.2, 3) for mark in env.robot.plot_trail_list] == [3, 4]


def test_what_is_not_there_is_not_drawn(env: Any, ax: Axes) -> None:
    box = env.obstacle_list[0]
    box.plot_fov(ax)
    box.plot_trajectory(ax)
    box.plot_uncertainty(ax)
    assert box.plot_object_image(ax) is False
    assert box.plot_patch_list == box.plot_line_list == []


def test_axes_are_those_of_the_environment_by_default(env: Any) -> None:
    env.robot.plot_object()
    assert env.robot.object_patch.axes is env._env_plot.ax
    env.robot.plot_kwargs["obj_color"] = "r"
    assert env.robot.plot_kwargs["obj_color"] == next(env._env_plot.scene().of(0, "body")).fill == "r"


def test_headless_nothing_is_drawn(make: Make) -> None:
    env = make(YAML, headless=True)
    env.robot.plot()
    env.robot.plot_clear(all=True)
    assert (env.robot.ax, env.robot.object_patch) == (None, None)


# the picture
def test_components_are_cleared_until_drawn_again(env: Any) -> None:
    plot = env._env_plot
    assert (plot.x_range, plot.y_range, plot.logger) == ([1, 11], [2, 10], env.logger)
    plot.clear_components("dynamic")
    assert {mark.object for mark in plot.scene().marks} == {1}
    assert plot.scene().beams == []
    plot.draw_components("all", goal_color="r")
    assert {mark.object for mark in plot.scene().marks} == {0, 1}
    assert next(plot.scene().of(0, "goal")).fill == "r"
    with pytest.raises(ValueError, match="unknown mode"):
        plot.clear_components("some")


def test_a_step_of_the_picture_shows_the_time(env: Any) -> None:
    env.step()
    env._env_plot.step()
    assert env._env_plot.ax.get_title() == "Simulation Time: 0.10s, Status: Running"
    env.set_title("mine")
    env._env_plot.update_title()
    assert env._env_plot.ax.get_title() == "mine"


def test_the_view_follows_the_viewpoint(env: Any) -> None:
    env._env_plot.viewpoint = "robot_0"
    env._env_plot.set_ax_viewpoint(env.objects)
    assert np.mean(env._env_plot.ax.get_xlim()) == pytest.approx(3)
    assert np.mean(env._env_plot.ax.get_ylim()) == pytest.approx(4)


def test_maps_and_fog_of_scripts_are_drawn(env: Any) -> None:
    plot = env._env_plot
    before = len(plot.ax.images)
    grid = np.zeros((5, 4))
    grid[1, 2] = 100
    plot.draw_grid_map(grid, alpha=0.5)
    fog = FogMap(10, 8, 1.0, [1, 2])
    fog.reveal_fov([5, 5, 0], 7, 1.5)
    plot.draw_fog(fog)
    image, cover = plot.ax.images[before:]
    assert (image.get_extent(), image.get_array().shape, image.get_array()[2, 1]) == ([1, 11, 2, 10], (4, 5), 0)
    assert (cover.get_array()[..., 3] == 0).sum() == fog.explored.sum()


def test_animations_are_saved_under_the_name_given(env: Any, tmp_path: Path) -> None:
    env._env_plot.add_frame()
    assert env._env_plot.save_animate("mine") == tmp_path / "animation" / "mine.gif"
    assert (tmp_path / "animation" / "mine.gif").stat().st_size > 0


def test_objects_of_others_are_drawn_too(env: Any) -> None:
    loose = env.create_obstacle(shape={"name": "circle", "radius": 0.5}, state=[2, 3, 0])
    env._env_plot.init_objects_plot([*env.objects, loose])
    assert loose.object_patch in env._env_plot.ax.get_children()


def test_the_arrow_of_an_omni_drive_shows_its_control(make: Make, ax: Axes) -> None:
    robot = make("robot: {kinematics: {name: omni}, state: [3, 3, 0], goal: [9, 9, 0]}", headless=True).robot
    robot.plot_arrow(ax, velocity=[[0], [1]], arrow_length=2.0, arrow_width=0.2)
    low_x, low_y, high_x, high_y = extent(robot.arrow_patch)
    assert high_y - low_y > 5 * (high_x - low_x)
