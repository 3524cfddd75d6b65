"""Maps of an environment: its grid, its obstacles, the footprint of its robot."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import shapely

import irsim
from irsim.lib.path_planners import AStarPlanner, JPSPlanner
from irsim.navigation.map import EnvGridMap, Map, coarsen

pytestmark = pytest.mark.one_python

SCENE = """
world: {width: 10, height: 10, offset: [-2, 0], obstacle_map: {name: perlin, resolution: 0.1, fill: 0.12, seed: 3}}
robot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [-1, 1, 0], goal: [7, 9]}
obstacle:
  - {shape: {name: rectangle, length: 1, width: 1}, state: [3, 5, 0]}
  - {shape: {name: circle, radius: 1}, state: [5, 3], unobstructed: true}
"""


@pytest.fixture
def env(tmp_path: Path) -> irsim.Env:
    (tmp_path / "scene.yaml").write_text(SCENE)
    return irsim.make(tmp_path / "scene.yaml", headless=True, log_level="ERROR", seed=1)


def test_map_of_an_environment(env: irsim.Env) -> None:
    env_map = env.get_map(0.1)
    assert isinstance(env_map, EnvGridMap)
    assert env_map.grid_resolution == pytest.approx((0.1, 0.1))
    assert env_map.world_offset == (-2.0, 0.0)
    assert env_map.is_collision(shapely.box(2.6, 4.6, 2.7, 4.7))
    assert env_map.is_collision(shapely.box(-2.1, 1, -1.9, 1.2)), "outside the world"
    assert env_map.grid_occupied(-3, 1) is True
    i, j = (int(k[0]) for k in np.nonzero(env_map.grid > 50))
    assert env_map.grid_occupied(-2 + (i + 0.5) * 0.1, (j + 0.5) * 0.1) is True
    assert Map(5, 5).grid_occupied(1, 1) is None


def test_what_is_written_to_a_grid_counts(tmp_path: Path) -> None:
    (tmp_path / "cave.yaml").write_text(
        "world: {width: 50, height: 50, obstacle_map: cave.png}\n"
        "robot: {shape: {name: circle, radius: 0.2}, state: [1, 1]}"
    )
    env_map = irsim.make(tmp_path / "cave.yaml", headless=True, log_level="ERROR").get_map(0.0)
    free, full = (np.argwhere(env_map.grid == value)[7] for value in (0, 100))
    cells = [shapely.Point((index + 0.5) * env_map.grid_resolution) for index in (free, full)]
    assert [env_map.is_collision(point) for point in cells] == [False, True]
    env_map.grid[tuple(free)], env_map.grid[tuple(full)] = 100, 0
    assert [env_map.is_collision(point) for point in cells] == [True, False]
    env_map.grid = 100 - env_map.grid
    assert [env_map.is_collision(point) for point in cells] == [False, True]


def test_a_disk_is_in_the_way_where_it_stands(tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(
        "world: {width: 10, height: 10, obstacle_map: {name: perlin, resolution: 0.1, fill: 0}}\n"
        "robot: {shape: {name: circle, radius: 0.2}, state: [1, 1]}\n"
        "obstacle: {shape: {name: circle, radius: 0.5, center: [1, 0]}, state: [5, 5, 1.5707963]}\n"
    )
    disk = irsim.make(tmp_path / "scene.yaml", headless=True, log_level="ERROR").get_map(0.1)
    assert [disk.is_collision(shapely.Point(5, y)) for y in (5, 5.6, 6.4, 6.6)] == [False, True, True, False]


def test_resolutions(env: irsim.Env) -> None:
    with pytest.warns(UserWarning, match="merged"):
        joined = env.get_map(0.2)
    assert joined.grid.shape == (50, 50)
    assert (joined.grid == env.get_map(0.1).grid.reshape(50, 2, 50, 2).max(axis=(1, 3))).all()
    with pytest.warns(UserWarning, match="cannot be divided"):
        assert env.get_map(0.05).grid.shape == (100, 100)
    assert env.get_map(0).grid.shape == (100, 100)
    assert coarsen(np.eye(5), 2, 2).shape == (2, 2)


def test_planners_plan_for_the_robot(env: irsim.Env) -> None:
    env_map = env.get_map(0.1)
    paths = [cls(env_map).planning((-1, 1), (7, 9), show_animation=False) for cls in (AStarPlanner, JPSPlanner)]
    assert paths[0] is not None
    assert paths[1] is not None
    lengths = [np.linalg.norm(np.diff(path, axis=1), axis=0).sum() for path in paths]
    assert lengths[0] == pytest.approx(lengths[1])
    for x, y in paths[0].T:
        assert not env_map.is_collision(shapely.Point(x, y).buffer(0.199))


def test_animation_is_drawn_onto_the_figure(tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(SCENE)
    env = irsim.make(tmp_path / "scene.yaml", display=False, log_level="ERROR", seed=1)
    env.render()
    before = len(env._env_plot.ax.lines)
    AStarPlanner(env.get_map(0.1)).planning((-1, 1), (7, 9))
    assert len(env._env_plot.ax.lines) > before
    env.end(ending_time=0.0)
