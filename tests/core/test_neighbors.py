"""Who is near, and which walls: against looking at everything; functions of the core for policies."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import strategies as st

import irsim._core as core
from tests.core.oracle import rotation
from tests.core.worlds import DASH, DRIVES, PI, circle, line, obstacle, polygon, rectangle, robot, scene
from tests.effort import for_all


def crowd(seed: int, count: int, size: float) -> tuple[core.World, core.State]:
    rng = np.random.default_rng(seed)
    objects = []
    for _ in range(count):
        pose = [*rng.uniform(0, size, 2), rng.uniform(-3, 3)]
        kind = rng.integers(5)
        if kind == 0:
            objects.append(obstacle(pose=pose, parts=[circle(0.3, (0.2, 0.1))]))
        elif kind == 1:
            objects.append(obstacle(pose=pose, parts=[rectangle(1.0, 0.5)]))
        elif kind == 2:
            objects.append(robot(pose=pose, parts=[polygon((0, 0), (1, 0), (0, 0.5))], drive=DRIVES["omni"]))
        elif kind == 3:
            objects.append(robot(pose=pose, parts=[line((0, 0), (1, 0))]))
        else:
            objects.append(robot(pose=pose, drive=list(DRIVES.values())[rng.integers(5)], control=[0.4, 0.3, 0.2]))
    return scene(*objects, mode=1)


@pytest.mark.parametrize("count", [1, 12, 60, 300])
@pytest.mark.parametrize("reach", [0.7, 3.0, 11.0, math.inf])
def test_neighbors_are_those_within_reach(count: int, reach: float) -> None:
    world, state = crowd(count, count, 20.0)
    everyone = core.neighbors(world, state, 0, (10.0, 10.0), 1e9)
    seen = {row[0]: np.array(row[1:3]) for row in everyone}
    walls = {row[4] for row in core.walls(world, state, 0, (10.0, 10.0), 1e9)}
    lines = {row for row in range(count) if state.parts(row)[0] == "linestring"}
    assert set(seen) == set(range(count)) - walls - lines
    rng = np.random.default_rng(1)
    # the centre of the bounding circle of a right triangle is the middle of its long side, not its centroid
    bounds = {}
    for row, centroid in seen.items():
        if state.parts(row)[0] == "polygon":
            pose = state.pose[row]
            bounds[row] = pose[:2] + rotation(pose[2]) @ (0.5, 0.25)
            np.testing.assert_allclose(centroid, pose[:2] + rotation(pose[2]) @ (1 / 3, 0.5 / 3), atol=1e-12)
        else:
            x, y, _ = state.circle(row, 0, True)
            bounds[row] = np.array([x, y])
            np.testing.assert_allclose(centroid, (x, y), atol=1e-12)
    for _ in range(20):
        centre = rng.uniform(-3, 23, 2)
        rows = [row[0] for row in core.neighbors(world, state, 0, tuple(centre), reach)]
        assert rows == sorted(r for r, at in bounds.items() if math.dist(at, centre) <= reach)


def test_velocities_are_of_the_present_command_and_pose() -> None:
    world, state = scene(
        *(
            robot(drive=drive, pose=[3.0 * k, 0.0, 0.5 * k], control=[0.4, 0.3, 0.2])
            for k, drive in enumerate(DRIVES.values())
        )
    )
    for row, _, _, *velocity, radius in core.neighbors(world, state, 0, (0.0, 0.0), 100.0):
        np.testing.assert_allclose(velocity, state.velocity_world(row), atol=1e-15)
        assert radius == 0.2


def test_far_away_and_broken_positions_do_no_harm() -> None:
    world, state = scene(*(robot(pose=[0.1 * k, 0.0, 0.0]) for k in range(80)), mode=1)
    state.pose[3, 0] = 1e300
    state.pose[4, 0] = math.nan
    state.pose[5, 1] = -math.inf
    rows = [row[0] for row in core.neighbors(world, state, 0, (0.0, 0.0), 1.0)]
    assert rows == [0, 1, 2, *range(6, 11)]


def test_outlines_run_counter_clockwise_whatever_way_they_are_written() -> None:
    corners = [(0, 0), (2, 0), (2, 1), (1, 2)]
    for vertices in (corners, corners[::-1]):
        world, state = scene(obstacle(pose=[1.0, 2.0, 0.6], parts=[polygon(*vertices)]))
        rows = core.walls(world, state, 0, (0.0, 0.0), 100.0)
        assert len(rows) == 4
        a, b = np.array([row[:2] for row in rows]), np.array([row[2:4] for row in rows])
        area = 0.5 * np.sum(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
        assert area == pytest.approx(2.5)
        for k, row in enumerate(rows):
            assert rows[row[5]][:2] == row[2:4]
            assert rows[row[6]][2:4] == row[:2]
            assert row[4] == 0
            assert rows[rows[k][5]][6] == k


def test_what_is_a_wall_and_what_is_not() -> None:
    world, state = scene(
        obstacle(parts=[rectangle(1, 1)]),
        obstacle(parts=[rectangle(1, 1)], unobstructed=True),
        obstacle(parts=[circle()]),
        obstacle(parts=[line((0, 0), (1, 0), (1, 1))], unobstructed=True),
        obstacle(parts=[rectangle(1, 1), circle(0.5, (1.0, 0.0))]),
        robot(parts=[rectangle(1, 1)]),
        mode=1,
    )
    walls = core.walls(world, state, 0, (0.0, 0.0), 100.0)
    assert [row[4] for row in walls] == [0] * 4 + [3] * 4 + [4] * 21  # one outline
    there = [(0.0, 0.0, 1.0, 0.0, 3, 5, 7), (1.0, 0.0, 1.0, 1.0, 3, 6, 4)]
    back = [(1.0, 1.0, 1.0, 0.0, 3, 7, 5), (1.0, 0.0, 0.0, 0.0, 3, 4, 6)]
    assert walls[4:8] == there + back
    assert [row[0] for row in core.neighbors(world, state, 0, (0.0, 0.0), 100.0)] == [2, 5]


@for_all(30, seed=st.integers(0, 10**6), reach=st.floats(0.1, 8.0))
def test_walls_within_reach(seed: int, reach: float) -> None:
    rng = np.random.default_rng(seed)
    world, state = scene(
        *(
            obstacle(pose=[*rng.uniform(0, 30, 2), rng.uniform(-3, 3)], parts=[rectangle(rng.uniform(0.2, 9), 0.4)])
            for _ in range(40)
        ),
        mode=1,
    )
    everything = core.walls(world, state, 0, (0.0, 0.0), math.inf)
    assert len(everything) == 160
    centre = rng.uniform(0, 30, 2)
    near = []
    for row in everything:
        a, b = np.array(row[:2]), np.array(row[2:4])
        t = np.clip((centre - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
        if np.hypot(*(a + t * (b - a) - centre)) <= reach:
            near.append(row)
    assert core.walls(world, state, 0, tuple(centre), reach) == near


@pytest.mark.parametrize("drive", ["diff", "omni", "omni_angular", "angular"])
def test_rows_follow_velocities_as_single_objects_do(drive: str) -> None:
    world, state = scene(*(robot(drive=DRIVES[drive], pose=[i, 0, 0.3 * i]) for i in range(3)), seeds=(0, 1))
    rows, velocities = np.array([4, 1]), np.array([[0.3, 0.4], [-0.5, 0.1]])
    core.follow_rows(world, state, rows, velocities)
    for row, velocity in zip(rows.tolist(), velocities, strict=True):
        assert state.command[row].tolist() == list(core.follow(world, state, row, tuple(velocity)))
    assert not state.command[[0, 2, 3, 5]].any()
    assert not state.given.any()


def test_following_a_velocity_turns_to_the_heading_of_the_goal_as_behaviors_do() -> None:
    options = {"drive": DRIVES["omni_angular"], "goals": [[0.0, 0.0, 1.0]], "arrive_mode": 1, "behavior": DASH}
    world, state = scene(robot(**options))
    core.follow_rows(world, state, np.array([0]), np.zeros((1, 2)))
    assert state.command.tolist() == [[0.0, 0.0, 10.0]]  # 1 rad in one period; limits cut it


def test_bounding_circles_are_those_of_the_placed_shapes() -> None:
    rear = robot(parts=[rectangle(2.0, 1.0)], pose=[1.0, 2.0, PI / 2])
    world, state = scene(robot(parts=[circle(0.2, (1.0, 0.0))], pose=[1.0, 2.0, PI / 2]), rear)
    circles = core.bounding_circles(world, state)
    np.testing.assert_allclose(circles, [[1.0, 3.0, 0.2], [1.0, 2.0, math.sqrt(1.25)]], atol=1e-12)


def test_extents_are_how_far_footprints_reach_toward_each_other() -> None:
    long_one = robot(parts=[rectangle(2.0, 1.0)])
    across = robot(parts=[rectangle(0.6, 0.4)], pose=[0.0, 4.0, 0.0])
    ahead = robot(parts=[circle(0.3)], pose=[3.0, 0.0, 0.5])
    world, state = scene(long_one, across, ahead)
    none = [0] * 3
    looking = core.Looking(2, math.inf, False, True, steered=none, first_beam=none, beams=0, range_max=0.0)
    columns = core.find_neighbors(world, state, looking, np.array([0]))
    index, extent, own_extent = columns[1], columns[8], columns[9]
    assert index.tolist() == [[2, 1]]
    np.testing.assert_allclose(extent, [[0.3, 0.2]], atol=1e-12)
    np.testing.assert_allclose(own_extent, [[1.0, 0.5]], atol=1e-12)


def nearest_of(
    world: core.World, state: core.State, rows: list[int], most: int, reach: float, statics: bool
) -> list[list[int]]:
    """Indices of the nearest objects of rows."""
    none = [0] * world.objects
    looking = core.Looking(most, reach, statics, extents=False, steered=none, first_beam=none, beams=0, range_max=0.0)
    return core.find_neighbors(world, state, looking, np.array(rows))[1].tolist()


def test_nearest_objects_are_sorted_by_gap_then_index() -> None:
    things = [
        robot(),
        robot(pose=[2.0, 0.0, 0.0]),  # gap 1.6
        robot(pose=[2.0, 2.0, 0.0], role=1, parts=[circle(2.0)]),  # gap 0.63, though its center is farther away
        robot(pose=[0.0, 2.0, 0.0]),  # gap 1.6
        obstacle(pose=[0.0, -0.5, 0.0]),  # gap 0.1
        obstacle(pose=[0.0, -0.5, 0.0], unobstructed=True),
    ]
    world, state = scene(*things, seeds=(0, 1))

    def nearest(most: int, reach: float = math.inf, statics: bool = False) -> list[list[int]]:
        return nearest_of(world, state, [0, 6], most, reach, statics)

    assert nearest(4) == [[2, 1, 3, -1]] * 2
    assert nearest(2) == [[2, 1]] * 2
    assert nearest(2, statics=True) == [[4, 2]] * 2
    assert nearest(3, reach=1.0) == [[2, -1, -1]] * 2
    assert nearest(0) == [[], []]


def test_nearest_objects_are_of_the_role_that_a_robot_targets() -> None:
    others = [robot(pose=[1.0, 0.0, 0.0]), robot(pose=[2.0, 0.0, 0.0], role=1)]
    for roles, expected in ((0, [1, 2]), (1, [1, -1]), (2, [2, -1])):
        world, state = scene(robot(target_roles=roles), *others)
        assert nearest_of(world, state, [0], 2, math.inf, False) == [expected]


def test_gaps_are_those_between_footprints() -> None:
    things = [
        robot(),  # radius 0.2
        robot(pose=[1.0, 0.0, 0.0]),
        obstacle(pose=[0.0, 1.0, 0.0], parts=[rectangle(4.0, 0.5)]),
        obstacle(pose=[0.0, 0.0, 0.0], unobstructed=True),
    ]
    world, state = scene(*things, seeds=(0, 1))
    kinds = np.array([0, 0, 2, 3], dtype=np.uint8)
    far = core.gaps(world, state, np.array([0, 5]), kinds, math.inf)
    np.testing.assert_allclose(far, [[0.6, math.inf, 0.55], [0.6, math.inf, 0.55]], atol=1e-12)
    near = core.gaps(world, state, np.array([0]), kinds, 0.58, threads=2)
    np.testing.assert_allclose(near, [[math.inf, math.inf, 0.55]], atol=1e-12)
    state.pose[0] = [0.75, 0.0, 0.0]
    state.refresh()
    assert core.gaps(world, state, np.array([0]), kinds, 1.0)[0, 0] == pytest.approx(-0.15)


def test_wrong_rows_are_refused() -> None:
    world, state = scene(robot())
    with pytest.raises(IndexError, match="no such row"):
        core.follow_rows(world, state, np.array([1]), np.zeros((1, 2)))
    with pytest.raises(ValueError, match="one velocity per row"):
        core.follow_rows(world, state, np.array([0]), np.zeros((2, 2)))
