"""`perceives` in scenarios: outcomes, metrics, records, policies, learners and behaviors of user code."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim
from irsim.learning import Worlds
from irsim.policies import FunctionPolicy, Needs
from irsim.runs.audit.audit import audit_runs
from tests.learning.tasks import task

SCENE = """
world: {width: 12, height: 12}
robot:
  - kinematics: {name: omni}
    shape: {name: circle, radius: 0.2}
    state: [1, 6, 0]
    WAY
    goal_threshold: 0.3
    behavior: {name: BEHAVIOR}
    sensors: [{name: localization, position_std: STD, heading_std: 0, time: 1000000}, {name: detector, SEES}]
    perceives: PERCEIVES
obstacle:
  - {name: walker, kinematics: {name: omni}, shape: {name: circle, radius: 0.3}, state: [8, 3, 0], goal: [8, 11],
     vel_max: [0.4, 0.4], behavior: {name: dash}}
"""


def text(
    behavior: str = "orca", std: float = 0.0, perceives: str = "both", way: str = "goal: [10, 6]", sees: str = ""
) -> str:
    words = {"BEHAVIOR": behavior, "STD": str(std), "PERCEIVES": perceives, "WAY": way, "SEES": sees or "keep: 1"}
    scene = SCENE
    for word, value in words.items():
        scene = scene.replace(word, value)
    return scene


def test_a_belief_that_is_wrong_fails_in_truth_and_succeeds_in_belief(workspace: Path) -> None:
    wrong, right = irsim.run(text=text(std=1.5), seed=1), irsim.run(text=text(), seed=1)
    assert (wrong.outcome, right.outcome) == ("timeout", "success")
    assert wrong.robots[0].distance_to_goal is not None
    assert wrong.robots[0].distance_to_goal > 0.3
    assert wrong.reason is not None
    assert "where it believes its goal to be" in wrong.reason
    assert "when all robots rested" in wrong.reason
    assert wrong.sim_time < 30  # it is not the time limit that ends the run


def test_metrics_tell_success_in_belief(workspace: Path) -> None:
    scenes = {"right": text(), "wrong": text(std=1.5), "plain": text(perceives="truth")}
    for name, scene in scenes.items():
        (workspace / f"{name}.yaml").write_text(scene)
    [right, wrong, plain] = [irsim.benchmark(f"{name}.yaml", seeds=[1]).episodes[0].metrics for name in scenes]
    assert [right["success"], right["success_in_belief"]] == [1, 1]
    assert [wrong["success"], wrong["success_in_belief"]] == [0, 1]
    assert [plain["success"], plain["success_in_belief"]] == [1, None]


@pytest.mark.parametrize("way", ["goal: [10, 6]", "waypoints: [[4, 8], [7, 6], [10, 6]]"])
@pytest.mark.parametrize("std", [0.0, 0.4])
def test_an_audit_agrees_with_runs_by_belief(workspace: Path, way: str, std: float) -> None:
    irsim.run(text=text(std=std, way=way), seed=2, record="kept")
    [audited] = audit_runs(["kept"]).runs
    assert audited.equal, audited.findings


def test_the_record_of_a_belief_repeats_bit_for_bit(workspace: Path) -> None:
    for name in ("one", "two"):
        irsim.run(text=text(std=0.3, sees="probability: 0.5, false_tracks: 1"), seed=4, record=name)
    assert irsim.diff_runs("one", "two").same


def test_a_policy_sees_what_its_robot_believes(make: Callable[..., Any]) -> None:
    seen = []

    def act(observations: Any) -> Any:
        seen.append(observations)
        return np.zeros((len(observations), 2))

    policy = FunctionPolicy(act, needs=Needs(neighbors=2))
    env = make(text(std=0.5, perceives="both", sees="position_std: 0.2"), seed=3, policy=policy)
    believed = [env.robot.sensors[0].read()[key] for key in ("x", "y", "theta")]
    track = env.robot.sensors[1].read()["tracks"][0]
    env.step()
    [observed] = seen
    assert observed.pose[0] == pytest.approx(believed)
    assert math.dist(believed[:2], (1, 6)) > 0.1
    there = observed.neighbors.position[0, 0] - observed.pose[0, :2]
    assert there == pytest.approx([track["x"], track["y"]])
    assert there != pytest.approx([7, -3], abs=1e-3)


def test_a_learner_observes_its_belief_and_is_rewarded_for_the_truth() -> None:
    sensors = [{"name": "localization", "position_std": 0.5, "heading_std": 0.0, "time": 1e6}]
    true, believed = (
        Worlds(task({"sensors": sensors, "perceives": word, "behavior": None}), 1, seed=5)
        for word in ("truth", "estimate")
    )
    action = np.array([[1.0, 0.0]])
    for _ in range(3):
        steps = [worlds.advance(action) for worlds in (true, believed)]
    assert not np.allclose(steps[0].seen, steps[1].seen, atol=1e-3)
    assert steps[0].result.reward == pytest.approx(steps[1].result.reward)
    assert np.array_equal(true.simulation.pose, believed.simulation.pose)


def test_behaviors_of_user_code_see_a_belief(make: Callable[..., Any]) -> None:
    from irsim.lib import register_behavior

    told = []

    @register_behavior("omni", "tells-its-belief")
    def tell(ego_object: Any, external_objects: Any, **kwargs: Any) -> list[float]:
        told.append((ego_object.state[:2, 0].copy(), [other.state[:2, 0].copy() for other in external_objects]))
        return [0.0, 0.0]

    env = make(text(behavior="tells-its-belief", std=0.5, sees="range_max: 3"), seed=3)
    env.step()
    [(itself, others)] = told
    assert math.dist(itself, (1, 6)) > 0.1
    assert np.isnan(others).all() or others == []  # the walker is out of reach
    assert env.robot.state[:2, 0] == pytest.approx([1, 6])


def test_a_missing_sensor_is_one_error_with_a_fix(workspace: Path) -> None:
    (workspace / "scene.yaml").write_text(
        text()
        .replace("{name: localization, ", "{name: gnss, ")
        .replace(", heading_std: 0, time: 1000000", "")
        .replace("position_std", "std")
    )
    report = irsim.validate("scene.yaml")
    [problem] = [finding for finding in report.findings if finding.severity == "error"]
    assert (problem.code, problem.line) == ("perceives-without-sensor", 11)
    assert problem.fix == "add {name: localization} to its sensors, or write 'perceives: truth'"
