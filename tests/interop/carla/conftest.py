"""A stand-in of the server (not CARLA) in a process of its own, for the official client, and scenarios in its town."""

from __future__ import annotations

import json
import math
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[3]


class StandIn:
    """A stand-in that listens, whose town has the facts that ``standin/server.py`` reads."""

    def __init__(self, facts: dict[str, Any], folder: Path) -> None:
        for _ in range(3):  # another process may take the port first
            if self._start(facts, folder):
                return
        raise AssertionError(self.said)

    def _start(self, facts: dict[str, Any], folder: Path) -> bool:
        self.port = free_ports()
        self.log = folder / f"standin-{self.port}.jsonl"
        given = folder / f"facts-{self.port}.json"
        given.write_text(json.dumps(facts))
        command = [sys.executable, "-m", "tests.interop.carla.standin", "--port", str(self.port)]
        command += ["--facts", str(given), "--log", str(self.log)]
        self.process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        assert self.process.stdout is not None
        self.said = self.process.stdout.readline()
        if "listening" in self.said:
            return True
        self.said += self.process.communicate()[0]
        return False

    def events(self, what: str | None = None) -> list[dict[str, Any]]:
        """The events so far, all or of one kind."""
        lines = self.log.read_text().splitlines()
        events = [json.loads(line) for line in lines if line.endswith("}")]
        return [event for event in events if what is None or event["what"] == what]

    def left(self) -> set[int]:
        """Ids of the actors that were spawned and not destroyed."""
        return {e["id"] for e in self.events("spawn")} - {e["id"] for e in self.events("destroy")}

    def check_clean(self) -> None:
        """Everything is destroyed, and the settings are as at the start."""
        deadline = time.monotonic() + 5
        while self.left() and time.monotonic() < deadline:
            time.sleep(0.05)
        assert self.events("spawn")
        assert self.left() == set()
        settings = [event["settings"] for event in self.events("settings")]
        assert settings[0][0] is True
        assert settings[-1] == [False, False, [False], True, 0.01, 10, 0.0, True, 3000.0, 2000.0, True]
        assert not self.events("unknown")

    def actor_of(self, name: str) -> int:
        """Id of the actor with a role name."""
        (actor,) = [e["id"] for e in self.events("spawn") if e["attributes"].get("role_name") == name]
        return int(actor)

    def path_of(self, name: str) -> Any:
        """(T, 3) x, y, yaw [deg] of an actor after each tick since it was spawned."""
        number = str(self.actor_of(name))
        return np.array(
            [[*e["places"][number][1:3], e["places"][number][4]] for e in self.events("tick") if number in e["places"]]
        )

    def kill(self) -> None:
        """End it at once."""
        self.process.kill()
        self.process.wait()


StartTown = Callable[..., StandIn]


def free_ports() -> int:
    """A port that is free together with the next one."""
    for _ in range(100):
        with socket.socket() as first, socket.socket() as second:
            first.bind(("127.0.0.1", 0))
            port = int(first.getsockname()[1])
            try:
                second.bind(("127.0.0.1", port + 1))
            except (OSError, OverflowError):
                continue
            return port
    raise AssertionError("no two ports are free")


@pytest.fixture
def stand_in(tmp_path: Path) -> Iterator[StartTown]:
    """Starts stand-ins with facts of their town; they are ended with the test."""
    pytest.importorskip("carla")
    pytest.importorskip("msgpack")
    started: list[StandIn] = []

    def start(**facts: Any) -> StandIn:
        started.append(StandIn(facts, tmp_path))
        return started[-1]

    yield start
    for one in started:
        one.process.send_signal(signal.SIGTERM)
        one.process.wait(10)
        assert one.process.stdout is not None
        one.process.stdout.close()


CROWD = """
world: {{width: 20, height: 20, step_time: 0.1, control_mode: auto, collision_mode: unobstructed}}
robot:
  - {{name: guide, kinematics: {{name: diff}}, shape: {{name: circle, radius: 0.2}}, state: [2, 10, 0],
     goal: [18, 10, 0], behavior: {{name: dash}}}}
obstacle:
  - number: 3
    distribution: {{name: manual}}
    kinematics: {{name: omni}}
    shape: {{name: circle, radius: 0.2}}
    state: [[4, 4, 0.5], [10, 16, -1.5], [16, 5, 2.5]]
    goal: [[16, 16], [10, 3], [3, 6]]
    behavior: {{name: orca}}
  - {{name: pillar, shape: {{name: circle, radius: 0.5}}, state: [10, 18, 0]}}
bridges:
  - {{name: carla, port: {port}, timeout: {timeout}, transform: {{x: 100, y: -50, yaw: 30}}{more}}}
"""
"""A robot and three pedestrians, all of them walkers."""

YARD = np.array([[0, 0], [12, 0], [12, 9], [7, 9], [7, 6], [4, 8], [0, 8], [0, 0]], dtype=float)
"""Corners of a wall in the scenario."""

DRIVE = """
world: {{width: 12, height: 9, step_time: 0.1, control_mode: auto, collision_mode: unobstructed}}
robot:
  - name: car
    kinematics: {{name: {drive}}}
    shape: {shape}
    state: {state}
    goal: {goal}
    vel_max: {vel_max}
    vel_min: {vel_min}
    behavior: {{name: dash}}
    sensors: [{{name: lidar2d, number: 181, range_max: 10, angle_range: 4.7}}]
obstacle:
  - {{name: wall, shape: {{name: linestring, vertices: {wall}}}, state: [0, 0, 0]}}
  - {{name: walker, kinematics: {{name: omni}}, shape: {{name: circle, radius: 0.2}}, state: [9, 7, 0], goal: [9, 2],
     vel_max: [0.8, 0.8], behavior: {{name: dash}}}}
bridges:
  - {{name: carla, port: {port}, timeout: 5, transform: {{x: -20, y: 35, yaw: -70}}{more}}}
"""
"""A robot with a lidar in a yard, which someone crosses."""


def in_town(x: Any, y: Any, at: tuple[float, float, float]) -> Any:
    """(..., 2) of CARLA for points of the scenario, whose origin is at x, y [m], yaw [deg]."""
    cosine, sine = math.cos(math.radians(at[2])), math.sin(math.radians(at[2]))
    return np.stack([at[0] + cosine * x + sine * y, at[1] + sine * x - cosine * y], axis=-1)
