"""The policies that ship with irsim: what they reach in the scenes of their tasks, and their cards."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import irsim
from irsim.cli.app import app
from irsim.learning.tasks.files import TASKS, open_task
from irsim.learning.tasks.scene import scenario_text
from irsim.lookup.topics import lookup
from irsim.policies.description import describe_policy
from irsim.policies.trained import trained_policies, trained_policy
from irsim.scenario.perturbation import perturbation_text

RECIPES = Path(irsim.__file__).parents[1] / "skills" / "irsim-runner" / "recipes"
LEAST = {
    "goal_lidar": 0.9,
    "goal_lidar_noisy": 0.8,
    "crowd": 0.9,
    "corridor_social": 0.9,
    "multi_robot": 0.9,
    "multi_robot_freeze": 0.75,
    "multi_robot_v2": 0.7,
    "sarl": 0.9,
    "rl_rvo": 0.7,
    "sarl_multi_robot": 0.75,
}
"""Success that each must reach in 20 scenes that it was not trained on; in all it has reached more."""

TRAINED_ON = {"sarl": "sarl_circle"}
"""Name of a policy -> task that it was trained on, where the names differ."""


@pytest.mark.slow(15)
@pytest.mark.parametrize("name", trained_policies())
def test_it_reaches_its_success_in_scenes_of_its_task(name: str) -> None:
    task, folder = open_task(TRAINED_ON.get(name, name))
    spreads = "; ".join(perturbation_text(one) for one in task.perturb) or None
    scene = scenario_text(task, folder)
    [row] = irsim.benchmark(scene, policies=[name], seeds=20, perturb=spreads, workers=1).rows
    assert row.success.rate >= LEAST[name]


@pytest.mark.parametrize("name", trained_policies())
def test_its_card_and_curve_are_those_of_the_file_and_a_lookup_tells_what_it_is_for(name: str) -> None:
    file = trained_policy(name)
    assert file.stat().st_size < 1_000_000
    card = (RECIPES / f"{name}.md").read_text(encoding="utf-8")
    assert hashlib.sha256(file.read_bytes()).hexdigest() in card
    assert f"![learning curve]({name}.png)" in card
    assert (RECIPES / f"{name}.png").is_file()
    assert f"[{name}]({name}.md)" in (RECIPES / "README.md").read_text(encoding="utf-8")
    answer = lookup(f"policy {name}")
    facts = {key.name: key.text for key in answer.groups["facts"]}
    assert (answer.kind, answer.topic) == ("policy", name)
    assert facts["trained on"].split()[0] in {*TASKS.names()}
    assert facts["license"] == "MIT"
    assert name in (answer.example or "")
    if name != "crowd":  # a template has that name
        assert lookup(name.upper().replace("_", "-")) == answer


def test_a_name_that_a_suite_gives_leads_to_the_policy() -> None:
    answer = lookup("PPO")
    assert answer.topic == "multi_robot"
    assert "The suite mixed_v2 calls it ppo." in answer.text


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
    told = describe_policy("sarl")
    assert (told.kind, told.output, told.needs) == ("trained", "velocity", ["5 nearest neighbors"])
    assert (told.drives, told.decision_dt, told.facts["parameters"]) == (["any"], 0.25, 96_502)
    assert told.facts["card"]["license"] == "MIT"
    shown = CliRunner().invoke(app, ["policies", "sarl"])
    assert shown.exit_code == 0
    assert "the best of 81 velocities, 0.25 s ahead" in " ".join(shown.output.split())


def test_it_crosses_a_circle_of_people_in_the_command() -> None:
    scene = "crowdnav_circle_v1/circle-invisible-5"
    made = CliRunner().invoke(app, ["run", scene, "--seed", "1000", "--policy", "sarl"])
    assert made.exit_code == 0, made.output
    assert "success" in made.output


def test_benchmarks_have_a_row_of_it() -> None:
    """ORCA fails in each of these scenes."""
    scene = scenario_text(*open_task("sarl_circle"))
    orca = "{name: orca, timeHorizon: 5, safe_radius: 0.01, responsibility: 0.5, approach_time: 1}"
    mine, theirs = irsim.benchmark(scene, policies=["sarl", orca], seeds="1000-1003", workers=1).rows
    assert (mine.behavior, mine.success.count, theirs.success.count) == ("sarl", 4, 0)


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
    assert [(robot.arrive, robot.collision) for robot in env.robot_list] == [(True, False)] * 4
    env.end()


@pytest.mark.parametrize(("step_time", "every"), [(0.1, 3), (0.25, 1), (0.05, 5)])
def test_its_decisions_are_rounded_to_whole_steps(make: Any, step_time: float, every: int) -> None:
    """With a step of 0.1 s, 0.25 s become three steps."""
    text = ROBOTS.replace("name: diff", "name: omni").replace("[1, 3]", "[1, 1]").replace("[-1, -3]", "[-1, -1]")
    env = make(text.replace("step_time: 0.1", f"step_time: {step_time}"), seed=0, policy="sarl")
    velocities = []
    for _ in range(40):
        env.step()
        velocities.append(env.simulation.twist[:, :2].copy())
    changes = [k for k in range(1, 40) if not np.allclose(velocities[k], velocities[k - 1], atol=1e-9)]
    assert {k % every for k in changes} == {0}
