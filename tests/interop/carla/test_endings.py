"""Whole runs with a stand-in (not CARLA), and how they end: nothing is left in the town, whatever fails."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import irsim
from irsim.bridges.base import BridgeError, BridgeLostError
from irsim.cli.app import app
from irsim.policies import FunctionPolicy, Needs, Observations
from tests.interop.carla.conftest import CROWD, StartTown, free_ports, in_town

pytestmark = pytest.mark.interop


def _scene(port: int, more: str = "", timeout: float = 2) -> str:
    Path("crowd.yaml").write_text(CROWD.format(port=port, timeout=timeout, more=more))
    return "crowd.yaml"


def _run(port: int, more: str = "", steps: int = 30) -> None:
    env = irsim.make(_scene(port, more), display=False)
    with irsim.connect(env):
        for _ in range(steps):
            env.step()


def test_a_server_that_is_missing_or_silent(stand_in: StartTown) -> None:
    for port in (free_ports(), stand_in(silent=True).port):
        began = time.monotonic()
        with pytest.raises(BridgeLostError) as caught:
            _run(port)
        assert time.monotonic() - began < 12
        assert f"no CARLA server answers at 127.0.0.1:{port} within 2 s" in str(caught.value)
        assert "CarlaUE4.sh" in str(caught.value)


def test_a_server_of_another_version(stand_in: StartTown) -> None:
    town = stand_in(version="0.9.13")
    with pytest.raises(BridgeError, match=r"has version 0\.9\.13, and the client of this Python 0\.9\.16") as caught:
        _run(town.port)
    assert "pip install carla==0.9.13" in str(caught.value)
    assert town.events("settings") == []
    _run(town.port, ", any_version: true", steps=2)
    town.check_clean()


def test_actors_that_were_spawned_before_a_failure_are_destroyed(stand_in: StartTown) -> None:
    town = stand_in(full=2)
    with pytest.raises(BridgeError, match="there is no room in the town for 'obstacle_2'"):
        _run(town.port)
    assert len(town.events("spawn")) == 2
    assert len(town.events("refused")) == 4  # from four heights
    town.check_clean()


def test_an_exception_in_the_loop(stand_in: StartTown) -> None:
    town = stand_in()
    env = irsim.make(_scene(town.port), display=False)

    def loop() -> None:
        with irsim.connect(env):
            env.step()
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        loop()
    town.check_clean()


@pytest.mark.parametrize("facts", [{"die_after": 80}, {"hang_after": 80}])
def test_a_server_that_dies_ends_the_run(stand_in: StartTown, facts: dict[str, int]) -> None:
    town = stand_in(**facts)
    env = irsim.make(_scene(town.port), display=False)
    began = time.monotonic()

    def loop() -> None:
        with irsim.connect(env):
            for _ in range(1000):
                env.step()

    with pytest.raises(BridgeLostError) as caught:
        loop()
    assert caught.value.code == "bridge-lost"
    assert 0 < env.simulation.count[0] < 1000
    assert time.monotonic() - began < 15
    assert "did not answer" in str(caught.value)


def test_another_client_may_tick(stand_in: StartTown) -> None:
    town = stand_in(fixed=0.05)
    env = irsim.make(_scene(town.port, ", clock: external"), display=False)
    with irsim.connect(env) as connection:
        for _ in range(10):
            env.step()
        (bridge,) = connection.bridges
        assert 10 <= bridge.ticks <= 21  # a step has two; irsim does not wait for ticks that pass while it computes
    assert town.events("settings") == []
    assert town.left() == set()
    walked = [e for e in town.events("batch") if 4 in e["kinds"]]
    assert 15 <= walked[-1]["frame"] - walked[0]["frame"] <= 25


HALL = """
world: {width: 16, height: 10, step_time: 0.1, time_limit: 40, control_mode: auto}
robot:
  - {name: cart, kinematics: {name: diff}, shape: {name: circle, radius: 0.3}, state: [1, 5, 0], goal: [15, 5, 0],
     vel_max: [1.5, 1.5], vel_min: [-1.5, -1.5], sensors: [{name: lidar2d, number: 181, range_max: 8}]}
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


POLICY = FunctionPolicy(seek, output="control", needs=Needs(scan=True))


def test_a_policy_drives_a_vehicle_around_what_only_the_town_has(stand_in: StartTown) -> None:
    straight = irsim.run(text=HALL, policy=POLICY, record="straight")
    assert straight.outcome == "success"
    alone = irsim.runs.open_run("straight").trace().pose[:, 0]
    assert np.abs(alone[:, 1] - 5).max() < 0.1  # nothing is in its way there

    town = stand_in(walls=[in_town(BAR[:, 0], BAR[:, 1], PLACE).tolist()])
    result = irsim.run(text=HALL + BRIDGE.format(port=town.port), policy=POLICY, record="around")
    assert result.outcome == "success"
    pose = irsim.runs.open_run("around").trace().pose[:, 0]
    beside = float(np.interp(7.0, pose[:, 0], pose[:, 1]))
    assert max(3 - beside, beside - 6) > 0.3  # its radius
    driven = town.path_of("cart")
    np.testing.assert_allclose(driven[-1, :2], in_town(pose[-1, 0], pose[-1, 1], PLACE), atol=1e-3)
    spawned = [event["blueprint"] for event in town.events("spawn")]
    assert spawned == ["vehicle.micro.microlino", "sensor.lidar.ray_cast"]
    town.check_clean()


def test_irsim_run(stand_in: StartTown) -> None:
    town = stand_in()
    result = CliRunner().invoke(app, ["run", _scene(town.port), "--json", "--steps", "40"])
    assert json.loads(result.stdout)["steps"] == 40
    assert len(town.path_of("guide")) >= 40
    town.check_clean()


def test_ctrl_c_ends_irsim_run(stand_in: StartTown) -> None:
    town = stand_in()
    command = [sys.executable, "-m", "irsim", "run", _scene(town.port), "--steps", "1000000"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    deadline = time.monotonic() + 60
    while len(town.events("batch")) < 5 and time.monotonic() < deadline:
        time.sleep(0.1)
    os.kill(process.pid, signal.SIGINT)
    process.communicate(timeout=20)
    assert process.returncode != 0
    town.check_clean()
