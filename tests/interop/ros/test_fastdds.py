"""Our node without ROS against Fast DDS, the default middleware of ROS 2: a peer, and a robot that has to stop."""

from __future__ import annotations

import itertools
import os
import signal
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import irsim
from irsim.bridges.ros.backends.base import Backend
from irsim.bridges.ros.messages import Messages
from tests.interop.ros.conftest import HERE, PYTHON, SCENE, MakeEnv, Peer, Start, until

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("fastdds")]
Published = dict[str, set[str]]
TOPICS = {
    "/robot_0/odom": "nav_msgs/msg/Odometry",
    "/robot_0/pose": "geometry_msgs/msg/PoseStamped",
    "/robot_0/scan": "sensor_msgs/msg/LaserScan",
    "/robot_0/reference_path": "nav_msgs/msg/Path",
    "/pedestrians": "geometry_msgs/msg/PoseArray",
    "/tf": "tf2_msgs/msg/TFMessage",
    "/map": "nav_msgs/msg/OccupancyGrid",
    "/irsim/markers": "visualization_msgs/msg/MarkerArray",
}


@pytest.fixture
def scene(domain: int) -> str:
    return f"{SCENE}bridges: [{{name: ros2, backend: dds, loopback: true, domain: {domain}}}]\n"


@pytest.fixture
def start_dds(fastdds_program: str, start: Start, domain: int) -> Start:
    """Starts a peer on Fast DDS in the domain of the test."""
    return lambda *words: start(fastdds_program, str(domain), *words)


@pytest.fixture
def published(monkeypatch: pytest.MonkeyPatch) -> Published:
    """CDR of all that we publish, by topic."""
    from irsim.bridges.ros.backends.dds import DdsBackend

    samples: Published = {}
    publish = DdsBackend.publish

    def recorded(self: Backend, topic: Any, message: Any) -> None:
        samples.setdefault(topic.name, set()).add(self.messages.cdr(message, topic.kind).hex())
        publish(self, topic, message)  # type: ignore[arg-type]

    monkeypatch.setattr(DdsBackend, "publish", recorded)
    return samples


def test_both_ways_and_the_same_bytes(start_dds: Start, published: Published, make_env: MakeEnv, scene: str) -> None:
    peer, env = start_dds("30", "0.4", "0.5"), make_env(scene)
    with irsim.connect(env):
        for _ in range(400):
            env.step()
            if len(peer.on("/robot_0/scan")) >= 60 and float(env.robot.state[0, 0]) > 1.3:
                break
        velocity, goal = env.robot.velocity[:2, 0].tolist(), env.robot.goal[:2, 0].tolist()
    assert velocity == pytest.approx([0.4, 0.5])  # the robot has no behavior: it follows the peer
    assert goal == [3, 2]
    for topic in TOPICS:
        heard = peer.on(topic)
        assert len(heard) >= (1 if topic in ("/map", "/irsim/markers") else 50), topic
        # what Fast CDR writes of what it has read is what we have written
        assert {_trimmed(one) for one in heard} <= {_trimmed(one) for one in published[topic]}, topic
    messages = Messages()
    last = messages.from_cdr(bytes.fromhex(peer.on("/robot_0/scan")[-1]), TOPICS["/robot_0/scan"])
    assert len(last.ranges) == 90
    path = messages.from_cdr(bytes.fromhex(peer.on("/robot_0/reference_path")[-1]), TOPICS["/robot_0/reference_path"])
    assert [path.poses[-1].pose.position.x, path.poses[-1].pose.position.y] == goal  # it leads to the goal of the peer


def _trimmed(text: str) -> str:
    """CDR without the flag of padding in its header and the padding itself, which each side may choose."""
    return text[8:].rstrip("0")


def test_who_comes_late_gets_the_map(start_dds: Start, make_env: MakeEnv, scene: str) -> None:
    env = make_env(scene)
    with irsim.connect(env):
        for _ in range(20):
            env.step()
        peer = start_dds("20", "0", "0", "silent")
        until(lambda: peer.on("/map") and peer.on("/irsim/markers"), 10, "no map")
        for _ in range(10):
            env.step()
    assert len(peer.on("/map")) == 1
    messages = Messages()
    grid = messages.from_cdr(bytes.fromhex(peer.on("/map")[0]), TOPICS["/map"])
    assert (grid.info.width, grid.info.height, grid.info.resolution) == (20, 10, 0.5)
    assert grid.header.frame_id == "map"
    assert {0, 100} == set(grid.data.tolist())


TIMEOUT_S = 0.5
START_S = 60
"""For the start of four processes on a busy computer."""
MARGIN_S = 0.4
"""For processes that wait for a processor."""
REAL = """\
world: {{width: 10, height: 6, step_time: 0.05}}
robot:
  - {{name: robot_0, kinematics: {{name: diff}}, shape: {{name: circle, radius: 0.2}}, state: [1, 2, 0.5],
     goal: [9, 5, 0], vel_max: [2, 2], behavior: {{name: dash}}}}
bridges:
  - {{name: ros2, backend: dds, loopback: true, domain: {domain}, mode: real, max_speed: 0.4, max_acceleration: 2,
      command_timeout: 0.5, odom_timeout: 0.5, lost_timeout: 3, dry_run: {dry}}}
"""


