"""Radio ranges to anchors, and how walls make them longer."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import shapely

import irsim._core as core
from tests.core.distributions import assert_share, assert_standard_normal
from tests.core.worlds import circle, line, obstacle, polygon, robot, scene

UWB: dict[str, Any] = {
    "anchors": [[4.0, 0.0]], "offset": [0, 0, 0], "range_max": 50.0, "std": 0.0, "nlos_bias": 0.0, "nlos_std": 0.0,
    "outlier_share": 0.0, "outlier_mean": 1.0, "dropout": 0.0,
}  # fmt: skip


def measure(*things: core.ObjectSpec, seeds: Any = (0,), pose: Any = (0.0, 0.0, 0.0), **overrides: Any) -> np.ndarray:
    """The ranges after one step, (W, anchors), to a robot that rests at a pose."""
    options = core.UwbOptions(**{**UWB, **overrides})
    carrier = robot(sensors=[options], behavior=None, pose=list(pose), parts=[circle(0.3)])
    world, state = scene(carrier, *things, seeds=seeds, mode=1)
    core.advance(world, state, 1)
    ranges: np.ndarray = state.readings.reshape(len(seeds), -1)
    return ranges


def walls(*things: core.ObjectSpec, **overrides: Any) -> list[int]:
    """Number of walls that are counted on the way to each anchor."""
    longer = measure(*things, nlos_bias=100.0, range_max=90.0, **overrides)[0]
    return np.floor(longer / 100.0).astype(int).tolist()


def test_ranges_without_errors_are_distances_of_the_antenna() -> None:
    anchors = [[4.0, 0.0], [0.0, 3.0], [-1.0, -1.0]]
    read = measure(anchors=anchors, offset=[0.2, 0.1, 0.0], pose=(1.0, 2.0, math.pi / 2))[0]
    tag = np.array([1.0 - 0.1, 2.0 + 0.2])
    assert read == pytest.approx(np.linalg.norm(np.array(anchors) - tag, axis=1))
    assert np.isnan(measure(range_max=3.9)).all()


def test_each_wall_on_the_way_counts_once() -> None:
    behind = obstacle(parts=[line((5, -1), (5, 1))])
    assert walls(behind) == [0]
    assert walls(behind, obstacle(parts=[line((1, -1), (1, 1))])) == [1]
    assert walls(obstacle(parts=[line((1, -1), (1, 1), (2, 1), (2, -1))])) == [2]
    assert walls(obstacle(parts=[line((1, -1), (1.5, 0), (1, 1))])) == [1]  # through a corner
    assert walls(obstacle(parts=[polygon((1, -1), (2, -1), (2, 1), (1, 1))])) == [1]
    assert walls(obstacle(parts=[circle(0.3)], pose=[2, 0.2, 0])) == [1]
    assert walls(obstacle(parts=[circle(0.3)], pose=[2, 0.31, 0])) == [0]
    assert walls(obstacle(parts=[polygon((3, -1), (6, -1), (6, 1), (3, 1))])) == [1]  # the anchor is inside
    assert walls(obstacle(parts=[line((1, -1), (1, 1))], unobstructed=True)) == [0]
    inside = core.Room(vertices=[(-1, -1), (3, -1), (3, 1), (-1, 1)])
    assert walls(obstacle(parts=[inside]), anchors=[[4.0, 0.0], [2.0, 0.0]]) == [1, 0]


def test_people_on_the_way_count_and_the_carrier_does_not() -> None:
    assert walls(robot(pose=[2.0, 0.0, 0.0], behavior=None)) == [1]
    assert walls() == [0]


def test_walls_of_a_map_count_once_each() -> None:
    cells = np.zeros((40, 10), dtype=np.uint8)
    cells[10:13] = 1
    cells[30] = 1
    grid = core.OccupancyGrid(cells, (0, -0.5), (0.1, 0.1))
    cells_of_map = obstacle(parts=[core.GridCells(grid=grid)])
    assert walls(cells_of_map, pose=(0.05, 0.0, 0.0)) == [2]
    assert walls(cells_of_map, pose=(0.05, 0.0, 0.0), anchors=[[1.15, 0.0], [60.0, 0.0], [60.0, 60.0]]) == [1, 2, 0]


def test_random_lines_cross_what_shapely_says() -> None:
    rng = np.random.default_rng(5)
    for _ in range(60):
        chain = rng.uniform(-3, 3, (6, 2))
        ring = shapely.Polygon(rng.uniform(-3, 3, (4, 2))).convex_hull
        anchors = rng.uniform(-4, 4, (5, 2))
        things = [
            obstacle(parts=[line(*chain.tolist())]),
            obstacle(parts=[polygon(*np.array(ring.exterior.coords)[:-1].tolist())]),
        ]
        expected = []
        for anchor in anchors:
            way = shapely.LineString([(0, 0), anchor])
            edges = [shapely.LineString(chain[k : k + 2]) for k in range(5)]
            expected.append(sum(way.intersects(edge) for edge in edges) + way.intersects(ring))
        assert walls(*things, anchors=anchors.tolist()) == expected


def test_walls_add_a_bias_and_a_spread() -> None:
    count = 20_000
    two = obstacle(parts=[line((1, -1), (1, 1))]), obstacle(parts=[line((2, -1), (2, 1))])
    free = measure(seeds=range(count), std=0.05)[:, 0]
    assert_standard_normal((free - 4.0) / 0.05)
    read = measure(*two, seeds=range(count), std=0.05, nlos_bias=0.3, nlos_std=0.1)[:, 0]
    assert_standard_normal((read - 4.6) / math.sqrt(0.05**2 + 2 * 0.1**2))


def test_ranges_of_one_step_have_errors_of_their_own() -> None:
    read = measure(seeds=range(20_000), std=0.05, anchors=[[4.0, 0.0], [0.0, 4.0]]) - 4.0
    assert abs(np.corrcoef(read.T)[0, 1]) < 4 / math.sqrt(20_000)


def test_outliers_and_dropouts_come_as_often_as_asked_for() -> None:
    read = measure(seeds=range(20_000), outlier_share=0.1, outlier_mean=2.0, dropout=0.05)[:, 0]
    lost = np.isnan(read)
    assert_share(lost, 0.05)
    there = read[~lost] - 4.0
    assert_share(there > 0, 0.1)
    late = there[there > 0]
    assert late.mean() == pytest.approx(2.0, rel=4 / math.sqrt(len(late)))
    assert_share(late > 2.0, math.exp(-1.0))


def test_worlds_of_a_batch_measure_what_they_measure_alone() -> None:
    options = {"std": 0.05, "outlier_share": 0.2, "dropout": 0.2, "anchors": [[4.0, 0.0], [0.0, 3.0]]}
    together = measure(seeds=range(6), **options)
    np.testing.assert_array_equal(together, [measure(seeds=(seed,), **options)[0] for seed in range(6)])
    assert len(np.unique(together)) > 6
