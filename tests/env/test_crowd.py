"""The knowledge of objects about all others at once: the same as one by one, and fast."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import pytest
import shapely

from tests.env.driving import Make, take_steps

TEXT = """
world: {width: 20, height: 20, boundary: walls}
robot:
  - {number: 4, kinematics: {name: diff}, distribution: {name: circle, center: [10, 10], radius: 6},
     shape: {name: rectangle, length: 1, width: 0.4}, behavior: {name: dash}}
  - {kinematics: {name: omni}, shape: {name: circle, radius: 0.2, center: [0.1, 0.3]}, state: [5, 3, 0.3],
     goal: [15, 1, 0], behavior: {name: dash}}
  - {kinematics: {name: acker}, shape: {name: rectangle, length: 2, width: 1, wheelbase: 1.2}, state: [3, 16, 0.3, 0.2],
     goal: [15, 16, 0], behavior: {name: dash}}
obstacle:
  - {shape: {name: linestring, vertices: [[7, 7], [8, 8], [9, 7]]}, state: [0, 0, 0.4]}
  - {shape: {name: polygon, vertices: [[0, 0], [1, 0], [1, 1]]}, state: [7, 1, 0.5]}
  - {shape: {name: polygon, random_shape: true}, state: [12, 4, 0.5]}
  - {shape: {name: compound, parts: [{name: circle, radius: 0.2}, {name: rectangle, length: 1, width: 0.2}]},
     state: [3, 7, 0.5], unobstructed: true}
  - {shape: {name: compound, parts: [{name: circle, radius: 0.2}, {name: rectangle, length: 3, width: 0.2,
     pose: [1, 0.4, 0.3]}]}, state: [3.5, 7, 2.5]}
"""


def agree(env: Any) -> None:
    """All at once is as one by one, straight from the geometry."""
    for view in env.objects:
        area = view.geometry.centroid
        np.testing.assert_allclose(view.centroid[:, 0], [area.x, area.y], atol=1e-9)
        others = [other for other in view.external_objects if not other.unobstructed]
        one_by_one = [[*o.centroid[:, 0], *o.velocity_xy[:, 0], o.radius + 0.1] for o in others]
        np.testing.assert_allclose(view.rvo_neighbors, one_by_one, atol=1e-12)
        box = shapely.box(*view.geometry.bounds).buffer(1e-9)
        meets = [other for other in others if box.intersects(shapely.box(*other.geometry.bounds))]
        if "circle" not in {o.shape for o in (view, *meets)}:  # those are polygons to shapely
            assert view.possible_collision_objects == meets


@pytest.fixture
def env(make: Make) -> Any:
    return make(TEXT, seed=3)


def test_all_at_once_is_as_one_by_one(env: Any) -> None:
    agree(env)
    take_steps(env, 5)
    agree(env)
    env.robot_list[0].set_state([3.3, 7, 1])
    env.obstacle_list[1].set_state([8, 2, 1])
    assert env.obstacle_list[4] in env.robot_list[0].possible_collision_objects
    agree(env)
    env.reset(random=True)
    agree(env)
    env.random_polygon_shape()
    agree(env)
    env.delete_object(1)
    env.add_object(env.create_obstacle(shape={"name": "circle", "radius": 0.3}, state=[6, 3, 0]))
    agree(env)


def test_of_an_object_that_is_not_there_yet(env: Any) -> None:
    made = env.create_obstacle(shape={"name": "circle", "radius": 0.3}, state=[3.5, 7, 0])
    expected = [other.rvo_neighbor_state for other in env.objects if not other.unobstructed]
    np.testing.assert_allclose(made.rvo_neighbors, expected, atol=1e-12)
    assert made.possible_collision_objects == [env.obstacle_list[4], env.obstacle_list[-1]]


def test_a_view_with_a_state_of_its_own_counts(env: Any) -> None:
    other = env.robot_list[1]

    class Shifted(type(other)):  # type: ignore[misc]
        @property
        def rvo_neighbor_state(self) -> list[float]:
            return [1.0, 2.0, 3.0, 4.0, 5.0]

    other.__class__ = Shifted
    assert env.robot.rvo_neighbors[0] == [1, 2, 3, 4, 5]


@pytest.mark.parametrize(("name", "most"), [("rvo_neighbors", 0.1), ("possible_collision_objects", 0.05)])
def test_a_hundred_robots_ask(make: Make, name: str, most: float) -> None:
    """2.12 takes about 20 ms and 1 ms; the bounds leave room for slow machines."""
    env = make(
        "robot: {number: 100, kinematics: {name: diff}, distribution: {name: circle, center: [10, 10], radius: 9}, "
        "shape: {name: circle, radius: 0.2}, behavior: {name: dash}}"
    )
    env.step()
    getattr(env.robot, name)
    start = time.process_time()
    for robot in env.robot_list:
        getattr(robot, name)
    assert time.process_time() - start < most
