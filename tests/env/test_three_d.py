"""The view in space."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import irsim
from tests.env.driving import Make

YAML = """\
world: {width: 6, height: 4, depth: 3}
robot:
  - {kinematics: {name: diff}, shape: {name: circle, radius: 0.3}, state: [1, 1, 0.5], goal: [5, 3],
     behavior: {name: dash},
     sensors: [{name: lidar2d, number: 30, range_max: 2}],
     plot: {show_goal: true, show_trajectory: true, show_text: true, show_trail: true}}
obstacle:
  - {shape: {name: polygon, vertices: [[0, 0], [1, 0], [0.5, 1]]}, state: [3, 1, 0]}
  - {shape: {name: linestring, vertices: [[0, 3.5], [6, 3.5]]}, state: [0, 0, 0]}
"""


def test_the_simulation_is_the_flat_one(make: Make) -> None:
    flat, space = make(YAML), make(YAML, projection="3D", headless=False, display=False)
    assert isinstance(space, irsim.EnvBase3D)
    for _ in range(20):
        flat.step()
        space.step()
        space.render(0)
    assert np.array_equal(flat.robot.state, space.robot.state)
    assert (space._world.depth, space._world.z_range) == (3.0, [0.0, 3.0])


def test_dollars_in_names_and_titles_are_no_formulas(make: Make) -> None:
    named = YAML.replace("{kinematics:", "{name: '$\\frac{$', kinematics:")
    env = make(named, projection="3d", headless=False, display=False)
    env.set_title("costs $\\x$")
    env.render(0)


def test_pictures_and_drawings(make: Make, tmp_path: Path) -> None:
    env = make(YAML, projection="3d", headless=False, display=False)
    env.path_param.fig_path = str(tmp_path)
    ax = env._env_plot.ax
    assert ax.name == "3d"
    env.draw_points(np.array([[1.0, 2.0], [1.0, 2.0], [0.5, 1.0]]))
    env.draw_trajectory([np.array([[1.0], [1.0], [0.3]]), np.array([[2.0], [3.0], [1.0]])], show_direction=True)
    env.draw_box(np.array([[1.0, 2.0, 2.0], [1.0, 1.0, 2.0]]))
    env.draw_quiver(np.array([1.0, 1.0, 0.5, 0.5, 0.0, 0.2]))
    with pytest.raises(ValueError, match="6 numbers"):
        env.draw_quiver(np.array([1.0, 1.0, 0.5, 0.5]))
    assert env.save_figure("space.png") == tmp_path / "space.png"
    drawn = len(ax.collections)
    for _ in range(5):
        env.step()
        env.render(0)
    assert len(ax.collections) <= drawn + 2  # frames replace each other
    env.reset()
    env.render(0)


def test_an_animation_in_space(make: Make, tmp_path: Path) -> None:
    env = make(YAML, projection="3d", headless=False, display=False, save_ani=True)
    env.path_param.ani_path = str(tmp_path)
    for _ in range(3):
        env.step()
        env.render(0)
    env.end(ending_time=0, ani_name="space")
    assert (tmp_path / "space.gif").stat().st_size > 1000
