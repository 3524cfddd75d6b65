"""Our rosbridge client with a real ROS 1: master, rospy and rostopic of Debian; and with a stand-in of ROS 2.

Between them is a server of the protocol that is ours, because rosbridge_server itself is in no registry. It makes
of our JSON the messages that ROS generates from its own definitions, and rospy sends them.
"""

from __future__ import annotations

import gc
import json
import os
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

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
START_S = 60
"""For the start of some processes on a busy computer."""
REAL = """\
world: {{width: 10, height: 6, step_time: 0.05}}
robot:
  - {{name: robot_0, kinematics: {{name: diff}}, shape: {{name: circle, radius: 0.2}}, state: [1, 2, 0],
     goal: [{goal}, 2.5, 0], behavior: {{name: dash}}, sensors: [{sensors}]}}
bridges:
  - {{name: rosbridge, port: {port}, ros: {ros}, mode: real, dry_run: false, timeout: {timeout}, lost_timeout: 60}}
"""


class Server:
    """The server, which runs at a port, and what it says."""

    def __init__(self, start: Start, port: int | None = None) -> None:
        self.port = free_port() if port is None else port
        self.peer = start(PYTHON, str(HERE / "rosbridge_on_rospy.py"), str(self.port))
        until(lambda: self.peer.on("ready"), START_S, "the server does not start")

    def published(self, topic: str) -> int:
        """Number of messages that it has published on a topic."""
        return self.peer.on("publish").count(topic)


@pytest.fixture(autouse=True)
def _collected() -> Iterator[None]:
    """Collects that socket while its warning is ignored."""
    yield
    gc.collect()


@pytest.fixture
def server(master: str, start: Start) -> Server:
    return Server(start)


def commands(robot: Peer) -> list[float]:
    """Forward speeds that a robot was commanded."""
    return [float(line.split()[0]) for line in robot.on("command")]


def places(robot: Peer) -> list[tuple[float, ...]]:
    """Where a robot was."""
    return [tuple(map(float, line.split())) for line in robot.on("place")]


def scene_file(port: int, goal: float, sensors: str = "", timeout: int = 2, ros: int = 1) -> str:
    Path("real.yaml").write_text(REAL.format(port=port, goal=goal, sensors=sensors, timeout=timeout, ros=ros))
    return "real.yaml"


def test_nodes_of_rospy_see_what_we_publish_and_we_what_they_do(
    server: Server, start: Start, make_env: MakeEnv
) -> None:
    listener = start(PYTHON, str(HERE / "rospy_peer.py"), "100", "numbered")
    echo = start("/usr/bin/rostopic", "echo", "-p", "/robot_0/odom/pose/pose/position")
    env = make_env(f"{SCENE}bridges: [{{name: rosbridge, port: {server.port}, ros: 1, clock: wall}}]\n")
    rates = set()
    with irsim.connect(env) as connection:
        until(lambda: listener.on("map"), START_S, "the latched map does not come")
        for _ in range(600):
            env.step()
            rates.add(round(float(env.robot.velocity[1, 0]) * 1000))
            seen = min(len(listener.on("odom")), len(listener.on("scan")), len(echo.lines) - 1)
            if seen >= 50 and len(rates) > 25:
                break
        goal, notes = env.robot.goal[:2, 0].tolist(), connection.notes()
        listed = subprocess.run(["/usr/bin/rostopic", "list", "-v"], capture_output=True, text=True, check=True)
    assert server.peer.on("error") == []
    assert len(listener.on("odom")) >= 50
    assert len(listener.on("scan")) >= 50
    assert len(echo.lines) > 50  # rostopic prints a heading, and each message
    x = float(echo.lines[-1].split(",")[1])
    assert x > 1
    assert {one.split()[0] for one in listener.on("scan")} == {"90"}
    assert any(one.endswith("inf") for one in listener.on("scan"))
    assert set(listener.on("tf")) == {"robot_0/base_link"}
    assert listener.on("map") == ["20 10"]  # latched
    assert listener.on("markers") == ["4"]  # the first clears those before
    assert len(rates - {0}) >= 20  # that many of the numbered commands moved the robot
    assert all(rate % 10 for rate in rates - {0})  # and never one that is not a number
    assert any("/robot_0/cmd_vel" in note and "not a number" in note for note in notes)
    assert goal == [3, 0]
    for topic, kind in (("scan", "sensor_msgs/LaserScan"), ("pose", "geometry_msgs/PoseStamped")):
        assert f"/robot_0/{topic} [{kind}] 1 publisher" in listed.stdout
    until(lambda: server.peer.on("gone"), 10, "we do not leave")
    left = subprocess.run(["/usr/bin/rostopic", "list", "-v"], capture_output=True, text=True, check=True)
    assert "[sensor_msgs/LaserScan] 1 publisher" not in left.stdout


