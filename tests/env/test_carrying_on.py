"""Mistakes in groups, behaviors and velocities: errors in ``validate``; ``make`` warns and does what 2.12 does."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import yaml

from irsim.diagnostics.diagnostic import format_path
from irsim.diagnostics.errors import ScenarioError
from irsim.scenario.read import read

Make = Callable[..., Any]
HEAD = "kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, goal: [9, 1, 0]"
PAIR = f"number: 2, state: [[1, 1, 0], [5, 5, 0]], {HEAD}"


def _errors(text: str) -> list[tuple[str, str]]:
    diagnostics = read(yaml.safe_load(text), strict=True).diagnostics
    return [(item.code, format_path(item.path)) for item in diagnostics if item.severity == "error"]


@pytest.mark.parametrize(
    ("keys", "code", "place"),
    [
        ("group_behavior: {timeHorizon: 3}", "missing-key", "group_behavior.name"),
        ("group_behavior: {name: sfm, gaze_vision_angle: 200}", "out-of-range", "group_behavior.gaze_vision_angle"),
        ("group_behavior: {name: sfm, relaxation_time: 0}", "out-of-range", "group_behavior.relaxation_time"),
        ("group_behavior: {name: sfm, social_groups: 3}", "wrong-type", "group_behavior.social_groups"),
        ("group_behavior: {name: sfm, social_groups: [[0, -1]]}", "out-of-range", "group_behavior.social_groups[0][1]"),
        (
            "group_behavior: {name: sfm, social_groups: [[0, 0]]}",
            "bad-social-group",
            "group_behavior.social_groups[0][1]",
        ),
        (
            "group_behavior: {name: sfm, social_groups: [[0], [2, 1]]}",
            "bad-social-group",
            "group_behavior.social_groups[1][0]",
        ),
        ("group_behavior: {name: orca, maxNeighbors: -1}", "out-of-range", "group_behavior.maxNeighbors"),
        ("behavior: {name: rvo, acce: 0}", "out-of-range", "behavior.acce"),
        ("behavior: {name: rvo, acce: -1}", "out-of-range", "behavior.acce"),
    ],
)
def test_nobody_moves(make: Make, keys: str, code: str, place: str) -> None:
    """2.12 goes on without a group behavior it cannot make, and with an rvo that finds no velocity."""
    text = f"robot: {{{PAIR}, {keys}}}"
    assert _errors(text) == [(code, f"robot.{place}")]
    env = make(text)
    for _ in range(3):
        env.step()
    assert [robot.state[:2, 0].round(6).tolist() for robot in env.robot_list] == [[1, 1], [5, 5]]


def test_without_its_group_behavior_a_robot_follows_its_own(make: Make) -> None:
    env = make(f"robot: {{{HEAD}, state: [1, 1, 0], behavior: {{name: dash}}, group_behavior: {{timeHorizon: 3}}}}")
    for _ in range(3):
        env.step()
    np.testing.assert_allclose(env.robot.state[:, 0], [1.3, 1, 0])


@pytest.mark.parametrize(("behavior", "velocity"), [("dash", "[1, 1, 1]"), ("dash", "[1]"), ("rvo", "[1, 0, 1]")])
def test_a_velocity_of_the_wrong_length(make: Make, behavior: str, velocity: str) -> None:
    text = f"robot: {{{HEAD}, state: [1, 1, 0], velocity: {velocity}, behavior: {{name: {behavior}}}}}"
    assert _errors(text) == [("wrong-length", "robot.velocity")]
    env = make(text)
    for _ in range(3):
        env.step()
    np.testing.assert_allclose(env.robot.state[:, 0], [1.3, 1, 0], atol=1e-9)


@pytest.mark.parametrize("keys", ["acce: [1, 1], behavior: {name: dash}", "color: r"])
def test_where_2_12_raises_make_does_too(make: Make, keys: str) -> None:
    with pytest.raises(ScenarioError, match="wrong-length"):
        make(f"robot: {{{HEAD}, state: [1, 1, 0], velocity: [1, 1, 1], {keys}}}")
