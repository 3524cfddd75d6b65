"""Metrics of zones and of sight: episodes worked by hand."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.benchmarks.summary import rows_of, summaries_of
from irsim.env import Env
from irsim.metrics import episode_metrics
from irsim.metrics.watching import blocking_objects, goal_visible_ratio
from irsim.scenario.open import read_scenario
from irsim.simulation.simulation import Simulation
from irsim.simulation.trace import past_goals, past_poses, record
from tests.metrics.test_robot_metrics import assert_metrics

KEYS = ("time_in_zone", "zone_crossings", "seen_ratio", "goal_visible_ratio")
# 0.25 m per step of 0.25 s: no rounding errors. It arrives in step 29, at x = 8.25, when the goal is nearer than 0.3 m.
ROOM = """
world: {{width: 12, height: 10, step_time: 0.25{world}}}
robot:
  - {{name: rover, kinematics: {{name: omni}}, shape: {{name: circle, radius: 0.25}}, state: [1, 5, 0], goal: [8.5, 5],
     goal_threshold: 0.3, vel_max: [1, 1], behavior: {{name: dash}}{robot}}}
{rest}
"""
ZONES = (
    ", zones: [{name: box, rectangle: [3, 4, 4, 6]}, {name: door, line: [[6, 4], [6, 6]]}, "
    "{name: back, line: [[7, 6], [7, 4]]}, {name: late, rectangle: [7.75, 4, 12, 6]}, "
    "{name: wide, rectangle: [3.5, 4, 5, 6]}]"
)
CAMERA = (
    "{name: camera, shape: {name: circle, radius: 0.1}, state: [4, 9, -1.5707963], unobstructed: true, "
    "fov: 0.9272952, fov_radius: 9"
)


def text(world: str = "", robot: str = "", rest: str = "") -> str:
    return ROOM.format(world=world, robot=robot, rest=rest)


def measured(scenario: str) -> tuple[Env, Any]:
    env = Env(read_scenario(text=scenario, strict=True)[0], seed=0, headless=True, log_level="ERROR")
    trace = record(env.simulation, 100)
    return env, episode_metrics(trace, env.simulation, env.events)


def test_zones() -> None:
    _, metrics = measured(text(ZONES))
    (rover,) = metrics.robots
    # box: the disc touches it from x = 2.75 (step 7) to 4.25 (step 13), so it is inside for 7 steps of 0.25 s
    assert metrics.zones["box"] == {"time_in_zone": 1.75, "zone_crossings": 1}
    assert metrics.zones["door"] == {"zone_crossings": 1, "left_to_right": 1, "right_to_left": 0}
    assert metrics.zones["back"] == {"zone_crossings": -1, "left_to_right": 0, "right_to_left": 1}
    assert metrics.zones["late"] == {"time_in_zone": 0.75, "zone_crossings": 1}  # until it arrives, three steps later
    assert metrics.zones["wide"] == {"time_in_zone": 2.25, "zone_crossings": 1}
    # box and wide overlap: from step 7 to step 18, when it leaves x = 5.25, and then late
    assert_metrics(rover, time_in_zone=11 * 0.25 + 0.75, zone_crossings=3 + 1 - 1)


def test_a_start_in_a_region_counts_as_time_and_not_as_an_entry() -> None:
    _, metrics = measured(text(", zones: [{name: home, rectangle: [0, 4, 2, 6]}]"))
    assert metrics.zones["home"] == {"time_in_zone": 6 * 0.25, "zone_crossings": 0}


def test_seen() -> None:
    # the camera, 4 m above the path, sees half a radian of atan(1/2) to each side: x from 2 to 6 on the path
    _, metrics = measured(text(rest=f"obstacle:\n  - {CAMERA}}}"))
    (rover,) = metrics.robots
    # the disc meets the edges as long as its centre is less than 0.25 * sqrt(5) / 2 = 0.28 m beyond them
    rows = 1 + (6.25 - 1.75) / 0.25
    assert rover["seen_ratio"] == pytest.approx(rows / 30)


def test_a_wall_hides_from_a_view_with_occlusion_only() -> None:
    wall = "\n  - {shape: {name: rectangle, length: 8, width: 0.2}, state: [4, 7, 0]}"
    for occlusion, seen in (("true", 0.0), ("false", 19 / 30)):
        _, metrics = measured(text(rest=f"obstacle:\n  - {CAMERA}, fov_occlusion: {occlusion}}}{wall}"))
        assert metrics.robots[0]["seen_ratio"] == pytest.approx(seen)


def test_who_has_only_a_lidar_does_not_watch_and_nobody_sees_oneself() -> None:
    scanner = "obstacle:\n  - {state: [5, 8, 0], shape: {name: circle, radius: 0.1}, sensors: [{number: 9}]}"
    assert math.isnan(measured(text(rest=scanner))[1].robots[0]["seen_ratio"])
    alone = measured(text(robot=", fov: 3, fov_radius: 5"))[1].robots[0]
    assert math.isnan(alone["seen_ratio"])


def test_the_goal_is_visible_where_no_static_thing_is_between() -> None:
    screen = (
        "obstacle:\n  - {shape: {name: linestring, vertices: [[4, 5], [4, 9]]}, state: [0, 0, 0], unobstructed: %s}\n"
    )
    moving = "  - {shape: {name: circle, radius: 0.5}, kinematics: {name: omni}, state: [7, 8, 0], goal: [7, 8]}\n"
    collide = ", collision_mode: unobstructed"
    hidden = measured(text(collide, rest=screen % "false" + moving))[1].robots[0]
    # rows 0 to 12 lie at x <= 4, where the line touches the lower end of the screen
    assert hidden["goal_visible_ratio"] == pytest.approx(1 - 13 / 30)
    assert measured(text(collide, rest=screen % "true"))[1].robots[0]["goal_visible_ratio"] == 1.0


def test_maps_and_goals_inside_of_things_block_the_line() -> None:
    walls = ", boundary: walls"
    assert measured(text(walls))[1].robots[0]["goal_visible_ratio"] == 1.0
    inside = "obstacle:\n  - {shape: {name: circle, radius: 0.1}, state: [8.5, 5, 0]}\n"
    assert measured(text(", collision_mode: unobstructed", rest=inside))[1].robots[0]["goal_visible_ratio"] == 0.0
    grid = "world: {width: 10, height: 10, obstacle_map: {name: perlin, resolution: 0.5, fill: 0.3, seed: 1}}\n"
    simulation = Simulation(read_scenario(text=grid, strict=True)[0], [0])
    cells = simulation.state.cells(0)
    assert cells is not None
    i, j = np.argwhere(cells.occupied)[0]
    middle = np.array(cells.origin) + (np.array([i, j]) + 0.5) * np.array(cells.cell)
    goal = np.array([[*middle, math.nan]])
    assert goal_visible_ratio(np.array([[0.01, 0.01]]), goal, simulation, blocking_objects(simulation)) == 0.0


def test_undefined_is_nan_and_none_never_0() -> None:
    _, metrics = measured(text())
    assert [key for key in KEYS if math.isnan(metrics.robots[0][key])] == list(KEYS[:3])
    assert metrics.zones == {}
    lines = measured(text(", zones: [{name: door, line: [[6, 4], [6, 6]]}]"))[1].robots[0]
    assert math.isnan(lines["time_in_zone"])
    assert lines["zone_crossings"] == 1
    result = irsim.run(text=text())
    assert [getattr(result.robots[0], key) for key in KEYS] == [None, None, None, 1.0]
    goalless = "world: {zones: [{name: a, rectangle: [0, 0, 9, 9]}]}\nrobot: {state: [1, 1, 0]}\n"
    assert irsim.run(text=goalless, steps=3).robots[0].goal_visible_ratio is None


def test_a_run_a_benchmark_and_a_trace_say_the_same() -> None:
    scenario = text(ZONES, rest=f"obstacle:\n  - {CAMERA}, fov_occlusion: true}}\n  - {{shape: {{name: rectangle, "
                    "length: 1, width: 0.2}, state: [4, 7, 0]}")  # fmt: skip
    _, metrics = measured(scenario)
    robot = irsim.run(text=scenario).robots[0]
    assert {key: getattr(robot, key) for key in KEYS} == {key: metrics.robots[0][key] for key in KEYS}
    compared = irsim.benchmark(scenario, seeds=1)
    (episode,), (row,) = compared.episodes, compared.rows
    assert {key: episode.metrics[key] for key in KEYS} == {key: metrics.robots[0][key] for key in KEYS}
    assert (row.incidents["seen"], compared.incidents) == (1, ["robots were seen in 1 of 1 episodes (seed 0)"])
    assert episode.zones == metrics.zones
    assert {zone: {key: e.mean for key, e in values.items()} for zone, values in row.zones.items()} == metrics.zones
    rows = summaries_of([episode], compared.scenarios, compared.behaviors)
    assert rows_of(rows, compared.behaviors, compared.random, {})[0].zones == row.zones


def test_a_result_says_what_happened_at_each_zone() -> None:
    walker = (
        "obstacle:\n  - {name: walker, kinematics: {name: omni}, shape: {name: circle, radius: 0.25}, "
        "state: [9, 4.25, 0], goal: [2, 4.25], vel_max: [1, 1], behavior: {name: dash}}"
    )
    result = irsim.run(text=text(", collision_mode: unobstructed" + ZONES, rest=walker))
    door, box = result.zones["door"], result.zones["box"]
    assert (door.objects, door.left_to_right, door.right_to_left) == (2, 1, 1)
    assert (door.entries, door.time_in_zone) == (None, None)
    assert (box.objects, box.names, box.entries) == (2, ["rover", "walker"], 2)
    assert box.time_in_zone == pytest.approx(3.5)
    assert "'door': crossed 2 times" in result.summary
    assert result.robots[0].zone_crossings == 3


# the past of an environment, from which a run knows poses and goals ---------------------------------------------------
STOPS = """
world: {{width: 12, height: 10, collision_mode: {mode}}}
robot:
  - {{kinematics: {{name: diff}}, state: [1, 5, 0], goal: [9, 5], behavior: {{name: dash}}}}
  - {{kinematics: {{name: diff}}, state: [1, 2, 0], waypoints: [[4, 2], [9, 2]], behavior: {{name: dash}}}}
  - {{kinematics: {{name: omni}}, state: [3, 8, 0], behavior: {{name: dash, wander: true}}}}
