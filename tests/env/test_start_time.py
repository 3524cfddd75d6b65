"""`start_time`: objects that begin to move later."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import irsim

Make = Callable[..., Any]
TEXT = """
world: {width: 10, height: 10, step_time: 0.1}
robot:
  - {number: 3, state: [[1, 1, 0], [1, 3, 0], [1, 5, 0]], goal: [[9, 1], [9, 3], [9, 5]], kinematics: {name: diff},
     shape: {name: circle, radius: 0.2}, behavior: {name: dash}, velocity: [0.5, 0], start_time: [0, 1.0, 2.55]}
obstacle:
  - {kinematics: {name: omni}, shape: {name: circle, radius: 0.2}, state: [1, 8, 0], goal: [9, 8],
     behavior: {name: dash}, start_time: 0.3}
"""


def first_moves(env: Any, steps: int = 40) -> list[int]:
    """Number of the step in which each object first moved."""
    start = np.array([view.state[:2, 0] for view in env.objects])
    first_steps = [0] * len(start)
    for step in range(1, steps + 1):
        env.step()
        for index, view in enumerate(env.objects):
            if not first_steps[index] and (view.state[:2, 0] != start[index]).any():
                first_steps[index] = step
    return first_steps


def test_objects_move_from_their_start_time_on(make: Make) -> None:
    env = make(TEXT)
    assert first_moves(env) == [1, 11, 27, 4]
    env.reset()
    assert env.robot_list[2].velocity[:, 0].tolist() == [0, 0], "it stands although it has an initial velocity"
    assert first_moves(env) == [1, 11, 27, 4]


def test_commands_do_not_move_an_object_before_its_start_time(make: Make) -> None:
    env = make(TEXT)
    for _ in range(10):
        env.step({"robot_1": [1.0, 0.0]})
    assert env.get_object_by_name("robot_1").state[:, 0].tolist() == [1, 3, 0]
    env.step({"robot_1": [1.0, 0.0]})
    assert env.get_object_by_name("robot_1").state[0, 0] == pytest.approx(1.1)


def test_a_waiting_object_is_seen_and_hit(make: Make) -> None:
    env = make("""
world: {width: 10, height: 10}
robot:
  - {state: [1, 1, 0], goal: [9, 1], kinematics: {name: diff}, shape: {name: circle, radius: 0.2},
     behavior: {name: dash}, sensors: [{name: lidar2d, number: 1}]}
  - {state: [3, 1, 0], goal: [9, 1], kinematics: {name: diff}, shape: {name: circle, radius: 0.2},
     behavior: {name: dash}, start_time: 60}
""")
    assert env.robot.lidar.range_data[0] == pytest.approx(1.8)
    for _ in range(30):
        env.step()
    assert [view.collision for view in env.robot_list] == [True, True]


def test_batches_and_rollouts_equal_single_steps(make: Make, tmp_path: Path) -> None:
    env, path = make(TEXT), tmp_path / "late.yaml"
    path.write_text(TEXT)
    rollout = make(TEXT).rollout(40, until_done=False)
    batch = irsim.batch(path, 2, seeds=[0, 1])
    for step in range(40):
        env.step()
        batch.step()
        assert (np.asarray(rollout.pose)[step + 1 - (len(rollout.pose) == 40)] == env.simulation.pose).all()
        assert (np.array(batch.pose[1]) == env.simulation.pose).all()


def test_perturbed_starts_are_delayed_from_the_start_time_on(make: Make, tmp_path: Path) -> None:
    path = tmp_path / "late.yaml"
    path.write_text(TEXT)
    plain = irsim.run(path, seed=1)
    late = irsim.run(path, seed=1, perturb="delay=2,objects=robot_1")
    times = [{robot.name: robot.time_to_goal for robot in result.robots} for result in (plain, late)]
    assert times[1]["robot_1"] > times[0]["robot_1"] >= 1.0 + 7.8
    assert times[1]["robot_2"] == times[0]["robot_2"]


def test_the_time_limit_and_the_summary_know_the_start_time(tmp_path: Path) -> None:
    path = tmp_path / "late.yaml"
    path.write_text(TEXT.replace("2.55", "100"))
    assert irsim.run(path).outcome == "success", "the default limit counts from the start"
    short = irsim.run(path, steps=50)
    assert "'robot_2' had not started (start_time 100 s)" in short.summary
    assert "'robot_2' still waits 8.00 m from its goal (it starts at 100 s)" in str(short.reason)
    path.write_text(TEXT.replace("2.55", "100").replace("step_time: 0.1", "step_time: 0.1, time_limit: 60"))
    findings = irsim.validate(path).findings
    assert [(f.code, "start_time" in f.message) for f in findings if f.severity != "hint"] == [("time-too-short", True)]


def test_waiting_objects_are_drawn_pale_until_they_start(make: Make) -> None:
    from irsim.objects.drawing.scene_builder import SceneBuilder

    env = make(TEXT)
    builder = SceneBuilder(env.simulation)

    def pale() -> list[bool]:
        bodies = [mark for mark in builder.build().marks if mark.part == "body"]
        return [mark.alpha < 1 for mark in sorted(bodies, key=lambda mark: mark.object)]

    assert pale() == [False, True, True, True]
    for _ in range(12):
        env.step()
    assert pale() == [False, False, True, False]


def test_a_negative_start_time_is_an_error() -> None:
    findings = irsim.validate(text=TEXT.replace("start_time: 0.3", "start_time: -1")).findings
    assert ("error", "obstacle[0].start_time") in {(f.severity, f.path) for f in findings}
    renamed = irsim.validate(text=TEXT.replace("start_time: 0.3", "delay: 0.3")).findings
    assert any("start_time" in str(f.fix) for f in renamed if f.code == "unknown-key")