def test_a_robot_of_rospy_drives_to_its_goal(server: Server, start: Start) -> None:
    sensors = "{name: lidar2d, number: 3, range_max: 5, angle_range: 2}"
    robot = start(PYTHON, str(HERE / "rospy_robot.py"), "scan")
    scene = scene_file(server.port, 2.5, sensors)
    until(lambda: places(robot), START_S, "the robot does not start")
    result = irsim.run(scene, record="record")
    assert (result.outcome, result.lost) == ("success", None)
    x, y, _ = places(robot)[-1]
    assert (x, y) == pytest.approx((1.5, 0.5), abs=0.25)  # from (1, 2), where its odometry begins
    assert 0.4 < max(commands(robot)) <= 0.5
    until(lambda: commands(robot)[-1] == 0, 5, "not stopped at the end")
    recorded = irsim.runs.open_run("record")
    assert recorded.result is not None
    assert recorded.result.outcome == "success"
    assert server.published("/robot_0/cmd_vel") >= 20
    assert server.peer.on("error") == []


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM])
def test_a_robot_of_rospy_stops_when_we_are_killed(server: Server, start: Start, number: int) -> None:
    robot = start(PYTHON, str(HERE / "rospy_robot.py"))
    driver = start(PYTHON, str(HERE / "real_driver.py"), scene_file(server.port, 9), "600")
    until(lambda: max(commands(robot), default=0) > 0.3, START_S, "not driven")
    os.kill(driver.process.pid, number)
    began = time.monotonic()
    until(lambda: commands(robot)[-1] == 0, 10, "not stopped")
    assert time.monotonic() - began < 0.9  # command_timeout, and time for busy processes
    until(lambda: len(server.peer.on("gone")) == 2, 10, "the process that sends commands goes on")
    stood = places(robot)[-1]
    count = len(places(robot))
    until(lambda: len(places(robot)) > count + 10, 10, "the robot is gone")
    assert places(robot)[-1] == stood


def test_a_server_that_dies_ends_the_run_and_leaves_ros_alone(server: Server, start: Start, make_env: MakeEnv) -> None:
    listener = start(PYTHON, str(HERE / "rospy_peer.py"), "100")
    env = make_env(f"{SCENE}bridges: [{{name: rosbridge, port: {server.port}, ros: 1, timeout: 1, clock: wall}}]\n")

    def step_until_lost() -> None:
        with irsim.connect(env):
            for _ in range(400):
                env.step()
                if len(listener.on("odom")) > 10:
                    server.peer.process.kill()

    with pytest.raises(BridgeLostError, match=f"rosbridge server at 127.0.0.1:{server.port} is lost"):
        step_until_lost()
    assert len(listener.on("odom")) > 10
    assert listener.process.poll() is None
    again = Server(start)
    env = make_env(f"{SCENE}bridges: [{{name: rosbridge, port: {again.port}, ros: 1, clock: irsim}}]\n")
    count = len(listener.on("odom"))
    with irsim.connect(env):
        for _ in range(400):
            env.step()
            if len(listener.on("odom")) > count:
                return
            time.sleep(0.02)
    pytest.fail("a new server at another port does not reach the same node")


