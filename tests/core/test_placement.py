"""Random placement, and crossings of a circle and of a square: room for all objects, or a report."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pytest
import shapely
import shapely.affinity
from hypothesis import strategies as st

import irsim._core as core
from irsim.lookup import lookup
from tests.core import oracle
from tests.core.worlds import circle, obstacle, polygon, random_placement, rectangle, robot, scene
from tests.effort import for_all

SHAPES = [circle(0.4), rectangle(1.2, 0.4), polygon((-0.6, -0.5), (0.6, 0.0), (-0.6, 0.5), (-0.2, 0.0))]


def placement(objects, size: float, min_distance: float = 0.0, attempts: int = 2000) -> core.RandomPlacement:
    return random_placement(
        objects=objects, range_low=[0, 0, -3], range_high=[size, size, 3], min_distance=min_distance, attempts=attempts
    )


@for_all(25, seed=st.integers(0, 2**64 - 1), distance=st.sampled_from([0.0, 1.0]))
def test_nothing_overlaps(seed: int, distance: float) -> None:
    walls = [
        obstacle(pose=[5, 5, 0], parts=[rectangle(8, 0.2)]),
        obstacle(pose=[5, 5, 1.57], parts=[rectangle(8, 0.2)]),
    ]
    random = [robot(parts=[SHAPES[k % 3]]) for k in range(8)]
    blocks = [obstacle(parts=[SHAPES[k % 3]]) for k in range(8)]
    _, state = scene(
        *walls,
        *random,
        *blocks,
        seeds=[seed],
        placements=[placement(range(2, 10), 10, distance), placement(range(10, 18), 10, distance)],
    )
    assert state.failed_placement[0] == -1
    walls_cross = [[0, 1]]
    assert state.collision_pairs(0).tolist() == walls_cross
    for points in (state.pose[2:10, :2], state.pose[10:, :2], state.goal[2:10, :2]):
        gaps = np.linalg.norm(points[:, None] - points, axis=2)[np.triu_indices(8, 1)]
        assert (gaps >= distance).all()
    # goals: clear of what stands still and of each other; static objects have them anywhere
    assert np.isfinite(state.goal[10:]).all()
    parts = [[SHAPES[k % 3]] for k in range(8)]
    goals, poses = state.goal[2:10].tolist(), state.pose.tolist()
    for k in range(8):
        assert not any(core.intersects(parts[k], goals[k], parts[j], goals[j]) for j in range(k))
        assert not any(core.intersects(parts[k], goals[k], parts[j], poses[10 + j]) for j in range(8))
        assert not core.intersects(parts[k], goals[k], [rectangle(8, 0.2)], (5, 5, 0))


def test_draws_are_those_of_the_placement_stream() -> None:
    _, state = scene(robot(), robot(goals=[[7, 7]]), seeds=[5], placements=[placement([0, 1], 10)])
    for i in range(2):
        u = oracle.draws(5, 0, 0, core.STREAMS["placement"], i, 3)
        np.testing.assert_allclose(state.pose[i], np.array([0, 0, -3]) + u * [10, 10, 6])
    assert (state.goal[:, :2] != 7).all()
    assert len(state.goals(0)[0]) == 3


def test_an_object_without_room_is_reported() -> None:
    objects = [robot(parts=[circle(1.0)]) for _ in range(10)]
    _, state = scene(*objects, seeds=[1, 2], placements=[placement(range(10), 3.0)])
    assert (state.failed_placement >= 1).all()
    _, state = scene(*objects, placements=[placement(range(10), 30.0)])
    assert state.failed_placement[0] == -1
    _, state = scene(robot(parts=[circle(0.1)]), obstacle(parts=[rectangle(9, 9)]), placements=[placement([0], 3.0)])
    assert state.failed_placement[0] == 0


def test_distance_without_room_is_reported() -> None:
    _, state = scene(*(robot() for _ in range(5)), placements=[placement(range(5), 3.0, 4.0)])
    assert 0 < state.failed_placement[0] < 5


def test_transparent_things_may_stand_and_end_in_one_place() -> None:
    point = random_placement(objects=[0, 1], range_low=[0] * 3, range_high=[0] * 3, min_distance=0, attempts=10)
    _, state = scene(robot(unobstructed=True), robot(unobstructed=True), placements=[point])
    assert state.failed_placement[0] == -1
    _, state = scene(robot(), robot(), placements=[point])
    assert state.failed_placement[0] == 1


def test_what_is_unobstructed_is_in_nobodys_way() -> None:
    carpet = obstacle(pose=[5, 5, 0], parts=[rectangle(20, 20)], unobstructed=True)
    _, state = scene(carpet, robot(), placements=[placement([1], 10)])
    assert state.failed_placement[0] == -1


def test_thousands_find_room_quickly() -> None:
    _, state = scene(*(obstacle() for _ in range(3000)), placements=[placement(range(3000), 60, 0.45)])
    assert state.failed_placement[0] == -1
    assert len(state.collision_pairs(0)) == 0


def test_a_range_bounds_rear_axles_and_not_the_footprints_of_cars(make) -> None:
    """As the description of `range_low` says: a car reaches (length + wheelbase) / 2 ahead of its position."""
    text = """
world: {width: 40, height: 40}
robot:
  number: 20
  kinematics: {name: acker}
  shape: {name: rectangle, length: 4.6, width: 1.8, wheelbase: 3.0}
  distribution: {name: random, range_low: [10, 10, 0], range_high: [30, 30, 0.001]}
"""
    env = make(text, seed=3)
    places = np.array([robot.state[:2, 0] for robot in env.robot_list])
    fronts = np.array([robot.geometry.bounds[2] for robot in env.robot_list])
    assert ((places >= 10) & (places <= 30)).all()
    np.testing.assert_allclose(fronts - places[:, 0], (4.6 + 3.0) / 2, atol=0.01)
    assert fronts.max() > 30
    said = lookup("robot.distribution.random.range_low").text
    assert "its rear axle" in said
    assert "(length + wheelbase) / 2" in said


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


@pytest.mark.parametrize("place", [on_circle, in_square, lambda objects: placement(objects, 10)])
def test_wanderers_get_a_wander_goal_and_objects_must_exist(place) -> None:
    options = {"wander": True, "range_low": [20, 20, 0], "range_high": [21, 21, 0]}
    _, state = scene(robot(**options), placements=[place([0])])
    assert (state.goal[0, :2] >= 20).all()
    with pytest.raises(ValueError, match="does not exist"):
        scene(robot(), placements=[place([1])])


def test_static_things_cross_as_well() -> None:
    _, state = scene(robot(), obstacle(), placements=[on_circle([0, 1])])
    assert abs(np.linalg.norm(state.pose[:, :2] - [1, 2], axis=1) - 4).max() < 0.75
