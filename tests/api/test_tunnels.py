"""A fast robot and a thin wall, as users wrote them: no way of running them calls a passage an untroubled success."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

import irsim
from irsim.cli.app import app

STOP = """\
world: {width: 20, height: 10, step_time: 0.3, collision_mode: stop, time_limit: 30}
robot:
  - {kinematics: {name: diff}, shape: {name: circle, radius: 0.1}, state: [5.2, 5, 0], goal: [18, 5],
     goal_threshold: 0.3, behavior: {name: dash}, vel_max: [1.5, 1.5], vel_min: [-3, -3]}
obstacle: [{shape: {name: rectangle, length: 0.02, width: 10}, state: [10, 5, 0]}]
"""
"""A step is 0.45 m, the robot 0.2 m plus the wall 0.02 m: at the end of no step the two touch."""
SWEPT = STOP.replace("collision_mode: stop", "collision_mode: stop, contacts: swept")
CONTACT = """\
world: {width: 20, height: 10, step_time: %s, collision_mode: contact, time_limit: 30}
robot:
  - {kinematics: {name: diff}, shape: {name: circle, radius: 0.1}, state: [5.13, 5, 0], goal: [18, 5],
     behavior: {name: dash}, vel_max: [3, 3], vel_min: [-3, -3]}
obstacle: [{shape: {name: rectangle, length: 0.02, width: 10}, state: [10, 5, 0]}]
"""
"""A step of 0.1 s is 0.3 m; the wall stands in the way."""
TOLD = "'robot_0' passed through 'obstacle_1' between two steps at 3.13 s near (9.99, 5.00)"
CURE = "('robot_0' moved 0.45 m in that step; lower step_time, or set world.contacts: swept)"


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The scenario in the current directory."""
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "tunnel-stop.yaml"
    path.write_text(STOP)
    return path


def test_on_the_command_line(file: Path) -> None:
    shown = CliRunner().invoke(app, ["run", file.name, "--record"])
    assert shown.exit_code == 0
    text = " ".join(shown.stdout.split())
    assert f"success: {TOLD} {CURE}; the robot arrived at 8.4 s" in text
    assert "jumps-through" in shown.output
    looked = json.loads(CliRunner().invoke(app, ["inspect", "last", "--view", "collisions", "--json"]).stdout)
    assert [dict(zip(looked["columns"], row, strict=True))["kind"] for row in looked["rows"]] == ["passed_through"]
    assert looked["summary"].startswith(TOLD)


def test_in_python(file: Path) -> None:
    result = irsim.run(file.name)
    assert (result.outcome, result.contacts_between_steps, result.robots[0].passed_through) == (
        "success",
        1,
        ["obstacle_1"],
    )
    assert result.summary.startswith(f"{TOLD} {CURE}; ")
    assert "without touching" not in result.summary
    env = irsim.make(file.name, display=False, headless=True)
    while not env.done():
        env.step()
    assert [event.kind for event in env.events] == ["passed_through", "arrival"]
    env.end(ending_time=0.0)


def test_a_swept_contact_stops_it_at_the_wall(file: Path) -> None:
    file.write_text(SWEPT)
    shown = CliRunner().invoke(app, ["run", file.name, "--require-success"])
    assert shown.exit_code == 1
    assert "'robot_0' hit 'obstacle_1' at 3.13 s near (9.99, 5.00)" in " ".join(shown.stdout.split())
    result = irsim.run(file.name)
    assert (result.outcome, result.contacts_between_steps) == ("collision", 0)
    assert result.robots[0].pose[0] == pytest.approx(9.89, abs=1e-3)  # its radius before the face of the wall


@pytest.mark.parametrize("step_time", [0.1, 0.5, 1])
def test_nothing_passes_in_contact_mode(file: Path, step_time: float) -> None:
    file.write_text(CONTACT % step_time)
    shown = " ".join(CliRunner().invoke(app, ["run", file.name]).stdout.split())
    assert "timeout: the robot did not arrive within 30 s" in shown
    assert "stands still 8.11 m from its goal, and it pushes against 'obstacle_1'" in shown
    result = irsim.run(file.name)
    assert (result.outcome, result.contacts_between_steps) == ("timeout", 0)
    assert result.robots[0].pose[0] == pytest.approx(9.89, abs=1e-3)
    assert "without touching" not in result.summary  # it leans on the wall
