"""Mistakes in groups, behaviors and velocities: errors in ``validate``; ``make`` warns and does what 2.12 does."""

from __future__ import annotations

import numpy as np
import pytest
import yaml

from irsim.diagnostics.diagnostic import format_path
from irsim.diagnostics.errors import ScenarioError
from irsim.scenario.read import read
from tests.env.driving import Make, take_steps

HEAD = "kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, goal: [9, 1, 0]"
PAIR = f"number: 2, state: [[1, 1, 0], [5, 5, 0]], {HEAD}"


def _errors(text: str) -> list[tuple[str, str]]:
    diagnostics = read(yaml.safe_load(text), strict=True).diagnostics
    return [(item.code, format_path(item.path)) for item in diagnostics if item.severity == "error"]


GROUP_MISTAKES = [
    ("{timeHorizon: 3}", "missing-key", "name"),
    ("{name: sfm, gaze_vision_angle: 200}", "out-of-range", "gaze_vision_angle"),
    ("{name: sfm, relaxation_time: 0}", "out-of-range", "relaxation_time"),
    ("{name: sfm, social_groups: 3}", "wrong-type", "social_groups"),
    ("{name: sfm, social_groups: [[0, -1]]}", "out-of-range", "social_groups[0][1]"),
    ("{name: sfm, social_groups: [[0, 0]]}", "bad-social-group", "social_groups[0][1]"),
    ("{name: sfm, social_groups: [[0], [2, 1]]}", "bad-social-group", "social_groups[1][0]"),
    ("{name: orca, maxNeighbors: -1}", "out-of-range", "maxNeighbors"),
]


@pytest.mark.parametrize(
    ("key", "options", "code", "place"),
    [("group_behavior", *row) for row in GROUP_MISTAKES]
    + [("behavior", f"{{name: rvo, acce: {acce}}}", "out-of-range", "acce") for acce in (0, -1)],
)
def test_robots_with_options_that_cannot_be_used_stand_as_in_2_12(
    make: Make, key: str, options: str, code: str, place: str
) -> None:
    """2.12 goes on without a group behavior it cannot make, and with an rvo that finds no velocity."""
    text = f"robot: {{{PAIR}, {key}: {options}}}"
    assert _errors(text) == [(code, f"robot.{key}.{place}")]
    env = make(text)
    take_steps(env, 3)
    assert [robot.state[:2, 0].round(6).tolist() for robot in env.robot_list] == [[1, 1], [5, 5]]


def test_without_its_group_behavior_a_robot_follows_its_own(make: Make) -> None:
    env = make(f"robot: {{{HEAD}, state: [1, 1, 0], behavior: {{name: dash}}, group_behavior: {{timeHorizon: 3}}}}")
    take_steps(env, 3)
    np.testing.assert_allclose(env.robot.state[:, 0], [1.3, 1, 0])


@pytest.mark.parametrize(("behavior", "velocity"), [("dash", "[1, 1, 1]"), ("dash", "[1]"), ("rvo", "[1, 0, 1]")])
def test_a_velocity_of_the_wrong_length(make: Make, behavior: str, velocity: str) -> None:
    text = f"robot: {{{HEAD}, state: [1, 1, 0], velocity: {velocity}, behavior: {{name: {behavior}}}}}"
    assert _errors(text) == [("wrong-length", "robot.velocity")]
    env = make(text)
    take_steps(env, 3)
    np.testing.assert_allclose(env.robot.state[:, 0], [1.3, 1, 0], atol=1e-9)


@pytest.mark.parametrize("keys", ["acce: [1, 1], behavior: {name: dash}", "color: r"])
def test_where_2_12_raises_make_does_too(make: Make, keys: str) -> None:
    with pytest.raises(ScenarioError, match="wrong-length"):
        make(f"robot: {{{HEAD}, state: [1, 1, 0], velocity: [1, 1, 1], {keys}}}")
