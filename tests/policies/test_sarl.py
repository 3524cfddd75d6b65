"""The trained policy ``sarl`` in the command, in Python and in benchmarks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import irsim
from irsim.cli.app import app
from irsim.learning.tasks.files import open_task
from irsim.learning.tasks.scene import scenario_text
from irsim.policies.description import describe_policy

ROBOTS = """
world: {width: 10, height: 10, step_time: 0.1, time_limit: 40}
robot:
  - number: 4
    kinematics: {name: diff}
    distribution: {name: circle, radius: 4}
    shape: {name: circle, radius: 0.2}
    vel_max: [1, 3]
    vel_min: [-1, -3]
    goal_threshold: 0.3
"""


def test_it_says_what_it_is() -> None:
    found = describe_policy("sarl")
    assert (found.kind, found.output, found.needs, found.drives) == (
        "trained", "velocity", ["5 nearest neighbors"], ["any"]
    )  # fmt: skip
    assert found.decision_dt == 0.25
    assert found.facts["parameters"] == 96_502
    assert found.facts["card"]["license"] == "MIT"
    shown = CliRunner().invoke(app, ["policies", "sarl"])
    assert shown.exit_code == 0
    assert "the best of 81 velocities, 0.25 s ahead" in " ".join(shown.output.split())


def test_it_crosses_a_circle_of_people_in_the_command() -> None:
    scene = "crowdnav_circle_v1/circle-invisible-5"
    made = CliRunner().invoke(app, ["run", scene, "--seed", "1000", "--policy", "sarl"])
    assert made.exit_code == 0, made.output
    assert "success" in made.output


def test_benchmarks_have_a_row_of_it(tmp_path: Path) -> None:
    """ORCA fails in each of these scenes."""
    scene = tmp_path / "scene.yaml"
    scene.write_text(scenario_text(*open_task("sarl_circle")))
    orca = "{name: orca, timeHorizon: 5, safe_radius: 0.01, responsibility: 0.5, approach_time: 1}"
    found = irsim.benchmark(scene, policies=["sarl", orca], seeds="1000-1003", workers=1)
    mine, theirs = found.rows
    assert mine.behavior == "sarl"
    assert (mine.success.count, theirs.success.count) == (4, 0)


def test_robots_with_a_differential_drive_cross_each_other(tmp_path: Path) -> None:
    scene = tmp_path / "scene.yaml"
    scene.write_text(ROBOTS)
    env = irsim.make(scene, headless=True, seed=0, policy="sarl")
    batch = irsim.batch(scene, 2, seeds=[1, 0], policy="sarl")
    for _ in range(400):
        env.step()
        batch.step()
        if env.done():
            break
    assert batch.pose[1].tobytes() == env.simulation.pose.tobytes()
    assert all(robot.arrive for robot in env.robot_list)
    assert not any(robot.collision for robot in env.robot_list)
    env.end()


@pytest.mark.parametrize(("step_time", "every"), [(0.1, 3), (0.25, 1), (0.05, 5)])
def test_its_decisions_are_rounded_to_whole_steps(tmp_path: Path, step_time: float, every: int) -> None:
    """With a step of 0.1 s, 0.25 s become three steps."""
    scene = tmp_path / "scene.yaml"
    text = ROBOTS.replace("name: diff", "name: omni").replace("[1, 3]", "[1, 1]").replace("[-1, -3]", "[-1, -1]")
    scene.write_text(text.replace("step_time: 0.1", f"step_time: {step_time}"))
    env = irsim.make(scene, headless=True, seed=0, policy="sarl")
    velocities = []
    for _ in range(40):
        env.step()
        velocities.append(env.simulation.twist[:, :2].copy())
    changes = [k for k in range(1, 40) if not np.allclose(velocities[k], velocities[k - 1], atol=1e-9)]
    assert changes
    assert all(k % every == 0 for k in changes)
    env.end()