class Robot:
    """The robot as its own process tells of it."""

    def __init__(self, peer: Peer) -> None:
        self.peer, self._messages = peer, Messages()

    def speeds(self) -> list[float]:
        """Forward speeds that it was commanded."""
        heard = map(bytes.fromhex, self.peer.on("/robot_0/cmd_vel"))
        return [self._messages.from_cdr(one, "geometry_msgs/msg/Twist").linear.x for one in heard]


Drive = Callable[..., tuple[Robot, Peer]]


@pytest.fixture
def drive(start_dds: Start, start: Start, domain: int) -> Drive:
    def driving(*how: str, odometry_s: float = 1000.0, dry: str = "false") -> tuple[Robot, Peer]:
        robot = Robot(start_dds("200", str(odometry_s), "0", "odom"))
        Path("real.yaml").write_text(REAL.format(domain=domain, dry=dry))
        return robot, start(PYTHON, str(HERE / "real_driver.py"), "real.yaml", "600", *how)

    return driving


def stopped(robot: Robot) -> bool:
    return robot.speeds()[-1:] == [0.0]


def test_the_robot_is_driven_within_its_limits(drive: Drive) -> None:
    robot, irsim = drive()
    until(lambda: max(robot.speeds(), default=0) > 0.39, START_S, "not driven")
    speeds = robot.speeds()
    assert max(speeds) == pytest.approx(0.4)
    steps = [after - before for before, after in itertools.pairwise(speeds)]
    assert max(steps, default=0) < 2 * 2 * 0.05 + 1e-9  # acceleration times at most two periods of the commands
    until(lambda: len(irsim.on("step")) > 100, START_S, "not stepped")
    x, y = (float(value) for value in irsim.on("step")[-1].split()[2:4])
    assert x > 1.5  # its odometry begins at 0, its start in the scenario is (1, 2)
    assert y > 2.0


def test_a_dry_run_moves_nothing(drive: Drive) -> None:
    robot, irsim = drive(dry="true")
    until(lambda: len(irsim.on("step")) > 60, START_S, "not stepped")
    assert robot.speeds() == []
    assert irsim.on("step")[-1].split()[2:4] == ["1.0", "2.0"]


def test_a_silent_robot_is_stopped_and_then_lost(drive: Drive) -> None:
    robot, irsim = drive(odometry_s=2.0)
    until(lambda: max(robot.speeds(), default=0) > 0.3, START_S, "not driven")
    began = time.monotonic()
    until(lambda: stopped(robot), 15, "not stopped")
    assert irsim.process.poll() is None  # stopped while the run goes on
    assert irsim.process.wait(15) != 0
    assert time.monotonic() - began < 15
    steps = [float(line.split()[1]) for line in irsim.on("step")]
    assert 2.5 < steps[-1] - steps[0] < 8  # lost_timeout after the last odometry
    assert stopped(robot)


@pytest.mark.parametrize("how", ["crash", "hang"])
def test_the_robot_stops_when_we_crash_or_hang(drive: Drive, how: str) -> None:
    robot, irsim = drive(how)
    until(lambda: len(irsim.on("step")) >= 41, START_S, "not driven")
    assert max(robot.speeds()) > 0.3
    began = time.monotonic()
    until(lambda: stopped(robot), 10, "not stopped")
    assert time.monotonic() - began < TIMEOUT_S + MARGIN_S
    if how == "crash":
        assert irsim.process.wait(10) == 1


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_the_robot_stops_when_we_are_killed(drive: Drive, number: int) -> None:
    robot, irsim = drive()
    until(lambda: max(robot.speeds(), default=0) > 0.3, START_S, "not driven")
    ours, guard = (int(word) for word in irsim.on("open")[0].split())
    began = time.monotonic()
    os.kill(ours, number)
    until(lambda: stopped(robot), 10, "not stopped")
    assert time.monotonic() - began < TIMEOUT_S + MARGIN_S
    until(lambda: not Path(f"/proc/{guard}").exists(), 10, "the guard goes on")
    assert robot.speeds()[-5:] == [0.0] * 5


@pytest.mark.parametrize(("number", "seconds"), [(signal.SIGKILL, TIMEOUT_S), (signal.SIGSTOP, TIMEOUT_S + 1.0)])
def test_the_robot_stops_when_the_guard_is_killed_or_hangs(drive: Drive, number: int, seconds: float) -> None:
    robot, irsim = drive()
    until(lambda: max(robot.speeds(), default=0) > 0.3, START_S, "not driven")
    os.kill(int(irsim.on("open")[0].split()[1]), number)
    began = time.monotonic()
    until(lambda: stopped(robot), 10, "not stopped")
    assert time.monotonic() - began < seconds + MARGIN_S
    assert irsim.process.wait(10) != 0
