"""Observations of policies."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from irsim.policies import Needs, Observations
from irsim.policies.observe import Observer
from irsim.scenario.perturbation import perturbed, read_perturbations
from irsim.simulation.simulation import Simulation
from tests.policies.scenes import scenario, simulation


def observe(made: Simulation, needs: Needs | None = None, rows: Any = None) -> Observations:
    robots = np.flatnonzero(made.robots)
    chosen = (np.arange(made.copies)[:, None] * made.objects + robots).reshape(-1) if rows is None else np.array(rows)
    first = np.zeros(len(chosen), dtype=bool)
    return Observer(made, needs or Needs(), robots).observe(chosen, first, chosen // made.objects)


def test_robots_know_themselves() -> None:
    made = simulation(
        {"kinematics": {"name": "acker", "wheelbase": 1.0}, "state": [1, 2, 0.5, 0.1], "goal": [5, 2],
         "shape": {"name": "circle", "radius": 0.3}, "goal_threshold": 0.25, "vel_max": [2, 0.5],
         "vel_min": [-1, -0.5]},
        {"state": [3, 4, 0.1]},
        seeds=(0, 1), step_time=0.2,
    )  # fmt: skip
    made.step()
    seen = observe(made)
    assert (len(seen), seen.step_time, seen.time.tolist()) == (4, 0.2, [0.2] * 4)
    assert (seen.world.tolist(), seen.robot.tolist()) == ([0, 0, 1, 1], [0, 1, 0, 1])
    assert seen.steering[0] == made.extra[0, 0] != 0.0
    assert seen.steering[1] == 0.0
    np.testing.assert_array_equal(seen.pose[2:], made.pose[2:])
    np.testing.assert_array_equal(seen.velocity, made.twist[:, :2])
    np.testing.assert_array_equal(seen.yaw_rate, made.twist[:, 2])
    np.testing.assert_array_equal(seen.control, made.control)
    np.testing.assert_array_equal(seen.goal[:2], [[5, 2, math.nan], [9, 1, 0]])
    assert seen.goal_threshold.tolist() == [0.25, 0.1] * 2
    assert seen.radius.tolist() == [0.3, 0.2] * 2
    assert (seen.high[0].tolist(), seen.low[0].tolist()) == ([2.0, 0.5, 0.0], [-1.0, -0.5, 0.0])
    assert not seen.arrived.any()
    assert (seen.neighbors, seen.scan, seen.maps) == (None, None, None)


def test_observations_are_copies() -> None:
    made = simulation({})
    seen = observe(made, Needs(neighbors=1))
    before = seen.pose.copy()
    made.step()
    np.testing.assert_array_equal(seen.pose, before)


def test_neighbors_have_true_velocities_flags_and_zeros_where_there_are_none() -> None:
    person = {"kinematics": {"name": "omni"}, "state": [1, 6, 0], "goal": [1, 9, 0], "behavior": {"name": "dash"}}
    made = simulation({}, {"state": [3, 1, 0], "goal": [3.05, 1, 0]}, obstacles=[person])
    made.step()
    seen = observe(made, Needs(neighbors=3), rows=[0]).neighbors
    assert seen.mask.tolist() == [[True, True, False]]
    assert seen.index.tolist() == [[1, 2, -1]]
    np.testing.assert_array_equal(seen.velocity[0, :2], made.twist[[1, 2], :2])
    assert seen.velocity[0, 1, 1] == 1.0
    assert seen.arrived.tolist() == [[True, False, False]]
    assert seen.robot.tolist() == [[True, False, False]]
    assert (seen.position[0, 2].tolist(), seen.radius[0, 2]) == ([0, 0], 0.0)
    np.testing.assert_array_equal(seen.pose[0, :2], made.pose[[1, 2]])
    np.testing.assert_array_equal(np.dstack([seen.position, seen.heading]), seen.pose)


def test_a_neighbor_whose_start_is_delayed_stands() -> None:
    made = simulation({}, {"state": [3, 1, 0], "velocity": [1, 0]})
    made.start_step[1] = 5
    made.step()
    seen = observe(made, Needs(neighbors=1), rows=[0]).neighbors
    assert seen.mask.all()
    assert not seen.velocity.any()


def test_static_neighbors_are_seen_on_request() -> None:
    wall = {"shape": {"name": "rectangle", "length": 0.6, "width": 0.8}, "state": [2, 1, 0]}
    made = simulation({}, obstacles=[wall])
    without, also = (observe(made, Needs(neighbors=1, static_neighbors=flag)).neighbors for flag in (False, True))
    assert (without.mask.tolist(), also.mask.tolist(), also.radius[0, 0]) == ([[False]], [[True]], 0.5)


def test_speed_limits_are_those_of_the_scene() -> None:
    robot = scenario({"kinematics": {"name": "diff"}, "vel_max": [1, 2], "vel_min": [-1, -2]})
    made = Simulation(perturbed(robot, read_perturbations("speed=50%")), [0, 1])
    pace = made.pace.tolist()
    assert pace[0] != pace[1] != 1.0
    seen = observe(made)
    assert seen.high.tolist() == [[one, 2, 0] for one in pace]
    assert seen.low.tolist() == [[-one, -2, 0] for one in pace]


def test_scans_are_those_of_the_first_lidar_in_the_frame_of_the_robot() -> None:
    turned = {"name": "lidar2d", "number": 3, "angle_range": math.pi, "range_max": 4, "offset": [0, 0, 0.5]}
    other = {"name": "lidar2d", "number": 5}
    made = simulation({"sensors": [turned, other]}, {"state": [1, 5, 0], "sensors": [turned]}, seeds=(0, 1))
    scan = observe(made, Needs(scan=True)).scan
    assert scan.range_max == 4.0
    np.testing.assert_allclose(scan.angles, [0.5 - math.pi / 2, 0.5, 0.5 + math.pi / 2])
    ranges = made.ranges.reshape(2, 11)
    np.testing.assert_array_equal(scan.ranges, [ranges[0, :3], ranges[0, 8:], ranges[1, :3], ranges[1, 8:]])


def test_maps_mark_the_cells_that_static_objects_touch() -> None:
    box = {"shape": {"name": "rectangle", "length": 1.8, "width": 0.8}, "state": [5, 2.5, 0]}
    made = simulation({}, obstacles=[box, {**box, "state": [5, 7, 0], "unobstructed": True}], seeds=range(3))
    maps = observe(made, Needs(map=True, map_resolution=1.0)).maps
    assert len(maps) == 3
    assert maps[0] is maps[1] is maps[2]
    assert (maps[0].occupied.shape, maps[0].origin, maps[0].resolution) == ((10, 10), (0.0, 0.0), 1.0)
    assert np.argwhere(maps[0].occupied).tolist() == [[4, 2], [5, 2]]


def test_maps_differ_where_static_objects_do_and_follow_them() -> None:
    crate = {"distribution": {"name": "random", "range_low": [2, 2, 0], "range_high": [8, 8, 0]}, "number": 1}
    made = simulation({}, obstacles=[crate], seeds=(1, 2))
    observer, rows = Observer(made, Needs(map=True), np.flatnonzero(made.robots)), np.array([0, 2])

    def maps() -> Any:
        return observer.observe(rows, rows > 9, rows // 2).maps

    before = maps()
    assert not np.array_equal(before[0].occupied, before[1].occupied)
    made.step()
    assert maps()[0] is before[0]
    made.reset(np.array([True, False]), next_scene=True)
    after = maps()
    assert after[1] is before[1]
    assert not np.array_equal(after[0].occupied, before[0].occupied)
