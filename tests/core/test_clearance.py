"""Distances: over a trace against shapely, and of room on a lattice, with the widest ways that flooding finds."""

from __future__ import annotations

import bisect
import math
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import assume
from hypothesis import strategies as st
from numpy.typing import NDArray

import irsim._core as core
from tests.core.test_cells import boxes, grids
from tests.core.test_shapes import ORIGIN, POSE, placed, shape
from tests.core.worlds import circle, line, obstacle, polygon, rectangle, robot, scene
from tests.effort import for_all

ROBOT, HUMAN, STATIC, IGNORED = range(4)


def between(a, pose_a, b, pose_b) -> float:
    """Distance between two moving objects, from the kernel."""
    world, state = scene(robot(parts=a), robot(parts=b))
    poses = np.array([[pose_a, pose_b]], dtype=np.float64)
    distance, partner = core.clearances(world, state, 0, poses, [0], np.array([ROBOT, ROBOT], dtype=np.uint8))
    assert partner[0, 0].tolist() == [1, -1, -1]
    assert np.isnan(distance[0, 0, 1:]).all()
    return float(distance[0, 0, 0])


@for_all(100, a=shape(), b=shape(), pose_a=POSE, pose_b=POSE)
def test_apart_as_far_as_shapely_says(a, b, pose_a, pose_b) -> None:
    gap = placed(a[1], pose_a).distance(placed(b[1], pose_b)) - a[2] - b[2]
    distance = between([a[0]], pose_a, [b[0]], pose_b)
    assert distance == pytest.approx(between([b[0]], pose_b, [a[0]], pose_a), abs=1e-12)
    if gap > 1e-9:
        assert distance == pytest.approx(gap, abs=1e-9)
    else:
        assert distance <= 1e-9


@for_all(
    50,
    a=st.lists(shape(), min_size=1, max_size=3),
    b=st.lists(shape(), min_size=1, max_size=3),
    way=st.sampled_from([6.0, 8.0, 11.0]),
    turn=st.floats(-math.pi, math.pi),
)
def test_a_compound_is_as_near_as_its_nearest_part(a, b, way, turn) -> None:
    pose = (way * math.cos(turn), way * math.sin(turn), turn)
    gap = min(ga.distance(placed(gb, pose)) - ra - rb for _, ga, ra in a for _, gb, rb in b)
    assume(gap > 1e-9)
    assert between([p for p, *_ in a], ORIGIN, [p for p, *_ in b], pose) == pytest.approx(gap, abs=1e-9)


@for_all(100, grid=grids(), body=shape(), pose=POSE)
def test_as_far_from_a_map_as_from_its_nearest_cell(grid, body, pose) -> None:
    part, geometry, radius = body
    world, state = scene(robot(parts=[part]), obstacle(parts=[core.GridCells(grid=grid)]))
    kinds = np.array([ROBOT, STATIC], dtype=np.uint8)
    distance, partner = core.clearances(world, state, 0, np.array([[pose, ORIGIN]]), [0], kinds)
    if not grid.count:
        assert math.isnan(distance[0, 0, STATIC])
        assert partner[0, 0, STATIC] == -1
        return
    gap = shapely.union_all(boxes(grid)).distance(placed(geometry, pose)) - radius
    if gap > 1e-9:
        assert distance[0, 0, STATIC] == pytest.approx(gap, abs=1e-9)
    else:
        assert distance[0, 0, STATIC] <= 1e-9


@pytest.mark.parametrize(
    ("a", "b", "at", "depth"),
    [
        (circle(1.0), circle(0.5), (1.2, 0.0, 0.0), 0.3),
        (circle(1.0), rectangle(4.0, 4.0), (2.5, 0.0, 0.0), 0.5),  # its centre is 0.5 m outside
        (circle(0.5), rectangle(4.0, 4.0), (1.5, 0.0, 0.0), 1.0),  # and here 0.5 m inside
        (rectangle(2.0, 1.0), rectangle(4.0, 4.0), (2.75, 0.0, 0.0), 0.25),
        (circle(0.5), line((-1, 0), (1, 0)), (0.0, 0.2, 0.0), 0.3),
        (polygon((0, 0), (1, 0), (0, 1)), line((-1, 0.25), (0.25, 0.25)), (0.0, 0.0, 0.0), 0.25),
    ],
)
def test_depth_of_an_overlap(a, b, at, depth) -> None:
    assert between([a], at, [b], ORIGIN) == pytest.approx(-depth)


def test_inside_a_room_the_walls_are_around() -> None:
    room = core.Room(vertices=[(0, 0), (10, 0), (10, 6), (0, 6)])
    world, state = scene(robot(parts=[circle(0.5)]), obstacle(parts=[room]))
    poses = np.zeros((3, 2, 3))
    poses[:, 0, :2] = (2.0, 3.0), (9.8, 3.0), (11.0, 3.0)
    distance, _ = core.clearances(world, state, 0, poses, [0], np.array([ROBOT, STATIC], dtype=np.uint8))
    assert distance[:, 0, STATIC] == pytest.approx([1.5, -0.3, -1.5])


