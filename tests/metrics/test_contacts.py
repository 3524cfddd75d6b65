"""Contacts between steps, distances of whole scenarios, and the return of CrowdNav, worked by hand."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from irsim.env import Env
from irsim.metrics import clearance, closest, robot_metrics
from irsim.metrics.episode import episode_metrics
from irsim.scenario.open import read_scenario
from irsim.simulation.roles import HUMAN as PERSON
from irsim.simulation.roles import IGNORED, ROBOT, STATIC, kinds_of
from irsim.simulation.trace import record_rollout
from tests.metrics.test_robot_metrics import HUMAN, event, scenario, straight, trace


def test_contacts_between_steps_count_until_it_arrives_and_are_no_collisions() -> None:
    rest = "obstacle:\n  - {shape: {name: circle, radius: 0.2}, state: [9, 9]}\n"
    rest += "  - {shape: {name: circle, radius: 0.2}, state: [3, 9], unobstructed: true}\n"
    resolved = scenario(([1, 5], [4, 5]), rest=rest)
    robot, wall, ghost = (record.name for record in resolved.objects)
    pose = np.concatenate([straight(35)[:, None], np.tile([[9.0, 9], [3, 9]], (36, 1, 1))], axis=1)
    events = [
        event("contact_between_steps", 3, robot, wall),
        event("passed_through", 9, wall, robot),
        event("passed_through", 14, robot, ghost),
        event("arrival", 30, robot),
        event("contact_between_steps", 33, robot, wall),
    ]
    metrics = episode_metrics(trace(resolved, pose, [[4, 5]]), resolved, events)
    keys = ("contacts_between_steps", "collision_count", "collision_steps", "success")
    assert [metrics.robots[0][key] for key in keys] == [2, 0, 0, 1]
    assert metrics.episode["contacts_between_steps"] == 2


PEOPLE = """
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
    scenario, _ = read_scenario(text=PEOPLE, strict=True)
    assert kinds_of(scenario.objects).tolist() == [ROBOT, ROBOT, PERSON, PERSON, STATIC, IGNORED, STATIC]


def test_distances_over_an_episode_and_the_closest_moment() -> None:
    scenario, _ = read_scenario(text=PEOPLE, strict=True)
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
    assert {distances.names[i] for i in distances.partner[:, 0, PERSON]} == {scenario.objects[i].name for i in (2, 3)}
    assert distances.static[0, 0] == pytest.approx(0.8)  # the wall behind it
    nearest = closest(distances)[1]
    assert nearest is not None
    assert (nearest.row, nearest.kind, nearest.partner) == (0, "human", scenario.objects[2].name)
    assert nearest.distance == pytest.approx(1.4)


def test_alone_in_the_world_nothing_is_close() -> None:
    scenario, _ = read_scenario(text="robot: {kinematics: {name: diff}, goal: [5, 5, 0]}", strict=True)
    assert closest(clearance(np.zeros((3, 1, 3)), scenario)) == [None]


DT = 0.1


def reward(
    gap: float, steps: int = 80, arrival: int | None = None, contact: int | None = None, top: float = 1.0
) -> float:
    """The return of a straight drive past a standing human whose surface is `gap` to the side at step 40."""
    resolved = scenario(([1, 5], [9, 5]), rest=HUMAN)
    resolved.objects[0].vel_max = [top, 0.0]
    robot, human = (record.name for record in resolved.objects)
    path = np.stack([straight(steps), np.tile([5.0, 5.5 + gap], (steps + 1, 1))], axis=1)
    events = [] if contact is None else [event("collision", contact, robot, human)]
    events += [] if arrival is None else [event("arrival", arrival, robot)]
    return robot_metrics(trace(resolved, path, [[9, 5]]), resolved, events)[0]["crowdnav_reward"]


def discomfort(gap: float, steps: int) -> float:
    """The sum over steps that begin at t and end at surface distance d of (d - 0.2) 0.5 dt 0.9^t."""
    total = 0.0
    for step in range(1, steps + 1):
        away = math.hypot(1 + DT * step - 5, gap + 0.5) - 0.5
        if 0 < away < 0.2:
            total += (away - 0.2) * 0.5 * DT * 0.9 ** (DT * (step - 1))
    return total


COST = discomfort(0.1, 80)
RETURNS = [
    # an arrival is worth less the later it is; the first step is not discounted
    ({"gap": 2.0, "arrival": 80}, 0.9**7.9),
    ({"gap": 2.0, "steps": 40, "arrival": 40}, 0.9**3.9),
    ({"gap": 2.0, "arrival": 1}, 1.0),
    ({"gap": 2.0, "arrival": 80, "top": 2.0}, 0.9 ** (7.9 * 2)),
    ({"gap": 2.0, "arrival": 80, "top": math.inf}, math.nan),
    # a time-out is worth nothing; at exactly 0.2 m no person is disturbed
    ({"gap": 2.0}, 0.0),
    ({"gap": 0.2}, 0.0),
    # to come close costs until the end
    ({"gap": 0.1}, COST),
    ({"gap": 0.1, "arrival": 80}, COST + 0.9**7.9),
    ({"gap": 0.1, "steps": 40}, discomfort(0.1, 40)),
    # the first contact ends it, replaces what its step would earn, and counts before an arrival, but not after one
    ({"gap": 2.0, "contact": 31, "arrival": 80}, -0.25 * 0.9**3.0),
    ({"gap": 0.1, "contact": 40}, discomfort(0.1, 39) - 0.25 * 0.9**3.9),
    ({"gap": 2.0, "contact": 40, "arrival": 40}, -0.25 * 0.9**3.9),
    ({"gap": 2.0, "contact": 0}, -0.25),
    ({"gap": 2.0, "arrival": 40, "contact": 60}, 0.9**3.9),
]


@pytest.mark.parametrize(("episode", "expected"), RETURNS)
def test_the_return_of_an_episode(episode: dict[str, Any], expected: float) -> None:
    assert COST < -0.002
    assert reward(**episode) == pytest.approx(expected, abs=1e-12, nan_ok=True)
