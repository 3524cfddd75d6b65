"""The pages of ``irsim-runner`` about bridges, recorded pedestrians and learning: what they say works as written."""

from __future__ import annotations

import json
import re
import shlex
import socket
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

from irsim.cli.app import app
from irsim.learning import VectorEnv
from irsim.learning.tasks.files import TASKS
from irsim.options.registry import BRIDGES
from irsim.validation.file_reports import task_report
from tests.bridges import crowds
from tests.cli.conftest import ROOM
from tests.skills.conftest import ROOT, fences

SKILL = ROOT / "skills" / "irsim-runner"
FOLDER = SKILL / "bridges"
OVERVIEW = (FOLDER / "overview.md").read_text(encoding="utf-8")
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


def test_a_program_of_any_kind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    [_, program] = fences(OVERVIEW, "python")
    [command] = fences(OVERVIEW, "bash")
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = str(free.getsockname()[1])
    (tmp_path / "driver.py").write_text(program.replace("9100", port))
    (tmp_path / "hall.yaml").write_text(ROOM)
    with subprocess.Popen([sys.executable, "driver.py"]) as driver:
        try:
            wait_for(port)
            words = shlex.split(command.replace("9100", port))[1:]
            done = CliRunner().invoke(app, [*words, "--steps", "30", "--json"])
            assert done.exit_code == 0, done.output
            assert driver.wait(10) == 0
        finally:
            driver.kill()
    [robot] = json.loads(done.stdout)["robots"]
    assert robot["path_length"] == pytest.approx(1.53, abs=0.03), (
        "half a meter per second, after a first step of its own"
    )


def wait_for(port: str) -> None:
    """Wait until something listens, without connecting to it."""
    for _ in range(200):
        listening = Path("/proc/net/tcp").read_text() if sys.platform == "linux" else ""
        if not listening or f":{int(port):04X} 00000000:0000 0A" in listening:
            return
        time.sleep(0.05)
    raise AssertionError("the port does not listen")


def test_the_loop_with_connections_is_right(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "hall.yaml").write_text(ROOM)
    [loop, _] = fences(OVERVIEW, "python")
    seen: dict[str, Any] = {}
    exec(loop, seen)
    assert seen["env"].outcome == "success"


def test_every_bridge_has_a_page_that_says_what_was_not_run() -> None:
    pages = {page.stem: page.read_text(encoding="utf-8") for page in FOLDER.glob("*.md")}
    for name in BRIDGES.names():
        assert any(f"name: {name}" in text or f"`{name}`" in text for text in pages.values()), name
    for name, text in pages.items():
        if name != "overview":
            assert "not run" in text.lower(), f"{name}.md does not say what was not run"
            assert "hecklist" in text, f"{name}.md has no checklist"


def test_the_commands_about_recorded_pedestrians_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "obsmat.txt").write_text(crowds.obsmat())
    (tmp_path / "crowd.vsp").write_text(crowds.vsp())
    np.savetxt(tmp_path / "H.txt", np.array([[0.02, 0, -7.2], [0, -0.02, 5.76], [0, 0, 1]]))
    commands = [
        line
        for block in fences((FOLDER / "pedestrians.md").read_text(encoding="utf-8"), "bash")
        for line in block.splitlines()
    ]
    assert len(commands) == 9
    commands = [f"{command} --seeds 2" if command.startswith("irsim benchmark") else command for command in commands]
    for command in commands:
        done = CliRunner().invoke(app, shlex.split(command)[1:])
        assert done.exit_code == 0, (command, done.output)
    texts = {path.stem: path.read_text() for path in tmp_path.glob("*.yaml")}
    assert set(texts) == {"crowd", "crowd_suite", "zara", "corner", "part", "people", "short"}
    assert "robot:" not in texts["people"]
    places = [text[text.index("poses:") :].split("]")[0] for text in (texts["zara"], texts["corner"])]
    first = [np.array([float(v) for v in text.split("[[")[1].split(",")]) for text in places]
    np.testing.assert_allclose(*first, atol=1e-9)


def test_the_skill_names_the_guide_to_learning() -> None:
    assert "(guides/learning.md)" in (SKILL / "SKILL.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("with_draws", [False, True])
def test_the_task_of_the_guide_is_valid_and_steps(with_draws: bool, tmp_path: Path) -> None:
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


def test_the_tasks_that_the_guide_names_are_bundled() -> None:
    named = set(re.findall(r"`(goal_lidar|multi_robot|[a-z]+_[a-z]+)`", GUIDE)) & {"goal_lidar", "multi_robot"}
    assert named == {"goal_lidar", "multi_robot"} <= set(TASKS.names())