def test_a_server_that_comes_back_in_time_is_found_again(server: Server, start: Start, make_env: MakeEnv) -> None:
    listener = start(PYTHON, str(HERE / "rospy_peer.py"), "200")
    env = make_env(f"{SCENE}bridges: [{{name: rosbridge, port: {server.port}, ros: 1, timeout: 40, clock: wall}}]\n")

    def step_until(holds: Callable[[], object], why: str) -> None:
        end = time.monotonic() + START_S
        while not holds():
            assert time.monotonic() < end, why
            env.step()

    with irsim.connect(env) as connection:
        step_until(lambda: len(listener.on("odom")) > 10 and listener.on("map"), "nothing comes")
        server.peer.process.kill()
        server.peer.process.wait()
        for _ in range(10):
            env.step()
        again = Server(start, server.port)
        step_until(lambda: again.peer.on("client"), "the server is not found again")
        before, maps = len(listener.on("odom")), len(listener.on("map"))
        step_until(lambda: len(listener.on("odom")) > before + 20, "nothing comes any more")
        step_until(lambda: len(listener.on("map")) > maps, "the map does not come again")
        step_until(lambda: float(env.robot.velocity[1, 0]) == pytest.approx(0.5), "no commands come any more")
        notes = connection.notes()
    assert again.peer.on("error") == []
    assert not [note for note in notes if "the server says" in note]


def test_a_driven_robot_loses_its_server(server: Server, start: Start) -> None:
    """The robot needs a timeout of its own then; the run says what happened and fails."""
    robot = start(PYTHON, str(HERE / "rospy_robot.py"))
    command = [PYTHON, "-m", "irsim", "run", scene_file(server.port, 9)]
    run = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        until(lambda: max(commands(robot), default=0) > 0.3, START_S, "not driven")
        server.peer.process.kill()
        printed, problems = run.communicate(timeout=30)
    finally:
        run.kill()
    assert run.returncode == 1
    assert "bridge-lost" in problems
    assert "rosbridge" in problems
    assert "the program of a bridge was lost" in " ".join(printed.split())


def test_a_robot_gets_no_old_commands_when_its_server_comes_back(server: Server, start: Start) -> None:
    robot = start(PYTHON, str(HERE / "rospy_robot.py"))
    driver = start(PYTHON, str(HERE / "real_driver.py"), scene_file(server.port, 9, timeout=60), "2000")
    until(lambda: max(commands(robot), default=0) > 0.45, START_S, "not driven")
    server.peer.process.kill()
    server.peer.process.wait()
    time.sleep(0.5)  # for what is on its way
    count = len(commands(robot))
    again = Server(start, server.port)
    until(lambda: len(commands(robot)) > count + 20, START_S, "not driven any more")
    assert commands(robot)[count] < 0.2  # from rest, with the acceleration that is allowed
    assert driver.process.poll() is None
    assert again.peer.on("error") == []


def test_what_is_wrong_is_told_by_the_server(server: Server, make_env: MakeEnv, capsys: Any) -> None:
    """The server cannot publish one of our topics; the others go on, and the run says so."""
    env = make_env(f"{SCENE}bridges: [{{name: rosbridge, port: {server.port}, ros: 1, clock: wall}}]\n")
    with irsim.connect(env) as connection:
        wrong = {"op": "advertise", "topic": "/x", "type": "no_pkg/Nothing"}
        connection.bridges[0].backend._client.send_on_ready(wrong)
        until(lambda: server.peer.on("error"), 10, "the server says nothing")
        for _ in range(20):
            env.step()
        notes = connection.notes()
    assert any("the server says" in note and "no_pkg/Nothing" in note for note in notes)
    assert "Traceback" not in capsys.readouterr().err
    assert server.published("/robot_0/odom") >= 20


# ROS 2, with a stand-in of the server --------------------------------------------------------------------------------
StandIn = Callable[..., tuple[int, Peer]]


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
    driver = start(PYTHON, str(HERE / "real_driver.py"), scene_file(port, 9, ros=2), "600")

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
