"""Distances over a trace, against shapely."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import assume
from hypothesis import strategies as st

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
