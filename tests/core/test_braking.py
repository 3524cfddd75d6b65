"""Behaviors that avoid others brake in time when the acceleration of their object is limited."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import irsim
import irsim._core as core
from tests.core.test_avocado import options as avocado
from tests.core.test_orca import options as orca
from tests.core.test_rvo import rvo
from tests.core.test_sfm import sfm
from tests.core.worlds import DRIVES, PI, circle, obstacle, rectangle, robot, scene
from tests.effort import examples

BEHAVIORS: dict[str, Any] = {
    "orca": orca(timeHorizonObst=0.1, timeHorizon=0.3),  # too short to brake in time by themselves
    "avocado": avocado(timeHorizonObst=0.1, timeHorizon=0.3),
    "rvo": rvo(vxmax=3.0, vymax=3.0),
    "sfm": sfm(vmax=3.0, force_factor_obstacle=0.0, force_factor_social=0.0),
}


def inert(name: str, drive: str, acce: float, top: float, **more: Any) -> core.ObjectSpec:
    """A robot of radius 0.2 m under a behavior, with a limited change of speed [m/s^2]."""
    keys: dict[str, Any] = {
        "behavior": BEHAVIORS[name],
        "drive": DRIVES[drive],
        "vel_max": [top, top if drive.startswith("omni") else 1.0, 1.0],
        "vel_min": [-top, -top if drive.startswith("omni") else -1.0, -1.0],
        "acce": [acce, acce if drive.startswith("omni") else 4.0, 4.0],
        "goal_threshold": 0.1,
    }
    return robot(**{**keys, **more})


@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize("name", BEHAVIORS)
@settings(max_examples=examples(8))
@given(
    acce=st.floats(0.2, 4),
    top=st.floats(0.2, 3),
    dt=st.sampled_from([0.05, 0.1, 0.2, 0.5]),
    aside=st.floats(-1, 1),
    heading=st.floats(-0.5, 0.5),
)
def test_no_one_is_faster_than_braking_before_a_wall_allows(
    name: str, drive: str, acce: float, top: float, dt: float, aside: float, heading: float
) -> None:
    wall = obstacle(parts=[rectangle(0.2, 30.0)], pose=[10.0, 0.0, 0.0])
    start = inert(name, drive, acce, top, pose=[0.0, aside, heading], goals=[[20.0, 0.0]])
    world, state = scene(start, wall, step_time=dt)
    for _ in range(round(min(60.0, 10.0 / top + top / acce + 5.0) / dt)):
        core.advance(world, state, 1)
        gap, speed = 9.9 - 0.2 - float(state.pose[0, 0]), float(state.twist[0, 0])
        assert not state.collided[0]
        if drive == "diff" and speed > 0:
            along = float(np.hypot(*state.twist[0, :2]))
            assert along * along / (2 * acce) * (speed / along) <= gap + along * dt + 1e-6


@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize("name", BEHAVIORS)
@pytest.mark.parametrize("dt", [0.05, 0.1, 0.2])
def test_those_who_brake_in_time_do_not_touch(name: str, drive: str, dt: float) -> None:
    rng = np.random.default_rng(3)
    for _ in range(3):
        angles = np.arange(6) * PI / 3 + rng.uniform(-0.2, 0.2, 6)
        ring = [
            inert(
                name, drive, 1.0, 1.5,
                pose=[4 * math.cos(a), 4 * math.sin(a), a + PI], goals=[[-4 * math.cos(a), -4 * math.sin(a)]],
            )
            for a in angles
        ]  # fmt: skip
        world, state = scene(*ring, step_time=dt)
        core.advance(world, state, round(20 / dt))
        assert not state.collided.any()


def test_a_robot_beside_one_that_stopped_for_good_brakes_as_for_a_wall() -> None:
    parked = robot(parts=[circle(0.2)], pose=[4.0, 0.05, 0.0], drive=DRIVES["diff"])
    start = inert("orca", "diff", 0.5, 2.0, goals=[[8.0, 0.0]], control=[1.5, 0.0, 0.0])
    world, state = scene(start, parked)
    core.advance(world, state, 100)
    assert not state.collided.any()


def test_the_order_of_declaration_does_not_matter() -> None:
    first = inert("orca", "diff", 1.0, 1.0, pose=[0.0, 0.0, 0.0], goals=[[6.0, 0.0]])
    second = inert("orca", "diff", 1.0, 1.0, pose=[3.0, -3.0, PI / 2], goals=[[3.0, 4.0]])
    ends = []
    for pair, order in (((first, second), [0, 1]), ((second, first), [1, 0])):
        world, state = scene(*pair)
        core.advance(world, state, 60)
        ends.append(state.pose[order])
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-9)


def test_without_limits_nothing_brakes_earlier() -> None:
    """A limit so high that a stop takes one step changes nothing before the last one, where the wall is near."""
    runs = []
    for acce in (math.inf, 1e6):
        limits = {"vel_max": [1.0, 1.0, 0.0], "vel_min": [-1.0, -1.0, 0.0], "acce": [acce, math.inf, math.inf]}
        world, state = scene(robot(behavior=orca(), drive=DRIVES["diff"], goals=[[5.0, 1.0]], **limits))
        core.advance(world, state, 30)
        runs.append(state.pose.copy())
    np.testing.assert_array_equal(runs[0], runs[1])


WORLD = "world: {width: 10, height: 10, collision_mode: stop, after_arrival: %s, step_time: %g}\n"
CROWD = (
    "robot: {number: 10, kinematics: {name: diff}, distribution: {name: random, range_low: [0.5, 0.5, -3.14], "
    "range_high: [9.5, 9.5, 3.14], min_distance: 1}, shape: {name: polygon, random_shape: true, is_convex: true, "
    "avg_radius_range: [0.1, 0.5], irregularity_range: [0, 0.6], num_vertices_range: [4, 7]}, vel_max: [1, 3], "
    "vel_min: [-1, -3], acce: [1, 4], goal_threshold: 0.3, group_behavior: {name: %s}}\n"
)


@pytest.mark.parametrize("behavior", ["orca, neighborDist: 5, timeHorizon: 2, safe_radius: 0.02", "avocado"])
@pytest.mark.parametrize(("protocol", "step_time"), [("freeze", 0.1), ("yield", 0.2), ("yield", 0.05)])
def test_random_crowds_with_limits_do_not_collide(behavior: str, protocol: str, step_time: float) -> None:
    text = WORLD % (protocol, step_time) + CROWD % behavior
    arrived = 0
    for seed in range(3):
        result = irsim.run(text=text, seed=seed, steps=round(40 / step_time))
        assert sum(robot.collision_count for robot in result.robots) == 0
        arrived += sum(robot.outcome == "success" for robot in result.robots)
    assert arrived >= 27
