"""Our rosbridge client (roslibpy) against a stand-in of the server in its own process."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from pathlib import Path

import pytest

import irsim
from irsim.bridges.base import BridgeLostError
from tests.interop.ros.conftest import HERE, PYTHON, SCENE, MakeEnv, Peer, Start, free_port, until

pytestmark = [
    pytest.mark.interop,
    pytest.mark.xdist_group("ros_others"),
    # roslibpy leaves a socket to the collector of garbage if the server is gone
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
]
StandIn = Callable[..., tuple[int, Peer]]
REAL = """\
world: {width: 10, height: 6, step_time: 0.05}
robot:
  - {name: robot_0, kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [1, 2, 0], goal: [9, 2, 0],
     behavior: {name: dash}}
"""


@pytest.fixture
def stand_in(start: Start) -> StandIn:
    """Starts a stand-in; its port, and its process."""

    def starting(*how: str) -> tuple[int, Peer]:
        port = free_port()
        server = start(PYTHON, str(HERE / "rosbridge_standin.py"), str(port), *how)
        until(lambda: server.on("ready"), 30, "the stand-in does not start")
        return port, server

    return starting


def test_both_ways_over_one_port(stand_in: StandIn, make_env: MakeEnv) -> None:
    port, server = stand_in()
    env = make_env(f"{SCENE}bridges: [{{name: rosbridge, port: {port}, clock: wall}}]\n")
    with irsim.connect(env) as connection:
        for _ in range(600):
            env.step()
            if len(server.on("/robot_0/odom")) >= 50 and float(env.robot.state[0, 0]) > 1.2:
                break
        velocity = env.robot.velocity[:2, 0].tolist()
        notes = connection.notes()
    assert velocity == pytest.approx([0.4, 0.5])
    assert "/robot_0/odom nav_msgs/msg/Odometry False" in server.on("advertise")
    assert any(one.startswith("/map ") and one.endswith("True") for one in server.on("advertise"))
    said = json.loads(server.on("/robot_0/pose")[-1].split(" ", 1)[1])
    assert said["header"]["frame_id"] == "map"
    assert set(said["header"]["stamp"]) == {"sec", "nanosec"}
    assert len(server.on("/map")) == len(server.on("/irsim/markers")) == 1
    assert any("the velocity is not a number" in note or "is missing" in note for note in notes)  # the bad ones


def test_a_real_robot_behind_the_server_stops_when_we_are_killed(stand_in: StandIn, start: Start) -> None:
    port, server = stand_in("robot")
    bridge = f"bridges: [{{name: rosbridge, port: {port}, mode: real, dry_run: false}}]\n"
    Path("real.yaml").write_text(REAL + bridge)
    driver = start(PYTHON, str(HERE / "real_driver.py"), "real.yaml", "600")

    def speeds() -> list[float]:
        said = [json.loads(one.split(" ", 1)[1]) for one in server.on("/robot_0/cmd_vel")]
        return [one["linear"]["x"] for one in said]

    until(lambda: max(speeds(), default=0) > 0.3, 60, "not driven")
    driver.process.kill()
    began = time.monotonic()
    until(lambda: speeds()[-1] == 0, 10, "not stopped")
    assert time.monotonic() - began < 0.9  # command_timeout, and time for busy processes


def test_a_connection_that_breaks_is_made_again(stand_in: StandIn, make_env: MakeEnv) -> None:
    port, server = stand_in("drop")
    env = make_env(f"{SCENE}bridges: [{{name: rosbridge, port: {port}, timeout: 20, clock: wall}}]\n")
    steps = 0
    with irsim.connect(env):
        while steps < 1000 and len(server.on("/map")) < 2:
            env.step()
            steps += 1
        for _ in range(20):
            env.step()
            steps += 1
    assert server.on("dropped")
    for topic in ("/map", "/irsim/markers", "/tf_static", "/pedestrians/ids"):
        assert len(server.on(topic)) == 2, topic  # the server has forgotten the first ones
    assert 20 < len(server.on("/robot_0/odom")) < steps - 10  # nothing that is old by then is sent


def test_without_a_server_the_error_says_so(make_env: MakeEnv) -> None:
    env = make_env(f"{SCENE}bridges: [{{name: rosbridge, port: {free_port()}, timeout: 1}}]\n")
    with pytest.raises(BridgeLostError, match="no rosbridge server answers"):
        irsim.connect(env)
