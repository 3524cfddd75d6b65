"""Functions of the core for policies: following velocities, bounding circles, nearest objects."""

from __future__ import annotations

import math

import numpy as np
import pytest

import irsim._core as core
from tests.core.worlds import DASH, DRIVES, PI, circle, obstacle, rectangle, robot, scene


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
