"""`within` of `follow`: a region that the path does not leave."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import irsim

Make = Callable[..., Any]
# a corridor along x, open at both ends, and closed in the middle but for a detour around its outside
TEXT = """
world: {{width: 20, height: 12}}
robot: {{kinematics: {{name: {drive}}}, shape: {shape}, state: [3, 6, 0], goal: [17, 6],
  behavior: {{name: follow, planner: {planner}{within}}}, vel_max: {limits}, goal_threshold: 0.2}}
obstacle:
  - {{shape: {{name: linestring, vertices: [[4, 5], [16, 5]]}}, state: [0, 0, 0]}}
  - {{shape: {{name: linestring, vertices: [[4, 7], [16, 7]]}}, state: [0, 0, 0]}}
  - {{shape: {{name: rectangle, length: 0.4, width: 2.2}}, state: [10, {middle}, 0]}}
"""
INSIDE = ", within: {rectangle: [2, 5, 18, 7]}"


def env_of(make: Make, within: str = "", middle: float = 6.0, drive: str = "diff", planner: str = "astar") -> Any:
    limits = "[1, 1, 1]" if drive == "omni_angular" else "[1, 1]"
    shape = "{name: circle, radius: 0.2}"
    text = TEXT.format(drive=drive, shape=shape, within=within, middle=middle, planner=planner, limits=limits)
    return make(text, seed=1)


def drive_to_the_end(env: Any, steps: int = 500) -> Any:
    env.rollout(steps)
    return np.array(env.simulation.state.trajectory(env.robot.row))


def test_without_a_region_the_path_goes_around_through_the_open_ends(make: Make) -> None:
    env = env_of(make)
    track = drive_to_the_end(env)
    assert env.robot.arrive
    assert np.abs(track[:, 1] - 6).max() > 1, "outside the corridor"


def test_a_path_within_a_region_does_not_leave_it(make: Make) -> None:
    env = env_of(make, INSIDE)
    track = drive_to_the_end(env, 50)
    assert [event.kind for event in env.events] == ["no_path"]
    assert len(track) == 0 or (track[:, :2] == [3, 6]).all()


@pytest.mark.parametrize("drive", ["diff", "omni", "omni_angular", "acker"])
@pytest.mark.parametrize("planner", ["astar", "jps"])
def test_where_there_is_a_way_inside_it_is_taken(make: Make, drive: str, planner: str) -> None:
    env = env_of(make, INSIDE, middle=7.0, drive=drive, planner=planner)  # leaves 0.9 m at the lower wall
    track = drive_to_the_end(env)
    assert env.robot.arrive
    assert (np.abs(track[:, 1] - 6) < 1).all()


@pytest.mark.parametrize("planner", ["rrt", "rrt_star", "informed_rrt_star", "prm"])
def test_planners_that_draw_samples_stay_inside(make: Make, planner: str) -> None:
    env = env_of(make, INSIDE, middle=7.0, drive="omni", planner=planner)
    track = drive_to_the_end(env)
    assert (np.abs(track[:, 1] - 6) < 1).all()
    assert env.robot.arrive or "no_path" in [event.kind for event in env.events]


def test_a_polygon_with_a_notch_is_kept(make: Make) -> None:
    env = make("""
world: {width: 10, height: 10}
robot: {kinematics: {name: omni}, shape: {name: circle, radius: 0.2}, state: [1, 1, 0], goal: [9, 1],
  behavior: {name: follow, within: {polygon: [[0, 0], [4, 0], [4, 6], [6, 6], [6, 0], [10, 0], [10, 8], [0, 8]]}}}
""")
    track = drive_to_the_end(env)
    assert env.robot.arrive
    notch = (track[:, 0] > 4.0) & (track[:, 0] < 6.0)
    assert notch.any()
    assert (track[notch, 1] > 6.0).all()


def test_a_robot_that_was_pushed_out_comes_back(make: Make) -> None:
    env = env_of(make, INSIDE, middle=7.0, drive="omni")
    for _ in range(10):
        env.step()
    env.robot.set_state([2.5, 4.2, 0])
    for _ in range(400):
        env.step()
    assert env.robot.arrive


def problems(within: str) -> list[tuple[str, str]]:
    text = TEXT.format(
        drive="diff", shape="{name: circle, radius: 0.2}", planner="astar", limits="[1, 1]", middle=7, within=within
    )
    return [(f.severity, f.code) for f in irsim.validate(text=text).findings if f.severity != "hint"]


def test_regions_are_checked() -> None:
    assert problems(INSIDE) == []
    assert problems(", within: {rectangle: [2, 5, 16, 7]}")[0] == ("warning", "region-left")
    assert problems(", within: {rectangle: [18, 5, 2, 7]}")[0] == ("error", "range-order")
    assert problems(", within: {polygon: [[0, 0], [20, 12], [20, 0], [0, 12]]}")[0] == ("error", "invalid-polygon")
    assert problems(", within: {}")[0] == ("error", "missing-key")
    both = ", within: {rectangle: [2, 5, 18, 7], polygon: [[0, 0], [20, 0], [20, 12]]}"
    assert problems(both)[0] == ("error", "conflicting-keys")
