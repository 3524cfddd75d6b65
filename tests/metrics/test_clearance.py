"""Distances of a whole scenario: who is who, and the closest approach."""

from __future__ import annotations

import numpy as np
import pytest

from irsim.env import Env
from irsim.metrics import clearance, closest
from irsim.scenario.open import read_scenario
from irsim.simulation.roles import HUMAN, IGNORED, ROBOT, STATIC, kinds_of
from irsim.simulation.trace import record_rollout

SCENARIO = """
world: {width: 10, height: 10, boundary: walls, collision_mode: unobstructed}
robot:
  - kinematics: {name: diff}
    shape: {name: circle, radius: 0.2}
    state: [1, 5, 0]
    goal: [9, 5, 0]
    behavior: {name: dash}
  - {kinematics: {name: omni}, shape: {name: circle, radius: 0.3}, state: [5, 8], goal: [5, 8.05]}
obstacle:
  - kinematics: {name: omni}
    shape: {name: circle, radius: 0.3}
    state: [5, 6]
    goal: [5, 1]
    behavior: {name: dash}
  - {shape: {name: circle, radius: 0.5}, state: [3, 3], tags: [pedestrian]}
  - {shape: {name: rectangle, length: 1, width: 1}, state: [7, 6.5, 0]}
  - {shape: {name: circle, radius: 1.0}, state: [5, 5], unobstructed: true}
"""


def test_who_is_who() -> None:
    scenario, _ = read_scenario(text=SCENARIO, strict=True)
    assert kinds_of(scenario.objects).tolist() == [ROBOT, ROBOT, HUMAN, HUMAN, STATIC, IGNORED, STATIC]


def test_distances_over_an_episode_and_the_closest_moment() -> None:
    scenario, _ = read_scenario(text=SCENARIO, strict=True)
    simulation = Env(scenario, seed=3, display=False, log_level="ERROR").simulation
    start = simulation.pose.copy()
    trace = record_rollout(simulation, 100, until_done=False)
    poses = np.concatenate([start[None], trace.pose])
    distances = clearance(poses, scenario, seed=3)
    assert distances.distance.tobytes() == clearance(poses, simulation).distance.tobytes()
    assert distances.distance.shape == (101, 2, 3)
    x, y = poses[:, :, 0], poses[:, :, 1]
    first, walker, sitter = 0, 2, 3
    np.testing.assert_allclose(distances.robot[:, 0], np.hypot(x[:, 0] - x[:, 1], y[:, 0] - y[:, 1]) - 0.5)
    np.testing.assert_array_equal(distances.robot[:, 0], distances.robot[:, 1])
    people = np.stack(
        [
            np.hypot(x[:, first] - x[:, walker], y[:, first] - y[:, walker]) - 0.5,
            np.hypot(x[:, first] - x[:, sitter], y[:, first] - y[:, sitter]) - 0.7,
        ]
    )
    np.testing.assert_allclose(distances.human[:, 0], people.min(axis=0), atol=1e-12)
    assert {distances.names[i] for i in distances.partner[:, 0, HUMAN]} == {scenario.objects[i].name for i in (2, 3)}
    assert distances.static[0, 0] == pytest.approx(0.8)  # the wall behind it
    nearest = closest(distances)[1]
    assert nearest is not None
    assert (nearest.row, nearest.kind, nearest.partner) == (0, "human", scenario.objects[2].name)
    assert nearest.distance == pytest.approx(1.4)


def test_alone_in_the_world_nothing_is_close() -> None:
    scenario, _ = read_scenario(text="robot: {kinematics: {name: diff}, goal: [5, 5, 0]}", strict=True)
    assert closest(clearance(np.zeros((3, 1, 3)), scenario)) == [None]
