"""The law of `ease`, and what a user notices."""

from __future__ import annotations

import math

import numpy as np
import pytest

import irsim
import irsim._core as core
from tests.core.worlds import DRIVES, robot, scene

EASE = core.EaseOptions(slow_radius=2.0)


@pytest.mark.parametrize(("distance", "speed"), [(5.0, 1.0), (2.0, 1.0), (1.0, 0.5), (0.05, 0.0)])
def test_speed_is_proportional_to_the_remaining_distance(distance: float, speed: float) -> None:
    goal = [distance * math.cos(0.3), distance * math.sin(0.3)]
    world, state = scene(robot(drive=DRIVES["omni"], goals=[goal], goal_threshold=0.1, behavior=EASE))
    core.decide(world, state)
    np.testing.assert_allclose(state.command[0, :2], speed * np.array([math.cos(0.3), math.sin(0.3)]), atol=1e-12)


@pytest.mark.parametrize("drive", DRIVES)
def test_every_drive_arrives(drive: str) -> None:
    world, state = scene(robot(drive=DRIVES[drive], goals=[[3.0, 0.05]], goal_threshold=0.15, behavior=EASE))
    core.advance(world, state, 300, until_done=True)
    assert state.arrived[0] == 1


def test_negative_radius_is_an_error() -> None:
    text = "robot: {kinematics: {name: diff}, goal: [5, 1], behavior: {name: ease, slow_radius: -1}}"
    assert [finding.code for finding in irsim.validate(text=text).findings if finding.severity == "error"]
