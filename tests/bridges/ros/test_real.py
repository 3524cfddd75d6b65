"""Commands to real robots, and where they are."""

from __future__ import annotations

import io
import json
import math
import sys
import threading
import time
from types import SimpleNamespace as N
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from irsim.bridges.base import BridgeLostError
from irsim.bridges.ros import guard
from irsim.bridges.ros.guard import ZERO, Limits, limited
from irsim.bridges.ros.incoming import Odometry
from irsim.bridges.ros.real import RealRobots, composed, inverted
from irsim.bridges.state import Motion
from irsim.components.bridges.ros2 import Ros2
from irsim.options.base import Options
from tests.bridges.ros.test_topics import SCENE

LIMITS = Limits(0.5, 1.0, 1.0, 3.0)
NUMBERS = st.floats(-10, 10)
POSES = st.tuples(NUMBERS, NUMBERS, st.floats(-3, 3))


@given(st.tuples(NUMBERS, NUMBERS, NUMBERS))
def test_commands_never_exceed_the_limits(target: tuple[float, float, float]) -> None:
    command = ZERO
    for _ in range(60):
        before, command = command, limited(target, command, LIMITS, 0.05)
        assert math.hypot(*command[:2]) <= 0.5 + 1e-9
        assert abs(command[2]) <= 1 + 1e-9
        assert math.hypot(command[0] - before[0], command[1] - before[1]) <= 0.05 + 1e-9
    if math.hypot(*target[:2]) > 0.5 and 1e-3 < abs(target[2]) < math.hypot(*target[:2]):
        # slower as a whole: the arc stays
        assert command[2] / math.hypot(*command[:2]) == pytest.approx(target[2] / math.hypot(*target[:2]), rel=1e-6)


@pytest.mark.parametrize("target", [(0, 0, 0), (math.nan, 0, 0), (0.1, math.inf, 0), (1,), ()])
def test_a_stop_is_immediate_and_what_is_not_finite_is_one(target: tuple[float, ...]) -> None:
    assert limited(target, (0.5, 0, 1), LIMITS, 0.05) == ZERO


@given(POSES, POSES)
def test_poses_compose_and_invert(first: tuple[float, ...], second: tuple[float, ...]) -> None:
    again = composed(inverted(first), composed(first, second))
    assert again[:2] == pytest.approx(second[:2], abs=1e-9)
    assert math.cos(again[2] - second[2]) == pytest.approx(1)


def robots(**options: Any) -> RealRobots:
    made = RealRobots(Ros2(mode="real", **options), 0.1)
    made.add(SCENE.robots[:1])  # it starts at (1, 2, 0)
    return made


def motion(turn: float = 0.0) -> Motion:
    twist = np.tile([0.3, 0.0, turn], (3, 1))
    return Motion(5, 0.5, np.zeros((3, 3)), np.array([[1.0, 2.0, 0.1 * turn]] * 3), twist)


def test_odometry_begins_at_the_start_in_the_scenario() -> None:
    fleet = robots()
    fleet.take("robot 0", Odometry((50.0, 0.0, math.pi / 2), (0.2, 0, 0)), 10.0)
    assert fleet.poses()["robot 0"] == pytest.approx((1, 2, 0))
    fleet.take("robot 0", Odometry((50.0, 1.0, math.pi / 2), (0.2, 0, 0)), 10.0)  # one metre ahead
    assert fleet.poses()["robot 0"] == pytest.approx((2, 2, 0))
    fleet.relocate("robot 0", (5.0, 5.0, 1.0))
    assert fleet.poses()["robot 0"] == pytest.approx((5, 5, 1))
    in_world = robots(odom_origin="world")
    in_world.take("robot 0", Odometry((3.0, 4.0, 0.5), (0, 0, 0)), 10.0)
    assert in_world.poses()["robot 0"] == pytest.approx((3, 4, 0.5))


