"""A robot that another program simulates, on Fast DDS, is driven; if irsim fails, it stops within the timeout."""

from __future__ import annotations

import itertools
import os
import signal
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from irsim.bridges.ros.messages import Messages
from tests.interop.ros.conftest import HERE, PYTHON, Peer, until

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("fastdds")]
TIMEOUT_S = 0.5
START_S = 60
"""For the start of four processes on a busy computer."""
MARGIN_S = 0.4
"""For processes that wait for a processor."""
SCENE = """\
world: {{width: 10, height: 6, step_time: 0.05}}
robot:
  - name: robot_0
    kinematics: {{name: diff}}
    shape: {{name: circle, radius: 0.2}}
    state: [1, 2, 0.5]
    goal: [9, 5, 0]
    vel_max: [2, 2]
    behavior: {{name: dash}}
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
        kind = "geometry_msgs/msg/Twist"
        heard = self.peer.on("/robot_0/cmd_vel")
        return [self._messages.from_cdr(bytes.fromhex(one), kind).linear.x for one in heard]


@pytest.fixture
def drive(
    fastdds_program: str, start: Callable[..., Peer], domain: int, tmp_path: Path
) -> Callable[..., tuple[Robot, Peer]]:
    def driving(*how: str, odometry_s: float = 1000.0, dry: str = "false") -> tuple[Robot, Peer]:
        robot = Robot(start(fastdds_program, str(domain), "200", str(odometry_s), "0", "odom"))
        scene = tmp_path / "real.yaml"
        scene.write_text(SCENE.format(domain=domain, dry=dry))
        return robot, start(PYTHON, str(HERE / "real_driver.py"), str(scene), "600", *how)

    return driving


def stopped(robot: Robot) -> bool:
    return robot.speeds()[-1:] == [0.0]


def test_the_robot_is_driven_within_its_limits(drive: Callable[..., tuple[Robot, Peer]]) -> None:
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


def test_a_dry_run_moves_nothing(drive: Callable[..., tuple[Robot, Peer]]) -> None:
    robot, irsim = drive(dry="true")
    until(lambda: len(irsim.on("step")) > 60, START_S, "not stepped")
    assert robot.speeds() == []
    assert irsim.on("step")[-1].split()[2:4] == ["1.0", "2.0"]


def test_a_silent_robot_is_stopped_and_then_lost(drive: Callable[..., tuple[Robot, Peer]]) -> None:
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
def test_the_robot_stops_when_we_crash_or_hang(drive: Callable[..., tuple[Robot, Peer]], how: str) -> None:
    robot, irsim = drive(how)
    until(lambda: len(irsim.on("step")) >= 41, START_S, "not driven")
    assert max(robot.speeds()) > 0.3
    began = time.monotonic()
    until(lambda: stopped(robot), 10, "not stopped")
    assert time.monotonic() - began < TIMEOUT_S + MARGIN_S
    if how == "crash":
        assert irsim.process.wait(10) == 1


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_the_robot_stops_when_we_are_killed(drive: Callable[..., tuple[Robot, Peer]], number: int) -> None:
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
def test_the_robot_stops_when_the_guard_is_killed_or_hangs(
    drive: Callable[..., tuple[Robot, Peer]], number: int, seconds: float
) -> None:
    robot, irsim = drive()
    until(lambda: max(robot.speeds(), default=0) > 0.3, START_S, "not driven")
    os.kill(int(irsim.on("open")[0].split()[1]), number)
    began = time.monotonic()
    until(lambda: stopped(robot), 10, "not stopped")
    assert time.monotonic() - began < seconds + MARGIN_S
    assert irsim.process.wait(10) != 0
