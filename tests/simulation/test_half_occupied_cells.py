"""A cell that is exactly half occupied is free, for every reader of the map: 51 of 100 is occupied, 50 is not."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import shapely
from PIL import Image

import irsim
from irsim.objects.describe import describe_scene
from irsim.runs.replay.drawing import page_grid

LEVELS = [[0, 50, 51, 100]]
FULL = [False, False, True, True]
READERS: dict[str, Callable[[Any], Any]] = {
    "engine": lambda env: env.simulation.state.cells(1).occupied[:, 0].astype(bool).tolist(),
    "other programs": lambda env: describe_scene(env.simulation).grid.occupied[:, 0].tolist(),
    "page of a run": lambda env: np.repeat(
        np.arange(9) % 2 == 1, _padded(page_grid(describe_scene(env.simulation))["runs"])
    ).tolist(),
    "planners": lambda env: [env.get_map(0.0).is_collision(shapely.Point(x + 0.5, 0.5)) for x in range(4)],
    "scripts": lambda env: [env.get_map(0.0).grid_occupied(x + 0.5, 0.5) for x in range(4)],
    "positions of cells": lambda env: [x in env._world.obstacle_index[0] for x in range(4)],
}


def _padded(runs: Any) -> list[int]:
    """Lengths of runs of free and occupied cells by turns, of nine runs."""
    return [*map(int, runs), *[0] * 9][:9]


@pytest.fixture(scope="module")
def env(tmp_path_factory: pytest.TempPathFactory) -> irsim.Env:
    folder = tmp_path_factory.mktemp("map")
    Image.fromarray(np.array(LEVELS, np.uint8)).save(folder / "map.pgm")
    (folder / "map.yaml").write_text("{image: map.pgm, resolution: 1.0, origin: [0, 0, 0], mode: raw}")
    (folder / "scene.yaml").write_text(
        "world: {width: 4, height: 1, obstacle_map: {name: ros, path: map.yaml}}\n"
        "robot: {shape: {name: circle, radius: 0.2}, state: [0.5, 0.5]}\n"
    )
    return irsim.make(folder / "scene.yaml", headless=True, log_level="ERROR")


@pytest.mark.parametrize("reader", READERS)
def test_half_occupied_is_free(env: irsim.Env, reader: str) -> None:
    assert READERS[reader](env) == FULL
