"""Metrics of what robots do to people, of paths that can be worked out by hand."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest
import yaml

import irsim
from irsim.components.behaviors.sfm import Sfm
from irsim.lib.algorithm.social_force_model import SocialForceModelBatch
from irsim.metrics import robot_metrics
from irsim.metrics.social import group_gaps, obstacle_force, social_forces
from irsim.simulation.events import Event
from tests.core import crowd_oracle
from tests.metrics.test_robot_metrics import assert_metrics, measured, scenario, straight, trace

HUMAN = "  - {kinematics: {name: omni}, shape: {name: circle, radius: 0.3}, state: [5, 5], behavior: {name: dash}}\n"
PAIR = f"obstacle:\n{HUMAN}{HUMAN.replace('[5, 5]', '[5, 9]')}"


def resting(place: tuple[float, float], steps: int) -> np.ndarray:
    return np.tile(np.asarray(place, dtype=float), (steps + 1, 1))


def with_human(robot: np.ndarray, human: np.ndarray, contact: tuple[float, float], step: int) -> dict[str, float]:
    resolved = scenario(([1, 5], [9, 5]), rest=f"obstacle:\n{HUMAN}")
    names = [record.name for record in resolved.objects]
    hit = Event("collision", step * 0.1, step, *names[:2], *contact)
    return robot_metrics(trace(resolved, np.stack([robot, human], axis=1), [[9, 5]]), resolved, [hit])[0]


@pytest.mark.parametrize(
    ("robot", "human", "mine", "theirs"),
    [
        (1.0, 0.0, 1, 0),  # drove into one who stood
        (0.0, 1.0, 0, 1),  # was walked into
        (1.0, 0.95, 1, 1),  # as fast, within a tenth
        (1.0, 0.85, 1, 0),
        (-0.5, 1.0, 0, 1),  # was caught up with
        (1.0, -0.5, 1, 0),
    ],
)
def test_who_is_to_blame(robot: float, human: float, mine: int, theirs: int) -> None:
    a = straight(10, robot, start=2.25 - robot)
    b = straight(10, -human, start=2.75 + human)
    metrics = with_human(a, b, (2.5, 5.0), 10)
    assert metrics["human_collisions"] == 1
    assert (metrics["human_collisions_by_robot"], metrics["human_collisions_by_human"]) == (mine, theirs)


def test_blame_is_of_the_way_to_the_contact() -> None:
    past = np.stack([np.full(11, 2.7), 4.0 + 0.1 * np.arange(11)], axis=1)  # faster, but not towards it
    metrics = with_human(straight(10, 0.3, start=1.9), past, (2.4, 4.9), 10)
    assert (metrics["human_collisions_by_robot"], metrics["human_collisions_by_human"]) == (1, 0)


def groups(members: str) -> str:
    people = "".join(f"[{x}, 5, 0], " for x in (5, 6, 9))
    return (
        f"obstacle:\n  - {{number: 3, kinematics: {{name: omni}}, shape: {{name: circle, radius: 0.2}}, "
        f"state: [{people}], goal: [[5, 6], [6, 6], [9, 6]], "
        f"group_behavior: {{name: sfm, social_groups: {members}}}}}\n"
    )


def test_the_space_of_a_group() -> None:
    resolved = scenario(([1, 5], [9, 5]), rest=groups("[[0, 1]]"))
    robot = straight(50)  # x = 1 + 0.1 t, radius 0.2: in the space of (5, 5) and (6, 5) from 4.35 on
    people = np.stack([resting((x, 5), 50) for x in (5, 6, 9)], axis=1)
    poses = np.concatenate([robot[:, None], people], axis=1)
    metrics = measured(resolved, poses, [[9, 5]])[0]
    inside = np.count_nonzero(robot[:, 0] >= 5 - 0.65)
    assert_metrics(metrics, group_space_intrusion_ratio=inside / 51, group_collision_rate=1)
    alone = scenario(([1, 5], [9, 5]), rest=groups("[]"))
    assert math.isnan(robot_metrics(trace(alone, poses, [[9, 5]]), alone, [])[0]["group_space_intrusion_ratio"])


def test_the_hull_of_a_group() -> None:
    corners = np.tile(np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [2.0, 2.0]]), (5, 1, 1))
    points = np.array([[1.0, 3.0], [2.0, 5.5], [-3.0, -4.0], [4.0, 2.0], [3.9, 0.2]])
    assert group_gaps(points, corners) == pytest.approx([0.0, 1.5, 5.0, 0.0, 0.0])
    assert group_gaps(points[:2], corners[:2, :2]) == pytest.approx([3.0, 5.5])


def test_social_forces_are_those_of_the_model() -> None:
    rng = np.random.default_rng(4)
    place, speed = rng.uniform(-2, 2, (6, 2)), rng.uniform(-1, 1, (6, 2))
    others, speeds = rng.uniform(-2, 2, (6, 3, 2)), rng.uniform(-1, 1, (6, 3, 2))
    others[0, 0] = place[0]  # in one place: no direction
    others[1, 1] = place[1] + [10.1, 0.0]  # too far
    on_it, by_it = social_forces(place, speed, others, speeds)
    options = Sfm()

    def force(at: np.ndarray, moves: np.ndarray, other: np.ndarray, its: np.ndarray) -> np.ndarray:
        view = dataclasses.make_dataclass("View", ["position", "velocity"])(at, moves)
        return options.force_factor_social * crowd_oracle.social_force(options, view, other, its)

    for t in range(6):
        for m in range(3):
            if (t, m) == (1, 1):
                assert not on_it[t, m].any()
                continue
            np.testing.assert_allclose(on_it[t, m], force(place[t], speed[t], others[t, m], speeds[t, m]), atol=1e-12)
            np.testing.assert_allclose(by_it[t, m], force(others[t, m], speeds[t, m], place[t], speed[t]), atol=1e-12)


def test_social_work_of_two_who_stand() -> None:
    resolved = scenario(([1, 5], [9, 5]), rest=PAIR)
    poses = np.stack([resting((5, 7), 20), resting((5, 5), 20), resting((5, 9), 20)], axis=1)
    metrics = measured(resolved, poses, [[9, 5]])[0]
    each = 2.1 * math.exp(-2 / 0.35)  # standing: the interaction is the unit vector to the other
    assert metrics["social_force_robot"] == pytest.approx(0.0, abs=1e-12)  # from both sides
    assert_metrics(metrics, social_force_agents=2 * each * 2.0, social_work=2 * each * 2.0, pedestrian_velocity_avg=0.0)


def test_forces_of_obstacles_are_those_of_the_model() -> None:
    wall = "  - {shape: {name: rectangle, length: 40, width: 1}, state: [10, 4, 0]}\n"
    resolved = scenario(([1, 5.3], [9, 5.3]), rest=f"obstacle:\n{wall}{HUMAN}")
    poses = np.stack([straight(20) + np.array([0, 0.3]), resting((10, 4), 20), resting((5, 6.3), 20)], axis=1)
    metrics = measured(resolved, poses, [[9, 5.3]])[0]
    model = SocialForceModelBatch(
        [[1, 5.3, 0, 0, 0.2, 0, 0, 0], [5, 6.3, 0, 0, 0.3, 0, 0, 0]], line_obs_list=[[-10, 4.5, 30, 4.5]]
    )
    robot, human = 10.0 * np.linalg.norm(model.obstacle_force(), axis=1) * 2.0
    assert_metrics(metrics, obstacle_force_robot=robot, obstacle_force_agents=human)


def test_forces_of_obstacles_end_and_are_unknown_where_there_are_none() -> None:
    assert obstacle_force(np.array([-0.1, 0.0, 0.8, 4.0, 4.01])) == pytest.approx(
        [10, 10, 10 / math.e, 10 * math.exp(-5), 0]
    )
    resolved = scenario(([1, 5], [9, 5]), rest=PAIR)
    poses = np.stack([straight(20), resting((5, 5), 20), resting((5, 9), 20)], axis=1)
    metrics = measured(resolved, poses, [[9, 5]])[0]
    assert math.isnan(metrics["obstacle_force_robot"])
    assert math.isnan(metrics["obstacle_force_agents"])


def test_speed_of_the_people() -> None:
    resolved = scenario(([1, 5], [9, 5]), rest=PAIR)
    poses = np.stack([straight(10), straight(10, 0.5) + np.array([0, 3]), resting((5, 9), 10)], axis=1)
    metrics = measured(resolved, poses, [[9, 5]])[0]
    assert metrics["pedestrian_velocity_avg"] == pytest.approx(0.25)


def test_effort_clearance_and_leaving_the_world() -> None:
    resolved = scenario(([1, 5], [5, 5]), rest="obstacle:\n  - {shape: {name: circle, radius: 0.5}, state: [3, 7]}\n")
    poses = np.stack([straight(20), resting((3, 7), 20)], axis=1)
    made = trace(resolved, poses, [[5, 5]])
    control = made.control.copy()
    control[1:, 0, 0] = 0.5  # vel_max [1, 0]: the second can't move
    metrics = robot_metrics(dataclasses.replace(made, control=control), resolved, [])[0]
    assert_metrics(metrics, control_effort=0.25 * 2.0, min_clearance=2 - 0.2 - 0.5, left_world=0)
    out = np.stack([straight(20) - np.array([1.5, 0]), resting((3, 7), 20)], axis=1)
    assert measured(resolved, out, [[5, 5]])[0]["left_world"] == 1


CROSSING = """
world: {width: 10, height: 10, time_limit: 20, collision_mode: unobstructed}
robot:
  - {kinematics: {name: omni}, shape: {name: circle, radius: 0.4}, state: [5, 5, 0], goal: [5, 5.5, 0],
     vel_max: [0.02, 0.02], behavior: {name: dash}}
