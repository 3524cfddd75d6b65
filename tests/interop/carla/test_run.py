"""``irsim run`` with a stand-in (not CARLA): whole episodes, and a policy that sees by CARLA's lidar."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner, Result

import irsim
from irsim.cli.app import app
from irsim.policies import FunctionPolicy, Needs, Observations
from tests.interop.carla.conftest import ROOT, StandIn
from tests.interop.carla.scenes import CROWD, in_town

pytestmark = pytest.mark.interop
HALL = """
world: {{width: 16, height: 10, step_time: 0.1, time_limit: 40, control_mode: auto}}
robot:
  - name: cart
    kinematics: {{name: diff}}
    shape: {{name: circle, radius: 0.3}}
    state: [1, 5, 0]
    goal: [15, 5, 0]
    vel_max: [1.5, 1.5]
    vel_min: [-1.5, -1.5]
    sensors: [{{name: lidar2d, number: 181, range_max: 8}}]
"""
BRIDGE = """
bridges:
  - {{name: carla, port: {port}, transform: {{x: 30, y: 40, yaw: 110}}, vehicles: [cart], command: velocity,
     vehicle_blueprint: vehicle.micro.microlino, lidar: {{}}}}
"""
PLACE = (30.0, 40.0, 110.0)
BAR = np.array([[7.0, 3.0], [7.0, 6.0]])
"""A wall across the way, which only the town has."""


def seek(observations: Observations) -> Any:
    """Drive to the goal, in the direction nearest to it in which 1.5 m are free."""
    assert observations.scan is not None
    controls = []
    for row in range(len(observations.pose)):
        away = observations.goal[row, :2] - observations.pose[row, :2]
        bearing = np.arctan2(away[1], away[0]) - observations.pose[row, 2]
        bearing = np.arctan2(np.sin(bearing), np.cos(bearing))
        angles, ranges = observations.scan.angles, observations.scan.ranges[row]
        wide = int(1.0 / (angles[1] - angles[0]))
        free = np.array([ranges[max(0, i - wide) : i + wide + 1].min() > 1.5 for i in range(len(angles))])
        wanted = angles[np.argmin(np.where(free, np.abs(angles - bearing), 9.0))] if free.any() else 1.5
        controls.append([0.8 if abs(wanted) < 0.8 else 0.2, np.clip(2 * wanted, -1.5, 1.5)])
    return np.array(controls)


def _policy() -> FunctionPolicy:
    return FunctionPolicy(seek, output="control", needs=Needs(scan=True))


def test_a_policy_drives_a_vehicle_around_what_only_the_town_has(
    stand_in: Callable[..., StandIn], tmp_path: Path
) -> None:
    path = tmp_path / "hall.yaml"
    path.write_text(HALL.format())
    straight = irsim.run(path, policy=_policy(), record=tmp_path / "straight")
    assert straight.outcome == "success"
    alone = irsim.runs.open_run(tmp_path / "straight").trace().pose[:, 0]
    assert np.abs(alone[:, 1] - 5).max() < 0.1  # nothing is in its way there

    town = stand_in(walls=[in_town(BAR[:, 0], BAR[:, 1], PLACE).tolist()])
    path.write_text(HALL.format() + BRIDGE.format(port=town.port))
    result = irsim.run(path, policy=_policy(), record=tmp_path / "around")
    assert result.outcome == "success"
    pose = irsim.runs.open_run(tmp_path / "around").trace().pose[:, 0]
    beside = float(np.interp(7.0, pose[:, 0], pose[:, 1]))
    assert max(3 - beside, beside - 6) > 0.3  # its radius
    driven = town.path_of("cart")
    np.testing.assert_allclose(driven[-1, :2], in_town(pose[-1, 0], pose[-1, 1], PLACE), atol=1e-3)
    assert [event["blueprint"] for event in town.events("spawn")] == [
        "vehicle.micro.microlino",
        "sensor.lidar.ray_cast",
    ]
    town.check_clean()


def _scene(folder: Path, port: int) -> Path:
    path = folder / "crowd.yaml"
    path.write_text(CROWD.format(port=port, timeout=2, more=""))
    return path


def _invoke(*words: str) -> Result:
    return CliRunner().invoke(app, ["run", *words])


def test_irsim_run(stand_in: Callable[..., StandIn], tmp_path: Path) -> None:
    town = stand_in()
    result = _invoke(str(_scene(tmp_path, town.port)), "--json", "--steps", "40")
    assert json.loads(result.stdout)["steps"] == 40
    assert len(town.path_of("guide")) >= 40
    town.check_clean()


def test_irsim_run_ends_when_the_server_dies(stand_in: Callable[..., StandIn], tmp_path: Path) -> None:
    town = stand_in(die_after=30)
    result = _invoke(str(_scene(tmp_path, town.port)), "--json")
    answer = json.loads(result.stdout)
    assert "did not answer" in answer["lost"]
    assert 0 < answer["steps"] < 30


def test_irsim_run_without_a_server(tmp_path: Path) -> None:
    pytest.importorskip("carla")
    result = _invoke(str(_scene(tmp_path, 9)))
    assert result.exit_code in (1, 2)
    assert "CarlaUE4.sh" in " ".join(result.output.split())


def test_ctrl_c_ends_irsim_run(stand_in: Callable[..., StandIn], tmp_path: Path) -> None:
    town = stand_in()
    command = [sys.executable, "-m", "irsim", "run", str(_scene(tmp_path, town.port)), "--steps", "1000000"]
    process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    deadline = time.monotonic() + 60
    while len(town.events("batch")) < 5 and time.monotonic() < deadline:
        time.sleep(0.1)
    os.kill(process.pid, signal.SIGINT)
    process.communicate(timeout=20)
    assert process.returncode != 0
    town.check_clean()
