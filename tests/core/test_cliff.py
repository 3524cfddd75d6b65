"""Cliff sensors over zones without floor."""

from __future__ import annotations

from typing import Any

import numpy as np

import irsim._core as core
from tests.core.distributions import assert_share
from tests.core.worlds import PI, circle, line, polygon, robot, scene

STAIRS = polygon((2, -1), (4, -1), (4, 1), (2, 1))
HOLE = circle(0.5, (0.0, 3.0))
EDGE = line((5, -5), (5, 5))


def drops(pose: Any, seeds: Any = (0,), **overrides: Any) -> np.ndarray:
    """The readings after one step, (W, points)."""
    given = {"points": [[0.3, 0.1], [0.3, -0.1], [-0.3, 0.0]], "zones": [0, 2], "miss_share": 0.0, "false_share": 0.0}
    carrier = robot(sensors=[core.CliffOptions(**{**given, **overrides})], behavior=None, pose=list(pose))
    world, state = scene(carrier, seeds=seeds, mode=1, zones=[STAIRS, EDGE, HOLE])
    core.advance(world, state, 1)
    read: np.ndarray = state.readings.reshape(len(seeds), -1)
    return read


def test_points_over_a_drop_see_no_floor() -> None:
    assert drops((0.0, 0.0, 0.0))[0].tolist() == [0, 0, 0]
    assert drops((1.75, 0.0, 0.0))[0].tolist() == [1, 1, 0]
    assert drops((1.75, 0.95, 0.0))[0].tolist() == [0, 1, 0]
    assert drops((1.75, 0.0, PI))[0].tolist() == [0, 0, 1]
    assert drops((-0.3, 3.0, 0.0))[0].tolist() == [1, 1, 0]
    assert drops((3.0, 0.0, 0.0), zones=[2])[0].tolist() == [0, 0, 0]
    assert drops((4.8, 3.0, 0.0), zones=[1])[0].tolist() == [0, 0, 0]  # a line has no area


def test_errors_come_as_often_as_asked_for() -> None:
    over = drops((3.0, 0.0, 0.0), seeds=range(10_000), miss_share=0.1, false_share=0.3)
    assert_share(over.reshape(-1) == 0, 0.1)
    beside = drops((0.0, -3.0, 0.0), seeds=range(10_000), miss_share=0.1, false_share=0.3)
    assert_share(beside.reshape(-1) == 1, 0.3)
    for seed in (3, 4):
        alone = drops((0.0, -3.0, 0.0), seeds=(seed,), miss_share=0.1, false_share=0.3)[0]
        np.testing.assert_array_equal(alone, beside[seed])
