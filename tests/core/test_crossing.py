"""Crossings of a circle and of a square: where objects start and end, and the distances that they keep."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pytest
import shapely
import shapely.affinity

import irsim._core as core
from tests.core import oracle
from tests.core.worlds import circle, obstacle, polygon, random_placement, rectangle, robot, scene

SEEDS = (0, 1, 2, 3)
TRIANGLE = ((-0.4, -0.3), (0.5, 0.0), (-0.4, 0.3))


def on_circle(objects: Sequence[int], **keys: float) -> core.CircleCrossing:
    options = {"radius": 4.0, "noise": 0.5, "clearance": 0.2, "attempts": 1000} | keys
    return core.CircleCrossing(objects=objects, center=[1.0, 2.0], **options)


def in_square(objects: Sequence[int], **keys: float) -> core.SquareCrossing:
    options = {"width": 10.0, "clearance": 0.2, "attempts": 1000} | keys
    return core.SquareCrossing(objects=objects, center=[1.0, 2.0], **options)


def people(count: int, radius: float = 0.3) -> list[core.ObjectSpec]:
    return [robot(parts=[circle(radius)]) for _ in range(count)]


def random_draws(seed: int, index: int) -> np.ndarray:
    return oracle.draws(seed, 0, 0, core.STREAMS["placement"], index, 3)


def test_a_start_is_near_the_circle_and_its_goal_is_opposite() -> None:
    for seed in SEEDS:
        _, state = scene(robot(), seeds=[seed], placements=[on_circle([0])])
        u = random_draws(seed, 0)
        offset = 4 * np.array([math.cos(2 * math.pi * u[0]), math.sin(2 * math.pi * u[0])]) + (u[1:] - 0.5)
        heading = math.atan2(-offset[1], -offset[0])
        np.testing.assert_allclose(state.pose[0], [1 + offset[0], 2 + offset[1], heading], atol=1e-12)
        np.testing.assert_allclose(state.goal[0], [1 - offset[0], 2 - offset[1], heading], atol=1e-12)


def test_starts_and_goals_in_a_square_are_on_opposite_sides() -> None:
    sides = []
    for seed in range(20):
        _, state = scene(robot(), seeds=[seed], placements=[in_square([0])])
        u = random_draws(seed, 0)
        start, goal = state.pose[0] - [1, 2, 0], state.goal[0] - [1, 2, 0]
        sides.append(np.sign(start[0]))
        np.testing.assert_allclose(start[:2], [sides[-1] * 5 * u[0], 10 * (u[1] - 0.5)], atol=1e-12)
        assert np.sign(goal[0]) == -sides[-1]
        assert abs(goal[:2]).max() <= 5
        assert math.cos(state.pose[0, 2]) == pytest.approx(-sides[-1])  # it faces the other side
    assert -1 in sides
    assert 1 in sides


@pytest.mark.parametrize("place", [on_circle, in_square])
def test_everybody_keeps_the_distance(place) -> None:
    first, second = range(1, 7), range(7, 11)
    for seed in SEEDS:
        _, state = scene(
            robot(pose=[1, -2, 1.57], goals=[[1, 6]], parts=[circle(0.3)]),
            *people(10),
            seeds=[seed],
            placements=[place(first), place(second)],
        )
        assert state.failed_placement[0] == -1
        starts, goals = state.pose[:, :2], state.goal[:, :2]
        pairs = np.triu_indices(11, 1)
        for points in (starts, goals):
            assert np.linalg.norm(points[:, None] - points, axis=2)[pairs].min() >= 0.8
        if place is on_circle:
            across = np.linalg.norm(starts[:, None] - goals, axis=2)[pairs]
            assert across.min() >= 0.8


def test_polygons_keep_the_distance_of_their_surfaces() -> None:
    bodies = [robot(parts=[polygon(*TRIANGLE)]) for _ in range(8)]
    wall = obstacle(pose=[1, 4, 0], parts=[rectangle(4, 3)])
    for seed in SEEDS:
        _, state = scene(*bodies, wall, seeds=[seed], placements=[on_circle(range(8), clearance=0.3)])
        assert state.failed_placement[0] == -1

        def body(pose: np.ndarray) -> shapely.Polygon:
            turned = shapely.affinity.rotate(shapely.Polygon(TRIANGLE), pose[2], (0, 0), use_radians=True)
            return shapely.affinity.translate(turned, pose[0], pose[1])

        block = shapely.box(-1, 2.5, 3, 5.5)
        ends = [(body(start), body(goal)) for start, goal in zip(state.pose[:8], state.goal[:8], strict=True)]
        for k, mine in enumerate(ends):
            others = [block, *(shape for other in ends[:k] for shape in other)]
            assert min(shape.distance(other) for shape in mine for other in others) >= 0.3 - 1e-9


def test_more_people_start_where_fewer_did() -> None:
    for place in (on_circle, in_square):
        few, many = (scene(*people(n), seeds=SEEDS, placements=[place(range(n))])[1] for n in (5, 10))
        for w in range(len(SEEDS)):
            np.testing.assert_array_equal(few.pose[5 * w : 5 * w + 5], many.pose[10 * w : 10 * w + 5])
            np.testing.assert_array_equal(few.goal[5 * w : 5 * w + 5], many.goal[10 * w : 10 * w + 5])


def test_things_placed_at_random_afterwards_stand_on_no_goal() -> None:
    blocks = [obstacle(parts=[circle(0.5)]) for _ in range(25)]
    low, high = [-4, -3, 0], [6, 7, 0]
    block = random_placement(objects=range(6, 31), range_low=low, range_high=high, min_distance=0.0, attempts=1000)
    for seed in SEEDS:
        _, state = scene(*people(6), *blocks, seeds=[seed], placements=[in_square(range(6)), block])
        assert state.failed_placement[0] == -1
        gaps = np.linalg.norm(state.goal[:6, None, :2] - state.pose[None, 6:, :2], axis=2)
        assert gaps.min() > 0.8


@pytest.mark.parametrize("place", [on_circle, in_square])
def test_who_has_no_room_is_reported(place) -> None:
    for keys in ({"attempts": 1}, {"clearance": 3.0, "attempts": 50}):
        _, state = scene(*people(40), seeds=SEEDS, placements=[place(range(40), **keys)])
        assert (state.failed_placement > 0).all()
    if place is on_circle:
        _, state = scene(*people(2, radius=4.2), placements=[place(range(2))])
        assert state.failed_placement[0] == 1
    carpets = [robot(unobstructed=True) for _ in range(40)]
    _, state = scene(*carpets, placements=[place(range(40), clearance=3.0)])
    assert state.failed_placement[0] == -1


def test_wanderers_and_static_things_cross_as_well() -> None:
    options = {"wander": True, "range_low": [20, 20, 0], "range_high": [21, 21, 0]}
    _, state = scene(robot(**options), obstacle(), placements=[on_circle([0, 1])])
    assert (state.goal[0, :2] >= 20).all()
    offset = np.linalg.norm(state.pose[:, :2] - [1, 2], axis=1)
    assert ((offset > 4 - 0.75) & (offset < 4 + 0.75)).all()


def test_a_crossing_names_objects_that_exist() -> None:
    with pytest.raises(ValueError, match="does not exist"):
        scene(robot(), placements=[on_circle([1])])
