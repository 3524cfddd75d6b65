"""Random placement: room for all objects, or a report."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import irsim
import irsim._core as core
from irsim.lookup import lookup
from tests.core import oracle
from tests.core.worlds import circle, obstacle, polygon, random_placement, rectangle, robot, scene
from tests.effort import examples

SHAPES = [circle(0.4), rectangle(1.2, 0.4), polygon((-0.6, -0.5), (0.6, 0.0), (-0.6, 0.5), (-0.2, 0.0))]


def placement(objects, size: float, min_distance: float = 0.0, attempts: int = 2000) -> core.RandomPlacement:
    return random_placement(
        objects=objects, range_low=[0, 0, -3], range_high=[size, size, 3], min_distance=min_distance, attempts=attempts
    )


@settings(max_examples=examples(25))
@given(seed=st.integers(0, 2**64 - 1), distance=st.sampled_from([0.0, 1.0]))
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


def test_wanderers_get_a_wander_goal() -> None:
    options = {"wander": True, "range_low": [20, 20, 0], "range_high": [21, 21, 0]}
    _, state = scene(robot(**options), placements=[placement([0], 10)])
    assert (state.goal[0, :2] >= 20).all()


def test_a_placement_names_objects_that_exist() -> None:
    with pytest.raises(ValueError, match="does not exist"):
        scene(robot(), placements=[placement([1], 10)])


def test_a_range_bounds_rear_axles_and_not_the_footprints_of_cars(tmp_path: Path) -> None:
    """As the description of `range_low` says: a car reaches (length + wheelbase) / 2 ahead of its position."""
    text = """
world: {width: 40, height: 40}
robot:
  number: 20
  kinematics: {name: acker}
  shape: {name: rectangle, length: 4.6, width: 1.8, wheelbase: 3.0}
  distribution: {name: random, range_low: [10, 10, 0], range_high: [30, 30, 0.001]}
"""
    (tmp_path / "cars.yaml").write_text(text, encoding="utf-8")
    env = irsim.make(tmp_path / "cars.yaml", seed=3, headless=True)
    places = np.array([robot.state[:2, 0] for robot in env.robot_list])
    fronts = np.array([robot.geometry.bounds[2] for robot in env.robot_list])
    env.end(ending_time=0.0)
    assert ((places >= 10) & (places <= 30)).all()
    np.testing.assert_allclose(fronts - places[:, 0], (4.6 + 3.0) / 2, atol=0.01)
    assert fronts.max() > 30
    said = lookup("robot.distribution.random.range_low").text
    assert "its rear axle" in said
    assert "(length + wheelbase) / 2" in said