obstacle:
  - {{shape: {{name: circle, radius: 0.5}}, state: [3, 5, 0]}}
  - {{kinematics: {{name: omni}}, shape: {{name: circle, radius: 0.3}}, state: [6, 8, 0], goal: [6, 0],
     behavior: {{name: dash}}, vel_max: [1, 1]}}
"""


@pytest.mark.parametrize("mode", ["stop", "unobstructed_obstacles", "unobstructed"])
def test_the_past_of_an_environment_is_its_trace_also_where_objects_were_stopped(mode: str) -> None:
    scenario = read_scenario(text=STOPS.format(mode=mode), strict=True)[0]
    env = Env(scenario, seed=1, headless=True, log_level="ERROR")
    trace = record(env.simulation, 140, until_done=False)
    assert trace.stopped.any() == (mode != "unobstructed")
    for row in range(len(trace.names)):
        assert np.array_equal(past_poses(env.simulation, row), trace.pose[:, row])
        if not scenario.objects[row].static:
            assert np.array_equal(past_goals(env.simulation, row), trace.goal[:, row], equal_nan=True)


def test_clearances_are_known_although_one_robot_was_stopped() -> None:
    robots = irsim.run(text=STOPS.format(mode="stop"), seed=1).robots
    assert robots[0].outcome == "collision"
    assert all(robot.min_clearance is not None for robot in robots)


def test_what_a_script_did_to_the_past_is_not_guessed() -> None:
    scenario = read_scenario(text=STOPS.format(mode="unobstructed"), strict=True)[0]
    env = Env(scenario, seed=1, headless=True, log_level="ERROR")
    env.advance(5, until_done=False)
    late = env.create_robot(kinematics={"name": "diff"}, state=[5, 5, 0], goal=[9, 9])
    env.add_object(late)
    env.advance(5, until_done=False)
    assert past_poses(env.simulation, late.row) is None
    assert past_goals(env.simulation, late.row) is None
