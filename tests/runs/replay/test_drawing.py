"""Shapes, lidars and map of a run, as its page draws them."""

from __future__ import annotations

from itertools import accumulate

import numpy as np
import pytest

import irsim
from irsim.api import read_scenario
from irsim.objects.describe import describe_scene
from irsim.runs.replay.drawing import page_grid, page_objects

SCENE = """
world: {width: 6, height: 3, boundary: walls, obstacle_map: {name: perlin, resolution: 0.5, fill: 0.4, seed: 2}}
robot:
  shape: {name: circle, radius: 0.1}
  state: [1, 1, 0.5]
  unobstructed: true
  sensors: [{name: lidar2d, number: 5, angle_range: 2, offset: [0.1, 0, 0.3]}]
"""


@pytest.fixture
def env() -> irsim.Env:
    scenario, _ = read_scenario(text=SCENE, strict=True)
    return irsim.Env(scenario, seed=1, headless=True, log_level="ERROR")


def test_cells_of_the_map_are_told_row_by_row_from_below(env: irsim.Env) -> None:
    grid = page_grid(describe_scene(env.simulation))
    assert grid is not None
    assert (grid["cells"], grid["extent"]) == ([12, 6], [0, 6, 0, 3])
    changes = set(accumulate(grid["runs"]))
    full, shown = False, []
    for cell in range(12 * 6):
        full ^= cell in changes
        shown.append(full)
    known = env._world.grid_map > 50
    assert 0 < known.sum() < known.size
    assert np.array_equal(np.reshape(shown, (6, 12)), known.T)


def test_beams_have_the_directions_of_the_scan(env: irsim.Env) -> None:
    [lidar] = page_objects(describe_scene(env.simulation))[2]
    assert lidar["pose"] == [0.1, 0, 0.3]
    angles = lidar["first"] + lidar["between"] * np.arange(lidar["beams"])
    assert angles == pytest.approx(np.asarray(env.simulation.state.beam_angles))


def test_walls_round_the_world_are_a_closed_line(env: irsim.Env) -> None:
    shapes, objects, _ = page_objects(describe_scene(env.simulation))
    [walls] = [item for item in objects if item["name"] == "boundary"]
    points = np.reshape(shapes[walls["shape"]]["line"], (-1, 2))
    assert len(points) == 5
    assert points[0].tolist() == points[-1].tolist()
