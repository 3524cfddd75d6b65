"""The laws of `dash`, on every drive."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume
from hypothesis import strategies as st

import irsim._core as core
from tests.core import oracle
from tests.core.worlds import DRIVES, PI, decided, robot, scene
from tests.effort import for_all

NUMBER = st.floats(-5, 5)
LAW = {"angular": "steer"}


@pytest.mark.parametrize("drive", DRIVES)
@for_all(
    60,
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
    state = decided(
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
    expected = oracle.dash(LAW.get(drive, drive), pose, goal, top, acce, threshold, tolerance, 0.1)
    np.testing.assert_allclose(state.command[0], expected, atol=1e-12)


def test_no_goal_no_motion() -> None:
    state = decided(*(robot(drive=d, control=[0.5, 0.5, 0.5]) for d in DRIVES.values()), mode=1)
    np.testing.assert_array_equal(state.command, 0.0)


@pytest.mark.parametrize("drive", DRIVES)
def test_reaches_a_goal_ahead(drive: str) -> None:
    world, state = scene(robot(drive=DRIVES[drive], goals=[[3.0, 0.05]], goal_threshold=0.15))
    assert core.advance(world, state, 200, until_done=True) < 60
    assert state.arrived[0] == 1