def test_old_odometry_is_a_zero_command_and_then_the_end() -> None:
    fleet = robots(odom_timeout=0.5, lost_timeout=3)
    fleet.take("robot 0", Odometry((0.0, 0.0, 0.0), (0.2, 0, 0)), 10.0)
    assert fleet.commands(motion(), 10.4)["robot 0"] == pytest.approx((0.3, 0, 0))
    assert fleet.commands(motion(2.0), 10.4)["robot 0"] == pytest.approx((0.3, 0, 2))  # at the heading of the start
    assert fleet.commands(motion(), 10.6) == {"robot 0": ZERO}
    assert fleet.twists(10.6)["robot 0"] == ZERO
    assert "zero commands in 1 steps" in fleet.notes()[0]
    fleet.take("robot 0", Odometry((0.0, 0.0, 0.0), (0.2, 0, 0)), 11.0)
    fleet.take_scan("robot 0", "robot 0/0", 10.4)
    assert fleet.commands(motion(), 11.0) == {"robot 0": ZERO}  # a lidar that measured once has to go on
    fleet.take_scan("robot 0", "robot 0/0", 10.9)
    assert fleet.commands(motion(), 11.0)["robot 0"] == pytest.approx((0.3, 0, 0))
    with pytest.raises(BridgeLostError, match=r"no odometry of 'robot 0' for 3\.1 s"):
        fleet.commands(motion(), 14.1)


class Pipe(io.StringIO):
    """Lines that come when they are written, until it is closed."""

    def __init__(self) -> None:
        super().__init__()
        self._lines: list[str] = []
        self._more = threading.Condition()
        self._ended = False

    def say(self, content: object) -> None:
        with self._more:
            self._lines.append(json.dumps(content) + "\n")
            self._more.notify()

    def end(self) -> None:
        with self._more:
            self._ended = True
            self._more.notify()

    def readline(self, *_: Any) -> str:
        with self._more:
            self._more.wait_for(lambda: self._lines or self._ended)
            return self._lines.pop(0) if self._lines else ""

    def __next__(self) -> str:
        if line := self.readline():
            return line
        raise StopIteration


def test_the_guard_sends_zeros_when_nothing_comes_and_when_all_ends(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    sent: list[tuple[float, float]] = []
    backend = N(
        ready=True,
        publish=lambda topic, said: sent.append((time.monotonic(), said[0])),
        close=lambda: sent.append((0, -1)),
    )
    monkeypatch.setattr(guard, "make_messages", lambda options: N(command=lambda kind, stamp, frame, speed: speed))
    monkeypatch.setattr(guard, "open_backend", lambda *arguments: backend)
    monkeypatch.setattr(guard.signal, "signal", lambda *arguments: None)
    options: Options = Ros2(mode="real", command_timeout=0.2, command_rate=100, max_acceleration=100)
    topic = {"key": "cmd_vel", "name": "/cmd_vel", "kind": "geometry_msgs/msg/Twist", "outgoing": True,
             "qos": {"depth": 1}, "robot": "rover"}  # fmt: skip
    pipe = Pipe()
    pipe.say({"options": options.model_dump(mode="json"), "topics": [topic]})
    thread = threading.Thread(target=guard.main, args=(pipe,))
    thread.start()
    pipe.say({"rover": [9.0, 0.0, 0.0]})
    began = time.monotonic()
    while not any(speed == 0.5 for _, speed in list(sent)):  # limited to max_speed
        assert time.monotonic() - began < 5
        time.sleep(0.005)
    while sent[-1][1] != 0.0:
        assert time.monotonic() - began < 5
        time.sleep(0.005)
    last = max(when for when, speed in sent if speed == 0.5)
    assert last - began < 0.2 + 0.3
    pipe.say({"rover": [0.2, 0.0, 0.0]})
    while sent[-1][1] != 0.2:
        assert time.monotonic() - began < 5
        time.sleep(0.005)
    backend.ready = False  # the connection is made anew: what is dropped was not driven
    pipe.say({"rover": [0.3, 0.0, 0.0]})
    until_zero = time.monotonic()
    while sent[-1][1] != 0.0:
        assert time.monotonic() - until_zero < 0.15, "before the command is too old"
        time.sleep(0.005)
    pipe.end()
    thread.join(10)
    assert not thread.is_alive()
    assert [speed for _, speed in sent[-11:]] == [0.0] * 10 + [-1]
    assert capsys.readouterr().out == "ready\n"
    assert "rospy" not in sys.modules
