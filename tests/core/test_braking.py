"""Limits of acceleration: behaviors brake in time, and drives turn toward a velocity without swinging."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import irsim
import irsim._core as core
from irsim.common.angles import wrap
from tests.core.worlds import DRIVES, PI, advanced, circle, kernel, obstacle, rectangle, robot, scene
from tests.effort import for_all

BEHAVIORS: dict[str, Any] = {
    "orca": kernel("orca", timeHorizonObst=0.1, timeHorizon=0.3),  # too short to brake in time by themselves
    "avocado": kernel("avocado", timeHorizonObst=0.1, timeHorizon=0.3),
    "rvo": kernel("rvo", vxmax=3.0, vymax=3.0),
    "sfm": kernel("sfm", vmax=3.0, force_factor_obstacle=0.0, force_factor_social=0.0),
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
@for_all(
    8,
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
        turns_away = float(state.twist[0, 2] * state.pose[0, 2]) > 0  # and so needs less room than straight ahead
        if drive == "diff" and speed > 0 and not turns_away:
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
        state = advanced(round(20 / dt), *ring, step_time=dt)
        assert not state.collided.any()


def test_a_robot_beside_one_that_stopped_for_good_brakes_as_for_a_wall() -> None:
    parked = robot(parts=[circle(0.2)], pose=[4.0, 0.05, 0.0], drive=DRIVES["diff"])
    start = inert("orca", "diff", 0.5, 2.0, goals=[[8.0, 0.0]], control=[1.5, 0.0, 0.0])
    state = advanced(100, start, parked)
    assert not state.collided.any()


def test_without_limits_nothing_brakes_earlier() -> None:
    """A limit so high that a stop takes one step changes nothing before the last one, where the wall is near."""
    runs = []
    for acce in (math.inf, 1e6):
        limits = {"vel_max": [1.0, 1.0, 0.0], "vel_min": [-1.0, -1.0, 0.0], "acce": [acce, math.inf, math.inf]}
        state = advanced(30, robot(behavior=kernel("orca"), drive=DRIVES["diff"], goals=[[5.0, 1.0]], **limits))
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


FAR = 1e6
"""Distance of the goal [m], so that its direction does not change."""


def can_stop(rate: float, error: float, acce: float, dt: float) -> bool:
    """Whether some turn that starts at this rate does not go beyond the wanted heading."""
    toward = math.copysign(1, error) * rate
    slowest = max(0.0, abs(toward) - acce * dt)  # in the first period
    turns = float(np.arange(slowest, 0.0, -acce * dt).sum()) * dt
    return turns <= abs(error) - 1e-9 if toward > 0 else abs(error) + turns < PI - 1e-9


@given(
    error=st.floats(-PI + 0.01, PI - 0.01),
    share=st.floats(-1, 1),
    acce=st.floats(0.05, 50),
    top=st.floats(0.05, 10),
    dt=st.sampled_from([0.01, 0.05, 0.1, 0.2, 0.5, 1.0]),
    guarantee_time=st.sampled_from([0.01, 0.2, 1.0]),
)
def test_a_turn_never_goes_beyond_the_wanted_heading(
    error: float, share: float, acce: float, top: float, dt: float, guarantee_time: float
) -> None:
    rate, theta = share * top, -error
    assume(can_stop(rate, error, acce, dt))
    for _ in range(400):
        before = wrap(-theta)
        [_, wanted, _] = core.drive_follow(
            DRIVES["diff"], [0, 0, theta], [1, 0], tolerance=0.0, guarantee_time=guarantee_time, max_rate=top,
            acce=acce, dt=dt,
        )  # fmt: skip
        rate = min(max(wanted, rate - acce * dt), rate + acce * dt)
        theta += rate * dt
        after = wrap(-theta)
        if abs(before) < 1 and abs(after) < 1:
            assert before * after > -1e-12, "it crossed the heading"


@given(error=st.floats(-PI, PI), dt=st.sampled_from([0.01, 0.1, 0.5]), time=st.sampled_from([0.1, 0.2]))
def test_without_a_limit_the_law_is_as_ever(error: float, dt: float, time: float) -> None:
    turn = {"tolerance": 0.0, "guarantee_time": time, "max_rate": 3.0}
    plain = core.drive_follow(DRIVES["diff"], [0, 0, -error], [1, 0], **turn)
    assert core.drive_follow(DRIVES["diff"], [0, 0, -error], [1, 0], **turn, acce=math.inf, dt=dt) == plain


@pytest.mark.parametrize("name", ["orca", "avocado", "sfm"])
@pytest.mark.parametrize("dt", [0.05, 0.1, 0.2])
def test_a_robot_under_each_behavior_turns_without_swinging(name: str, dt: float) -> None:
    turner = robot(
        drive=DRIVES["diff"],
        pose=[0.0, 0.0, -2.0],
        goals=[[FAR, 0.0]],
        vel_max=[1.0, 10.0, 0.0],
        vel_min=[-1.0, -10.0, 0.0],
        acce=[math.inf, 4.0, math.inf],
        behavior=kernel(name),
    )
    world, state = scene(turner, step_time=dt)
    headings = []
    for _ in range(round(4 / dt)):
        core.advance(world, state, 1)
        headings.append(float(state.pose[0, 2]))
    fastest = 2 * math.sqrt(2.0 / 4.0)  # half the angle faster and faster, then half of it slower and slower
    assert abs(headings[math.ceil((fastest + 0.5) / dt)]) < 0.13, "errors below 0.1 rad are not corrected"
    assert max(headings) < 4.0 * dt**2 / 8 + 1e-3
    assert np.ptp(headings[-5:]) < 1e-3
