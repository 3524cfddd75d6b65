"""Room on a lattice: distances against shapely, widest ways against flooding."""

from __future__ import annotations

import bisect
import math
from typing import Any

import numpy as np
import pytest
import shapely
from numpy.typing import NDArray

import irsim._core as core

FAR = (-1e6, -1e6, 1e6, 1e6)
NX, NY, H = 60, 50, 0.2
CELLS = ((0.0, 0.0), (H, H), NX, NY)
CENTRES = np.stack(np.meshgrid((np.arange(NX) + 0.5) * H, (np.arange(NY) + 0.5) * H, indexing="ij"), axis=-1)


def scene(seed: int) -> tuple[core.Terrain, Any]:
    """Some things of each kind, and their union."""
    rng = np.random.default_rng(seed)
    things: list[Any] = []
    shapes: list[Any] = []
    for _ in range(5):
        x, y, r = rng.uniform(0, 12), rng.uniform(0, 10), rng.uniform(0.02, 1.2)
        things.append(([core.Circle(radius=r, center=[0, 0])], [x, y, 1.0]))
        shapes.append(shapely.Point(x, y).buffer(r, quad_segs=256))
        corners = rng.uniform(-1.5, 1.5, (3, 2)) + rng.uniform(0, 10, 2)
        things.append(([core.Polygon(vertices=corners.tolist())], [0, 0, 0]))
        shapes.append(shapely.Polygon(corners))
        line = rng.uniform(-1, 13, (3, 2))
        things.append(([core.Linestring(vertices=line.tolist())], [0, 0, 0]))
        shapes.append(shapely.LineString(line))
    occupied = (rng.random((24, 20)) < 0.02).astype(np.uint8)
    things.append(([core.GridCells(grid=core.OccupancyGrid(occupied, (0, 0), (0.5, 0.5)))], [0, 0, 0]))
    shapes += [shapely.box(i * 0.5, j * 0.5, i * 0.5 + 0.5, j * 0.5 + 0.5) for i, j in np.argwhere(occupied)]
    return core.Terrain(FAR, things), shapely.union_all(shapes)


def components(open_cells: NDArray[np.bool_]) -> NDArray[np.int_]:
    """Number of the component of each open cell, eight neighbours; -1 where closed."""
    label = np.where(open_cells, np.arange(open_cells.size).reshape(open_cells.shape), -1)
    while True:
        padded = np.pad(label, 1, constant_values=-1)
        best = np.max([padded[i : i + NX, j : j + NY] for i in range(3) for j in range(3)], axis=0)
        grown = np.where(open_cells, best, -1)
        if (grown == label).all():
            return label
        label = grown


@pytest.mark.parametrize("seed", range(6))
def test_distances_are_those_of_shapely(seed: int) -> None:
    terrain, union = scene(seed)
    distance = core.Clearance(terrain, CELLS).distance
    points = shapely.points(CENTRES)
    inside = shapely.contains(union, points)
    truth = np.where(inside, 0.0, shapely.distance(union, points))
    border = np.minimum(CENTRES, np.array([NX, NY]) * H - CENTRES).min(axis=-1)
    off = (distance - truth)[truth <= border]  # what lies outside of the cells is not seen
    assert off.min() > -2e-3  # shapely's circles are polygons
    assert off.max() < 0.25 * H
    assert np.mean(np.abs(off) > 2e-3) < 0.01


def joined_at(distance: np.ndarray, level: float, a: np.ndarray, b: np.ndarray) -> bool:
    """Whether cells with at least this distance join the cells (a[0], b[0]) and (a[1], b[1])."""
    label = components(distance >= level)
    return bool(label[a[0], b[0]] == label[a[1], b[1]] >= 0)


@pytest.mark.parametrize("seed", range(4))
def test_widest_ways_are_those_of_flooding(seed: int) -> None:
    clearance = core.Clearance(scene(seed)[0], CELLS)
    distance = clearance.distance
    rng = np.random.default_rng(seed + 100)
    for _ in range(10):
        a, b = rng.integers(0, NX, 2), rng.integers(0, NY, 2)
        start, goal = CENTRES[a[0], b[0]], CENTRES[a[1], b[1]]
        room, x, y = clearance.widest(start, goal, 0.0)
        if min(distance[a[0], b[0]], distance[a[1], b[1]]) <= 0:
            continue
        levels = np.unique(distance[distance > 0])
        levels = levels[:: max(1, len(levels) // 60)]
        # Places joined at a level are joined at every lower one.
        apart = bisect.bisect_left(range(len(levels)), True, key=lambda i: not joined_at(distance, levels[i], a, b))
        if math.isinf(room):
            assert apart == 0
            continue
        label = components(distance >= room)
        assert label[a[0], b[0]] == label[a[1], b[1]] >= 0
        assert apart == 0 or levels[apart - 1] <= room
        assert distance[int(x / H), int(y / H)] == pytest.approx(room)


def wall_with_gap(width: float) -> core.Terrain:
    low, high = 5 - width / 2, 5 + width / 2
    walls = [[[5.9, -1], [6.1, -1], [6.1, low], [5.9, low]], [[5.9, high], [6.1, high], [6.1, 11], [5.9, 11]]]
    return core.Terrain(FAR, [([core.Polygon(vertices=wall)], [0, 0, 0]) for wall in walls])


def test_a_gap() -> None:
    clearance = core.Clearance(wall_with_gap(1.0), CELLS)
    room, x, y = clearance.widest([1, 5], [11, 5], 0.0)
    assert 0.5 - H <= room <= 0.5 + 1e-6
    assert (x, y) == pytest.approx((6, 5), abs=H)
    way = clearance.way([1, 1], [11, 1], 0.3)
    assert np.hypot(*np.diff(way, axis=0).T).max() <= H * math.sqrt(2) + 1e-9
    assert np.abs(way[np.abs(way[:, 0] - 6) < 0.1, 1] - 5).max() < 0.5
    assert len(clearance.way([1, 1], [11, 1], 0.6)) == 0
    assert clearance.distance[int(11 / H), 25] >= clearance.distance[int(7 / H), 25]
    assert clearance.climb([6.4, 2.0], 1.0)[0] > 7.0


def test_closed_off_and_wide_open() -> None:
    closed = core.Clearance(wall_with_gap(-0.1), CELLS)
    assert closed.widest([1, 5], [11, 5], 0.0)[0] == -math.inf
    empty = core.Clearance(core.Terrain(FAR, []), CELLS)
    assert np.isinf(empty.distance).all()
    assert empty.widest([1, 5], [11, 5], 0.0)[0] == math.inf


def test_a_goal_within_reach_counts() -> None:
    clearance = core.Clearance(core.Terrain(FAR, [([core.Circle(radius=0.5, center=[0, 0])], [9, 5, 0])]), CELLS)
    assert clearance.widest([1, 5], [9, 5], 0.0)[0] == -math.inf
    assert clearance.widest([1, 5], [9, 5], 1.0)[0] == pytest.approx(0.5, abs=H)


def test_outside_a_room_is_solid() -> None:
    room = core.Room(vertices=[[2, 2], [2, 8], [10, 8], [10, 2]])
    distance = core.Clearance(core.Terrain(FAR, [([room], [0, 0, 0])]), CELLS).distance
    assert distance[0, 0] == 0
    assert distance[30, 25] == pytest.approx(2.9, abs=1e-6)