obstacle:
  - {name: walker, tags: [pedestrian], kinematics: {name: omni}, shape: {name: circle, radius: 0.2},
     state: [2, 5.05, 0], goal: [8, 5.05, 0], vel_max: [1, 1], vel_min: [-1, -1], behavior: {name: orca}}
  - {name: other, tags: [pedestrian], kinematics: {name: omni}, shape: {name: circle, radius: 0.2}, state: [2, 9, 0],
     goal: [8, 9, 0], vel_max: [1, 1], vel_min: [-1, -1], behavior: {name: dash}}
"""


def test_the_delay_of_people(tmp_path: Path) -> None:
    (tmp_path / "crossing.yaml").write_text(CROSSING)
    [episode] = irsim.benchmark(str(tmp_path / "crossing.yaml")).episodes
    without = yaml.safe_load(CROSSING)
    del without["robot"]
    times = []
    for text in (CROSSING, yaml.safe_dump(without)):
        (tmp_path / "one.yaml").write_text(text)
        env = irsim.make(tmp_path / "one.yaml", headless=True, display=False, log_level="ERROR")
        for _ in range(200):
            env.step()
        first: dict[str, float] = {}
        for event in env.events:
            if event.kind == "arrival" and event.object in ("walker", "other"):
                first.setdefault(event.object, event.time)
        times.append(first)
        env.end()
    assert times[0]["walker"] > times[1]["walker"]  # it had to go round
    assert times[0]["other"] == times[1]["other"]
    expected = (times[0]["walker"] - times[1]["walker"]) / 2
    assert episode.metrics["pedestrian_delay"] == pytest.approx(expected)


def test_nobody_to_delay(tmp_path: Path) -> None:
    (tmp_path / "alone.yaml").write_text(CROSSING.partition("obstacle")[0])
    [episode] = irsim.benchmark(str(tmp_path / "alone.yaml")).episodes
    for key in ("pedestrian_delay", "social_work", "group_collision_rate", "pedestrian_velocity_avg"):
        assert episode.metrics[key] is None
