"""The guide of ``irsim-runner`` to learning: its task is valid, its files and names are there."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import yaml

from irsim.learning import VectorEnv
from irsim.learning.tasks.files import TASKS
from irsim.learning.tasks.report import task_report
from tests.skills.conftest import fences

SKILL = Path(__file__).parents[2] / "skills" / "irsim-runner"
GUIDE = (SKILL / "guides" / "learning.md").read_text(encoding="utf-8")
SCENE = {
    "world": {"width": 10, "height": 10, "boundary": "walls", "collision_mode": "stop"},
    "robot": [
        {
            "kinematics": {"name": "diff"},
            "distribution": {"name": "random", "goal_distance": 4},
            "vel_min": [0, -2],
            "vel_max": [1, 2],
            "sensors": [{"name": "lidar2d", "number": 72}],
        }
    ],
    "obstacle": [{"number": 8, "distribution": {"name": "random"}, "shape": {"name": "circle", "radius": 0.3}}],
}


def test_the_skill_names_the_guide() -> None:
    assert "(guides/learning.md)" in (SKILL / "SKILL.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("with_draws", [False, True])
def test_its_task_is_valid_and_steps(with_draws: bool, tmp_path: Path) -> None:
    task, more = fences(GUIDE, "yaml")
    (tmp_path / "task.yaml").write_text(task + (more if with_draws else ""), encoding="utf-8")
    (tmp_path / "scene.yaml").write_text(yaml.safe_dump(SCENE), encoding="utf-8")
    report = task_report(str(tmp_path / "task.yaml"))
    assert report.valid, report.findings
    env = VectorEnv(tmp_path / "task.yaml", 4)
    _, info = env.reset(seed=0)
    assert ("drawn" in info) == with_draws
    if with_draws:
        assert info["level"].tolist() == [0] * 4
        assert set(info["drawn"]["number.obstacle[0]"].tolist()) <= {0, 1}
        _, info = env.reset(options={"level": 1})
        assert set(info["drawn"]["number.obstacle[0]"].tolist()) <= set(range(2, 9))
    assert env.step(env.action_space.sample())[0].shape == (4, env.worlds.eyes.size)


def test_the_tasks_that_it_names_are_bundled() -> None:
    named = set(re.findall(r"`(goal_lidar|multi_robot|[a-z]+_[a-z]+)`", GUIDE)) & {"goal_lidar", "multi_robot"}
    assert named == {"goal_lidar", "multi_robot"} <= set(TASKS.names())