def naive(poses, radii, robots, kinds) -> tuple[np.ndarray, np.ndarray]:
    """Nearest discs, one pair after the other."""
    distance = np.full((len(poses), len(robots), 3), np.nan)
    partner = np.full((len(poses), len(robots), 3), -1)
    for t, row in enumerate(poses):
        for r, i in enumerate(robots):
            for j, kind in enumerate(kinds):
                if j == i or kind == IGNORED:
                    continue
                away = math.dist(row[i, :2], row[j, :2]) - radii[i] - radii[j]
                if not away >= distance[t, r, kind]:
                    distance[t, r, kind], partner[t, r, kind] = away, j
    return distance, partner


@for_all(60, seed=st.integers(0, 10_000), count=st.integers(1, 12))
def test_the_nearest_of_each_kind(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    kinds = rng.integers(0, 4, count).astype(np.uint8)
    radii = rng.uniform(0.1, 0.6, count)
    poses = np.cumsum(rng.normal(scale=0.5, size=(15, count, 3)), axis=0) + rng.uniform(0, 12, (count, 3))
    still = rng.random(count) < 0.4
    poses[:, still] = poses[0, still]
    make = [obstacle if s else robot for s in still]
    world, state = scene(
        *(new(parts=[circle(r)], pose=pose) for new, r, pose in zip(make, radii, poses[0].tolist(), strict=True))
    )
    robots = list(range(0, count, 2))
    distance, partner = core.clearances(world, state, 0, poses, robots, kinds)
    expected, who = naive(poses, radii, robots, kinds)
    np.testing.assert_allclose(distance, expected, atol=1e-12)
    assert partner.tolist() == who.tolist()


def test_poses_that_are_not_there_have_no_distance() -> None:
    world, state = scene(robot(), robot(), obstacle())
    poses = np.full((2, 3, 3), np.nan)
    poses[0] = (0, 0, 0), (3, 0, 0), (0, 2, 0)
    distance, partner = core.clearances(world, state, 0, poses, [0], np.array([0, 0, 2], dtype=np.uint8))
    assert distance[0, 0, 0] == pytest.approx(2.6)
    assert np.isnan(distance[1]).all()
    assert (partner[1] == -1).all()


def test_arguments_that_do_not_fit() -> None:
    world, state = scene(robot(), robot())
    kinds = np.zeros(2, dtype=np.uint8)
    with pytest.raises(ValueError, match="shape"):
        core.clearances(world, state, 0, np.zeros((1, 3, 3)), [0], kinds)
    with pytest.raises(ValueError, match="entry per object"):
        core.clearances(world, state, 0, np.zeros((1, 2, 3)), [0], np.zeros(3, dtype=np.uint8))
    with pytest.raises(IndexError):
        core.clearances(world, state, 0, np.zeros((1, 2, 3)), [2], kinds)


@for_all(
    60,
    bodies=st.lists(shape(), min_size=2, max_size=5),
    ways=st.lists(st.tuples(POSE, POSE), min_size=5, max_size=5),
    end=st.integers(1, 12),
)
def test_the_least_of_all_rows_is_that_of_the_rows(bodies, ways, end) -> None:
    world, state = scene(*(robot(parts=[part]) for part, *_ in bodies), obstacle(parts=[circle(0.5)]))
    share = np.linspace(0, 1, 12)[:, None]
    moving = [np.array(a) + share * (np.array(b) - np.array(a)) for (a, b), _ in zip(ways, bodies, strict=False)]
    poses = np.ascontiguousarray(np.stack([*moving, np.tile([3.0, 2.0, 0.0], (12, 1))], axis=1))
    kinds = np.array([ROBOT] * len(bodies) + [STATIC], dtype=np.uint8)
    robots = list(range(len(bodies)))
    every, _ = core.clearances(world, state, 0, poses, robots, kinds)
    ends = [end] * len(robots)
    distance, partner, row = core.least_clearances(world, state, 0, poses, robots, kinds, ends)
    for index in robots:
        assert distance[index] == pytest.approx(np.nanmin(every[:end, index]), abs=1e-9)
        assert np.nanmin(every[row[index], index]) == pytest.approx(distance[index], abs=1e-9)
        assert partner[index] not in (index, -1)
    nobody = np.full(len(kinds), IGNORED, dtype=np.uint8)
    assert core.least_clearances(world, state, 0, poses, robots, nobody, ends)[1].tolist() == [-1] * len(robots)


FAR = (-1e6, -1e6, 1e6, 1e6)
NX, NY, H = 60, 50, 0.2
CELLS = ((0.0, 0.0), (H, H), NX, NY)
CENTRES = np.stack(np.meshgrid((np.arange(NX) + 0.5) * H, (np.arange(NY) + 0.5) * H, indexing="ij"), axis=-1)


def random_terrain(seed: int) -> tuple[core.Terrain, Any]:
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
    terrain, union = random_terrain(seed)
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
    clearance = core.Clearance(random_terrain(seed)[0], CELLS)
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


@pytest.mark.parametrize("pose", [[math.nan, 5, 0], [6, math.inf, 0], [6, 5, math.nan]])
def test_things_without_a_place_are_refused(pose: list[float]) -> None:
    with pytest.raises(ValueError, match="finite"):
        core.Terrain(FAR, [([core.Circle(radius=0.5, center=[0, 0])], pose)])
