"""The laws of `dash`, on every drive."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import irsim._core as core
from tests.core import oracle
from tests.core.worlds import DRIVES, PI, robot, scene
from tests.effort import examples

NUMBER = st.floats(-5, 5)
LAW = {"angular": "steer"}


@pytest.mark.parametrize("drive", DRIVES)
@settings(max_examples=examples(60))
@given(
    pose=st.tuples(NUMBER, NUMBER, st.floats(-PI, PI)),
    goal=st.one_of(st.tuples(NUMBER, NUMBER), st.tuples(NUMBER, NUMBER, st.floats(-PI, PI))),
    top=st.lists(st.floats(0.1, 2), min_size=3, max_size=3),
    acce=st.lists(st.sampled_from([0.0, 0.7, 3.0, math.inf]), min_size=3, max_size=3),
    threshold=st.sampled_from([0.1, 2.0, 20.0]),
    tolerance=st.sampled_from([0.0, 0.1, 0.5]),
)
def test_law(drive: str, pose, goal, top, acce, threshold: float, tolerance: float) -> None:
    bearing = math.atan2(goal[1] - pose[1], goal[0] - pose[0])
    for error in (oracle.wrap(angle - pose[2]) for angle in (bearing, goal[-1])):
        assume(PI - abs(error) > 1e-9)  # left or right are equally good
        assume(abs(abs(error) - tolerance) > 1e-9)
    world, state = scene(
        robot(
            drive=DRIVES[drive],
            pose=pose,
            goals=[goal],
            vel_max=top,
            acce=acce,
            goal_threshold=threshold,
            behavior=core.DashOptions(angle_tolerance=tolerance),
        )
    )
    core.decide(world, state)
    expected = oracle.dash(LAW.get(drive, drive), pose, goal, top, acce, threshold, tolerance, 0.1)
    np.testing.assert_allclose(state.command[0], expected, atol=1e-12)


def test_no_goal_no_motion() -> None:
    world, state = scene(*(robot(drive=d, control=[0.5, 0.5, 0.5]) for d in DRIVES.values()), mode=1)
    core.decide(world, state)
    np.testing.assert_array_equal(state.command, 0.0)


@pytest.mark.parametrize("drive", DRIVES)
def test_reaches_a_goal_ahead(drive: str) -> None:
    world, state = scene(robot(drive=DRIVES[drive], goals=[[3.0, 0.05]], goal_threshold=0.15))
    assert core.advance(world, state, 200, until_done=True) < 60
    assert state.arrived[0] == 1


@pytest.mark.parametrize("drive", DRIVES)
def test_turning_and_shifting_the_world_turns_and_shifts_the_motion(drive: str) -> None:
    angle, shift = 0.7, np.array([3.0, -2.0])
    turn = oracle.rotation(angle)
    start, goal = np.array([0.5, 0.2]), np.array([4.0, 3.0])
    plain = scene(robot(drive=DRIVES[drive], pose=[*start, 0.4], goals=[goal.tolist()]))
    turned = scene(
        robot(drive=DRIVES[drive], pose=[*(turn @ start + shift), 0.4 + angle], goals=[(turn @ goal + shift).tolist()])
    )
    for world, state in (plain, turned):
        core.advance(world, state, 30)
    np.testing.assert_allclose(turned[1].pose[0, :2], turn @ plain[1].pose[0, :2] + shift, atol=1e-9)


def test_order_of_declaration_does_not_matter() -> None:
    objects = [robot(pose=[k, k % 3, 0.3 * k], goals=[[5 - k, 4]]) for k in range(6)]
    world, state = scene(*objects, mode=1)
    back_world, back = scene(*reversed(objects), mode=1)
    core.advance(world, state, 40)
    core.advance(back_world, back, 40)
    np.testing.assert_array_equal(state.pose, back.pose[::-1])
