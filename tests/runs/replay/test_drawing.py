"""Data of the replay page: bodies, map cells, compact series of numbers."""

from __future__ import annotations

from itertools import accumulate

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import irsim
from irsim.api import read_scenario
from irsim.bridges.json_lines.bridge import scene_as_json
from irsim.objects.describe import describe_scene
from irsim.runs.replay.drawing import Columns, changes, page_grid, page_objects, quantised
from irsim.scenario.read import read
from irsim.simulation.simulation import Simulation
from tests.components.test_unknown_cells import write_map
from tests.runs.replay.reading import unpacked

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


def test_unknown_cells_are_runs_of_their_own(tmp_path) -> None:
    scenario = read(write_map(tmp_path)).scenario
    assert scenario is not None
    scene = describe_scene(Simulation(scenario, [0]))
    grid = page_grid(scene)
    assert grid is not None
    shown = np.repeat(np.arange(len(grid["unknown"])) % 2, grid["unknown"])
    assert np.array_equal(shown.reshape(100, 100), scene.grid.unknown.T)
    assert scene_as_json(scene)["grid"]["unknown"] == [4000, *[80, 20] * 19, 80, 4020]


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


NUMBERS = st.integers(-(2**31), 2**31 - 1)


@given(st.lists(st.lists(NUMBERS, min_size=3, max_size=3), max_size=4), st.integers(0, 2), st.text(max_size=9))
def test_a_block_is_read_back(rows: list[list[int]], order: int, text: str) -> None:
    table = np.array(rows, dtype=np.int32).reshape(-1, 3)
    columns = Columns()
    columns.add("table", table, order)
    columns.add("flat", table.ravel(), order)
    head, arrays = unpacked(columns.block({"text": text}))
    assert head["text"] == text
    np.testing.assert_array_equal(arrays["table"], table)
    np.testing.assert_array_equal(arrays["flat"], table.ravel())


def test_smooth_series_are_small() -> None:
    t = np.arange(1000) * 0.1
    columns = Columns()
    columns.add("x", quantised(np.stack([5 + 3 * np.sin(t / 9 + k) for k in range(100)]), 2**-12), 2)
    assert len(columns.block({})) < 100_000  # a byte for each number


def test_what_is_not_finite_is_quantised_all_the_same() -> None:
    steps = quantised([np.nan, np.inf, -np.inf, 0.26, 1e300], 0.125)
    assert steps.tolist() == [0, 2**31 - 1, 1 - 2**31, 2, 2**31 - 1]


def test_changes() -> None:
    series = np.array([[1.0, np.nan], [1.0, np.nan], [2.0, np.nan], [2.0, 3.0]])
    rows, objects = changes([series, np.zeros((4, 2))])
    assert list(zip(objects.tolist(), rows.tolist(), strict=True)) == [(0, 0), (0, 2), (1, 0), (1, 3)]


def test_numbers_that_do_not_fit_are_refused() -> None:
    with pytest.raises(OverflowError):
        Columns().add("x", [2**31])
