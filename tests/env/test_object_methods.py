"""Questions of scripts to single objects, between steps."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import shapely

from tests.env.driving import Make, take_steps

TEXT = """
world: {width: 10, height: 10}
robot:
  - {kinematics: {name: diff}, shape: {name: rectangle, length: 1, width: 0.4}, state: [1, 1, 0.3], goal: [1.5, 1, 0],
     vel_max: [2, 0.7], vel_min: [-2, -0.7]}
  - {kinematics: {name: omni}, shape: {name: circle, radius: 0.2, center: [0.1, 0]}, state: [5, 3, 0.3],
     goal: [1.5, 1, 0], vel_max: [2, 0.7], vel_min: [-2, -0.7]}
obstacle:
  - {shape: {name: linestring, vertices: [[7, 7], [8, 8], [9, 7]]}, state: [0, 0, 0]}
  - {shape: {name: polygon, vertices: [[0, 0], [1, 0], [1, 1]]}, state: [7, 1, 0.5]}
  - {shape: {name: compound, parts: [{name: circle, radius: 0.2}, {name: rectangle, length: 1, width: 0.2}]},
     state: [3, 7, 0.5], unobstructed: true}
  - {shape: {name: circle, radius: 0.1}, state: [8, 4, 0]}
"""


@pytest.fixture
def env(make: Make) -> Any:
    return make(TEXT)


def test_what_avoidance_asks(env: Any) -> None:
    diff, omni = env.robot_list
    line, polygon = env.obstacle_list[:2]
    to_goal = np.array([-3.5, -2]) / math.hypot(3.5, 2)
    np.testing.assert_allclose(omni.desired_omni_vel[:, 0], to_goal * [2, 0.7])
    middle = [5 + 0.1 * math.cos(0.3), 3 + 0.1 * math.sin(0.3)]
    np.testing.assert_allclose(omni.rvo_neighbor_state, [*middle, 0, 0, 0.3], atol=1e-12)
    assert (line.rvo_line_segments, polygon.rvo_line_segments) == ([[7, 7, 8, 8], [8, 8, 9, 7]], [])
    assert len(diff.rvo_neighbors) == 4  # not the unobstructed one
    diff.set_goal(None)
    assert diff.desired_omni_vel[:, 0].tolist() == [0, 0]
    np.testing.assert_allclose(diff.vel_world2body([0.5, 1.0])[:, 0], [0.77318845, 0.7])
    with pytest.raises(NotImplementedError):
        line.vel_world2body([1, 0])


def test_convex_inequalities_hold_for_the_vertices(env: Any) -> None:
    for view in (env.robot, env.obstacle_list[1]):
        for (normals, offsets, cone, convex), vertices in (
            (view.get_init_Gh(), view.original_vertices),
            (view.get_Gh(), view.vertices),
        ):
            assert (cone, convex) == ("Rpositive", True)
            assert (normals @ vertices <= offsets + 1e-12).all()
            assert ((normals @ vertices >= offsets - 1e-12).sum(axis=1) == 2).all()
    np.testing.assert_allclose(env.robot_list[1].h, [[0.1], [0], [-0.2]])
    assert env.obstacle_list[0].get_Gh() == (None, None, None, None)
    assert env.obstacle_list[2].get_Gh() == (None, None, None, False)


def test_goals_of_compounds_have_no_outline_and_polygons_are_about_their_centroid(env: Any) -> None:
    polygon, compound = env.obstacle_list[1:3]
    np.testing.assert_allclose(polygon.original_state[:, 0], [2 / 3, 1 / 3, 0])
    assert compound.goal_vertices is None


def test_outlines_of_disks_and_walls(make: Make) -> None:
    env = make(TEXT.replace("height: 10", "height: 10, boundary: walls"))
    disk, walls = env.robot_list[1], env.obstacle_list[-1]
    assert (disk.length, disk.width) == pytest.approx((0.4, 0.4))
    middle = np.array([5, 3]) + 0.1 * np.array([math.cos(0.3), math.sin(0.3)])
    angles = 0.3 - np.arange(64) * math.tau / 64  # clockwise, from its heading on, as in IR-SIM
    around = middle[:, None] + 0.2 * np.array([np.cos(angles), np.sin(angles)])
    np.testing.assert_allclose(disk.vertices, around)
    assert len(disk.geometry.exterior.coords) == 64 + 1
    assert walls.geometry.is_ring
    assert walls.geometry.length == pytest.approx(4 * 10)


@pytest.mark.parametrize("name", ["state", "velocity", "goal", "position", "init_state", "vel_max", "velocity_xy"])
def test_what_is_read_cannot_be_written_into(env: Any, name: str) -> None:
    with pytest.raises(ValueError, match="read-only"):
        getattr(env.robot, name)[0, 0] = 5.0


def test_checks_of_contact(env: Any) -> None:
    robot, disc, ghost = env.robot, env.obstacle_list[3], env.obstacle_list[2]

    def flags() -> tuple[bool, bool]:
        robot.check_status()
        return robot.collision_flag, robot.stop_flag

    assert (robot.possible_collision_objects, robot.check_collision(disc)) == ([], False)
    disc.set_state([1.5, 1.2, 0])
    assert (robot.possible_collision_objects, robot.check_collision(disc)) == ([disc], True)
    assert flags() == (True, True)
    disc.set_state([8, 4, 0])
    ghost.set_state([1, 1, 0])  # unobstructed
    assert flags() == (False, False)
    env.world_param.collision_mode = "unobstructed"
    disc.set_state([1.5, 1.2, 0])
    assert flags() == (True, False)
    env.step()
    assert robot.collision_obj == [disc]


def test_a_check_of_arrival_goes_on_to_the_next_goal(env: Any) -> None:
    robot = env.robot
    robot.set_goal([[1, 1, 0], [8, 8, 0]])
    for _ in range(2):
        robot.check_arrive_status()
        assert (robot.arrive_flag, robot.goal[:, 0].tolist()) == (False, [8, 8, 0])
    robot.set_goal([1, 1, 0])
    robot.check_status()
    assert (robot.arrive_flag, robot.done()) == (True, True)


def test_reset_of_one_object(env: Any) -> None:
    first, second = env.robot_list
    take_steps(env, 3, [[1, 0.2], [0.5, 0.5]])
    elsewhere = second.state
    first.reset()
    assert (first.state[:, 0].tolist(), first.velocity[:, 0].tolist()) == ([1, 1, 0.3], [0, 0])
    assert first.trajectory == []
    np.testing.assert_array_equal(second.state, elsewhere)
    first.set_state()
    first.set_velocity()
    assert first.state[:, 0].tolist() == [0, 0, 0]
    first.remove()
    first.refresh()


def test_sensors_look_again(make: Make) -> None:
    text = TEXT.replace("vel_max: [2, 0.7], vel_min: [-2, -0.7]}", "sensors: [{type: lidar2d, number: 9}]}", 1)
    env = make(text)
    before = env.robot.get_lidar_scan()["ranges"]
    env.obstacle_list[3].set_state([3, 1.6, 0])
    np.testing.assert_array_equal(env.robot.get_lidar_scan()["ranges"], before)
    env.robot.sensor_step()
    assert (env.robot.get_lidar_scan()["ranges"] != before).any()


def test_what_it_belongs_to(env: Any) -> None:
    assert env.robot.world_param is env.world_param
    assert env.robot.env_param is env.env_param
    assert env.robot.logger is env.logger
    made = env.create_robot()
    assert made.logger is None
    env.add_object(made)
    assert made.logger is env.logger
    env.reload()
    assert env.robot.world_param is env.world_param


LIMITS = [[2, 2, -1], [3, 4, 1]]


def test_random_goals_lie_within_their_limits_and_repeat(make: Make) -> None:
    env, again = make(TEXT, seed=3), make(TEXT, seed=3)
    robot = env.robot
    robot.set_random_goal(env.obstacle_list, init=True, range_limits=LIMITS)
    again.robot.set_random_goal(again.obstacle_list, range_limits=LIMITS)
    goal = robot.goal[:, 0]
    assert ((LIMITS[0] <= goal) & (goal <= LIMITS[1])).all()
    np.testing.assert_array_equal(again.robot.goal[:, 0], goal)
    env.reset()
    np.testing.assert_array_equal(robot.goal[:, 0], goal)


def test_random_goals_keep_off_objects(env: Any) -> None:
    robot, disc = env.robot, env.obstacle_list[3]
    robot.set_goal([[1, 1], [2, 2]])
    robot.set_random_goal([])
    assert len(robot.goals) == 2
    disc.set_original_geometry(shapely.box(-10, -10, 1, 1))
    disc.set_state([8, 8, 0])
    for _ in range(20):
        robot.set_random_goal([disc], goal_check_radius=0.1)
        assert not shapely.box(-2, -2, 9, 9).intersects(shapely.Point(*robot.goal[:2, 0]).buffer(0.09))
    robot.set_random_goal([disc], goal_check_radius=100)  # gives up in the end


def test_another_body(env: Any) -> None:
    disc = env.obstacle_list[3]
    disc.set_original_geometry(shapely.Polygon([(-1, -1), (1, -1), (1, 1), (-1, 1)]))
    assert (disc.geometry.bounds, disc.radius) == ((7, 3, 9, 5), pytest.approx(math.sqrt(2)))
    env.robot.set_state([6.5, 4, 0])
    env.refresh()
    assert env.robot.collision_obj == [disc]
    env.reset()
    assert disc.geometry.bounds == (7, 3, 9, 5)
    env.reset(random=True)
    assert disc.radius == pytest.approx(0.1)
    with pytest.raises(ValueError, match="polygons and lines"):
        disc.set_original_geometry(shapely.Point(0, 0))
    with pytest.raises(ValueError, match="empty"):
        disc.set_original_geometry(shapely.Polygon())


def test_static_objects_placed_at_random_have_a_goal(make: Make) -> None:
    text = "obstacle: {number: 2, distribution: {name: random}, shape: {name: circle, radius: 0.1}}"
    goals = [view.goal[:, 0].tolist() for view in make(text, seed=1).objects]
    assert goals[0] != goals[1]
    assert all(0 <= value <= 10 for goal in goals for value in goal[:2])
